# SPDX-License-Identifier: Apache-2.0
"""The recipes of CONTRIBUTING for a node, a renderer and a check, followed in a copy of the package.

Those for a model, a host and a page are followed in `tests/conformance/test_new_model.py`,
`tests/hosts/test_table.py` and `tests/test_upstream.py`.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.whole

ROOT = Path(__file__).parents[1]
DATA = ("libraries", "genglsl", "genosl", "examples")

# By the file that a recipe changes: texts, each before the one at which it is put in.

# A node that dims its color by a number: its model and its spec. Its third place is its section of
# docs/specification.md.
ROWS = "python/mxeon/models/nodes/lobes.py"
DEFAULTS, RANGES = "python/mxeon/models/nodes/parameters.py", "python/mxeon/models/core/ranges.py"
SPEC, SPECS = (f"python/mxeon/conformance/specs/{each}.py" for each in ("shaded", "__init__"))
NODE = {
    ROWS: {
        "LOBE_NODES = (\n": """def _left(wo: Array, inputs: Inputs) -> Array:
    return np.asarray(inputs["color"] * (1.0 - 0.5 * inputs["shade"][:, np.newaxis]))


SHADED = PbrNode(
    "shaded",
    "shaded Lambert",
    "shaded_bsdf",
    ("color", "shade"),
    lambda wo, wi, inputs: _left(wo, inputs) / np.pi,
    _left,
    variants=(Variant("Lambert", lambda wo, wi, inputs: inputs["color"] / np.pi),),
)
""",
        '    PbrNode(\n        "burley",': "    SHADED,\n",
    },
    DEFAULTS: {'    "translucent_bsdf": {': '    "shaded_bsdf": {"color": WHITE, "shade": 0.0},\n'},
    RANGES: {'    **_each("u reflectivity': '    "shade": _SHARE,\n'},
    SPEC: {
        "": """from mxeon.conformance.spec import Input
from mxeon.conformance.specs.lobes import COLOR, FLAT_ERRORS, NORMAL, WEIGHT, FlatSpec
from mxeon.models.nodes import node

SHADE = Input("shade", edges=(0.0, 1.0), change=0.5)
SHADED = FlatSpec.of(node("shaded"), (WEIGHT, COLOR, SHADE, NORMAL), FLAT_ERRORS)
"""
    },
    SPECS: {
        "PLAIN_LOBES = (": "from mxeon.conformance.specs.shaded import SHADED\n\n",
        "TRANSLUCENT, CONTY_KULLA, ZELTNER": "SHADED, ",
    },
}
GLSL = """#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"

void shaded_bsdf(ClosureData closureData, float weight, vec3 color, float shade, vec3 N, inout BSDF bsdf)
{
    bsdf.throughput = vec3(0.0);
    if (weight <= 0.0)
    {
        return;
    }
    N = mx_forward_facing_normal(N, closureData.V);
    vec3 albedo = weight * color * (1.0 - 0.5 * shade);
    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        float mu_i = clamp(dot(N, closureData.L), 0.0, 1.0);
        bsdf.response = albedo * closureData.occlusion * mu_i * M_PI_INV;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        bsdf.response = mx_environment_irradiance(N) * albedo;
    }
}
"""
DOCUMENT = """<?xml version="1.0"?>
<materialx version="1.39">
  <nodedef name="ND_shaded_bsdf" node="shaded_bsdf" bsdftype="R" nodegroup="pbr">
    <input name="weight" type="float" value="1.0" />
    <input name="color" type="color3" value="0.18, 0.18, 0.18" />
    <input name="shade" type="float" value="0.0" />
    <input name="normal" type="vector3" defaultgeomprop="Nworld" />
    <output name="out" type="BSDF" />
  </nodedef>
  <implementation name="IM_shaded_bsdf_genglsl" nodedef="ND_shaded_bsdf" file="shaded_bsdf.glsl"
                  function="shaded_bsdf" target="genglsl" />
</materialx>
"""

# A renderer whose one material is Lambert.
SURVEY = "python/mxeon/survey/__init__.py"
PAINTER = "python/mxeon/survey/painter.py"
RENDERER = {
    SURVEY: {'    Row("luxcore",': '    Row("painter", "", "mxeon.survey.painter", "exact"),\n'},
    PAINTER: {
        "": """import numpy as np

from mxeon.hosts.base import Engine, Identity
from mxeon.shaders.scene import sphere
from mxeon.survey.specs import COLOR, node

NODES = (node("paint", "lambert", {"color": "{color}"}, COLOR),)


class Host(Engine):
    name = "painter"

    def identity(self):
        return Identity(self.name, "1", "paper")

    def node(self, material, scene):
        points = sphere(scene.size)
        light = np.full(points.mask.shape, scene.environment or 0.0)
        if scene.light is not None:
            light += np.clip(points.normal @ scene.light, 0.0, 1.0)
        return np.where(points.mask, light, 0.0)[..., np.newaxis] * np.asarray(material["color"])
"""
    },
}

# A check that half of the color gives half of the light.
ENERGY = "python/mxeon/conformance/checks/energy.py"
CHECK = {
    ENERGY: {
        '@check(\n    "energy",': """@check(
    "halved",
    "Half of the color gives half of the light.",
    lambda spec: spec.model in ("burley", "shaded"),
    offset,
    "value",
    pairs=True,
)
def halved(case: Case) -> Iterator[Compared]:
    for batch in case.few:
        if "color" in batch.inputs:
            half = batch.altered(color=0.5 * batch.inputs["color"])
            yield Compared(batch, 2.0 * case.direct(half), case.direct(batch))


""",
        "from mxeon.conformance.checks.lobes": "from mxeon.conformance.check import offset\n",
    }
}

RUN = """
import json
import numpy as np
import mxeon
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.shaders.document.policy import DEFAULT
judge = Judge(DEFAULT)
rows = []
for library in ("right", "wrong"):
    for task in make_plan((), ["gl", "painter"], [library], nodes=["all"]).tasks:
        if task.subject in ("shaded_bsdf", "paint") or task.check == "halved":
            [each] = judge.work(task).results
            assert each.control.caught, each
            rows.append([library, each.subject, each.check, each.verdict, each.diagnosis])
judge.close()
shaded = mxeon.model("shaded_bsdf").brdf([0, 0, 1], [0, 0, 1], [1, 1, 1], shade=1.0)
assert np.allclose(np.pi * shaded, 0.5), shaded
print(json.dumps(rows))
"""


def add(folder, recipe):
    """Put the texts of a recipe before those where they belong."""
    for name, texts in recipe.items():
        path = folder / name
        source = path.read_text(encoding="utf-8") if path.exists() else ""
        for place, text in texts.items():
            assert source.count(place) == 1
            source = source.replace(place, text + place)
        path.write_text(source, encoding="utf-8")


def copied(folder):
    """A folder with a copy of the package, beside its data."""
    ignore = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "python" / "mxeon", folder / "python" / "mxeon", ignore=ignore)
    for name in DATA:
        (folder / name).symlink_to(ROOT / name)
    return folder


def said(folder, code):
    """What code that runs with the package in a folder prints, as JSON."""
    done = subprocess.run(
        [sys.executable, "-P", "-c", code],
        env=os.environ | {"PYTHONPATH": str(folder / "python")},
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Results of what a copy of the package judges that has one more node, renderer and check."""
    folder = copied(tmp_path_factory.mktemp("recipes"))
    for recipe in (NODE, RENDERER, CHECK):
        add(folder, recipe)
    for name, factor in (("right", "0.5 * shade"), ("wrong", "0.0 * shade")):
        (folder / name).mkdir()
        text = GLSL.replace("0.5 * shade", factor)
        (folder / name / "shaded_bsdf.glsl").write_text(text, encoding="utf-8")
        (folder / name / "shaded.mtlx").write_text(DOCUMENT, encoding="utf-8")
    rows = said(folder, RUN)
    return {(library, subject, check): tuple(rest) for library, subject, check, *rest in rows}


def verdicts(results, subject):
    """Verdict by check of a subject, with the right library."""
    return {key[2]: row[0] for key, row in results.items() if key[:2] == ("right", subject)}


def test_a_node_takes_its_model_and_its_spec(results):
    assert set(NODE) == {ROWS, DEFAULTS, RANGES, SPEC, SPECS}
    judged = verdicts(results, "shaded_bsdf")
    assert set(judged.values()) == {"passed"}
    assert {"value", "environment", "inputs", "surroundings", "frame", "integral"} < set(judged)
    verdict, diagnosis = results["wrong", "shaded_bsdf", "value"]
    assert verdict == "failed" and diagnosis.startswith("best match: Lambert (rms ")
    assert results["wrong", "shaded_bsdf", "inputs"] == ("failed", "inputs without effect: shade")


def test_a_renderer_takes_its_module_and_its_row(results):
    assert set(RENDERER) == {SURVEY, PAINTER}
    judged = verdicts(results, "paint")
    assert set(judged.values()) == {"passed"} and {"lobe", "environment", "black"} < set(judged)


def test_a_check_takes_one_file(results):
    assert set(CHECK) == {ENERGY}
    for subject in ("burley_diffuse_bsdf", "shaded_bsdf"):
        assert verdicts(results, subject)["halved"] == "passed"
