# SPDX-License-Identifier: Apache-2.0
"""Kits have the right files and verdicts, reveal damaged pictures, and work with Cycles."""

import json
import re
import shutil
import subprocess
import sys
import warnings
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import MaterialX as mx
import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.cli import main
from mxeon.conformance import words as sentences
from mxeon.errors import MISUSE, PASSED
from mxeon.hosts.cycles.process import interpreter
from mxeon.io.images import write_exr
from mxeon.kit import check as judging
from mxeon.kit import questions
from mxeon.kit.check import check_kit
from mxeon.kit.expected import expected, judged, pixel_means
from mxeon.kit.export import export_kit
from mxeon.kit.noise import ratio, tiles
from mxeon.kit.questions import fault
from mxeon.kit.views import MATERIALS, SETUP, views
from mxeon.models import table as reference
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import ApproximationWarning, generate
from tests.support.availability import available
from tests.support.documents import studio
from tests.support.tolerances import KIT_FALSE_ALARMS
from tests.support.verdicts import has, said

EXTERNAL_RENDERER = Path(__file__).parents[1] / "support" / "external_renderer.py"
SIZE = 64
VIEWS = {view.name: view for view in views(SIZE)}
EON, CUBED = (reference.diffuse_model(name).title for name in ("eon", "eon_rho_cubed"))


@pytest.fixture(scope="module", autouse=True)
def remembered():
    """Cache the models' expected values of each view for all tests of a module."""
    with pytest.MonkeyPatch.context() as patch:
        for function in (expected, pixel_means):
            once = cache(function)
            for module in (questions, judging):
                if hasattr(module, function.__name__):
                    patch.setattr(module, function.__name__, once)
        yield


@cache
def means(model, name):
    """Mean values of a model over each judged pixel of a view."""
    return pixel_means(reference.diffuse_model(model), VIEWS[name])


@cache
def exported():
    """Folder of an exported kit. Tests must not change the files."""
    folder = Path(mkdtemp())
    export_kit(folder, SIZE)
    return folder


def write_kit(folder):
    """Write a kit without pictures to an empty folder, or over another kit."""
    shutil.copytree(exported(), folder, dirs_exist_ok=True)


def write_pictures(folder, true="eon", false="qon", noise=0.0, seed=1):
    """Write a kit with pictures of two models. `noise` is the relative noise of each pixel."""
    rng = np.random.default_rng(seed)
    write_kit(folder)
    for view in VIEWS.values():
        model = true if view.material.energy_compensation else false
        mask, image = judged(view.scene), np.zeros((SIZE, SIZE, 3))
        values = means(model, view.name)
        image[mask] = values * (1.0 + noise * rng.standard_normal(values.shape))
        write_exr(folder / "renders" / f"{view.name}.exr", image, {})


@pytest.fixture
def kit(tmp_path):
    """Folder of a kit with pictures of EON and QON."""
    write_pictures(tmp_path)
    return tmp_path


def render(kit, name):
    return kit / "renders" / f"{name}.exr"


def read(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)


def result_of(run, check, subject):
    """The only result of the given check whose subject starts with the given text."""
    results = [each for each in run.results if each.check == check]
    [result] = [each for each in results if each.subject.startswith(subject)]
    return result


def names(run):
    """Name of the best matching model, by subject. The names are in the notes of a run."""
    pattern = r"(.*): best match: (.*) \(rms .*?\), then (.*) \("
    return {match[1]: match[2] for match in map(re.compile(pattern).match, run.notes) if match}


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("target", ["glsl", "osl", "mdl"])
def test_each_material_is_a_document_that_generates(material, target):
    document = exported() / "materials" / f"{material.name}.mtlx"
    assert len(generate(document, target, library="stock")) == 1


def test_the_description_says_what_the_scenes_say():
    kit = json.loads((exported() / "kit.json").read_text())
    assert {Path(each["file"]).stem for each in kit["pictures"]} == set(VIEWS)
    for each in kit["pictures"]:
        usd = (exported() / "scenes" / f"{Path(each['file']).stem}.usda").read_text()
        material = kit["materials"][each["material"]]
        assert f"inputs:color = ({', '.join(map(str, material['color']))})" in usd
        distant = kit["scenes"][each["scene"]].get("distant")
        assert not distant or f"({', '.join(map(repr, distant['direction']))}, 0.0)" in usd


def test_pure_noise_is_not_called_bias():
    rng, view = np.random.default_rng(1), VIEWS["true_front"]
    mask = judged(view.scene)
    noise = rng.standard_normal((200, mask.sum(), 3))
    alarms = [ratio([tiles(each, 0.0 * each, mask)]) > 1.0 for each in noise]
    assert sum(alarms) <= KIT_FALSE_ALARMS


def test_bias_far_below_the_noise_of_a_pixel_is_found():
    rng, view = np.random.default_rng(1), VIEWS["true_front"]
    mask = judged(view.scene)
    error = 0.1 * rng.standard_normal((mask.sum(), 3)) + 0.1
    assert ratio([tiles(error, 0.0 * error, mask)]) > 1.0


MODELS = {
    "true": ("eon", "fon", "eon_rho_cubed", "eon_clamped", "fon_white_lobe"),
    "false": ("lambert", "oren_nayar", "qon", "qon_footnote", "qon_fujii"),
}


@pytest.mark.parametrize("flag, name", [(flag, name) for flag in MODELS for name in MODELS[flag]])
def test_each_model_is_named_whatever_the_noise(tmp_path, flag, name):
    write_pictures(tmp_path, **{flag: name}, noise=0.02)
    found, title = names(check_kit(tmp_path)), reference.diffuse_model(name).title
    assert found[f"energy_compensation {flag}, distant light"] == title
    assert flag == "false" or found["energy_compensation true, environment"] == title


def test_right_pictures_pass(kit):
    run = check_kit(kit)
    assert {result.verdict for result in run.results} == {"passed"}
    assert all(result.control.caught for result in run.results)
    assert len(run.pictures) == len(VIEWS)


def test_too_much_noise_is_reported_and_passes_nothing(tmp_path):
    write_pictures(tmp_path, noise=1.0)
    result = result_of(check_kit(tmp_path), "white", "white")
    assert result.verdict == "not run"
    assert "too noisy" in result.reason


@pytest.mark.parametrize(
    "claims, others",
    [("eon", "false"), ("fon", "false"), ("qon", "true half white"), ("lambert", "false")],
)
def test_a_renderer_that_has_one_model_passes_with_its_claim(tmp_path, claims, others):
    write_pictures(tmp_path, true=claims, false=claims)
    for name in VIEWS:
        if name.split("_")[0] in others:
            render(tmp_path, name).unlink()
    run = check_kit(tmp_path, claims=claims)
    assert {each.verdict for each in run.results} == {"passed"} and len(run.results) >= 4
    assert result_of(run, "model", f"{claims.upper()}, distant light").control.caught


def test_a_claim_that_does_not_hold_fails(tmp_path):
    write_pictures(tmp_path, true="fon", false="fon")
    run = check_kit(tmp_path, claims="eon")
    assert result_of(run, "model", "EON, distant light").verdict == "failed"
    with pytest.raises(ValueError, match="claims must be one of eon, .*; got 'oen': did you"):
        check_kit(tmp_path, claims="oen")


def test_a_renderer_with_one_model_for_all_is_told_by_one_line(tmp_path, capsys):
    write_pictures(tmp_path, true="lambert", false="lambert", noise=0.02)
    assert main(["kit", "check", str(tmp_path)]) == 1
    assert "show the same model: Lambert\n" in capsys.readouterr().out
    write_pictures(tmp_path, true="fon", false="lambert")
    assert not any("same model" in note for note in check_kit(tmp_path).notes)
    render(tmp_path, "false_front").unlink()
    assert not any("same model" in note for note in check_kit(tmp_path).notes)


def srgb(image):
    curve = 1.055 * np.maximum(image, 1e-9) ** (1.0 / 2.4) - 0.055
    return np.where(image <= 0.0031308, 12.92 * image, curve)


FAULTS = {
    "sRGB-encoded": srgb,
    "encoded with a power of 1/2.2": lambda image: image ** (1.0 / 2.2),
    "tone-mapped by x / (1 + x)": lambda image: image / (1.0 + image),
    "upside down": lambda image: image[::-1],
    "mirrored left to right": lambda image: image[:, ::-1],
    "clipped": lambda image: np.minimum(image, 0.35),
    "pi times as bright": lambda image: np.pi * image,
    "100 times as bright": lambda image: 100.0 * image,
    "black": np.zeros_like,
    "1.23 times as bright": lambda image: 1.23 * image,
    "not Lambert's cosine in any known encoding: tone-mapped, or lit differently": (
        lambda image: np.tanh(4.0 * image) ** 0.5
    ),
    "": lambda image: image,
}


@pytest.mark.parametrize("words", FAULTS)
def test_what_is_wrong_with_light_or_encoding_is_named(words):
    view = VIEWS[SETUP.name]
    model, mask = expected(reference.diffuse_model("lambert"), view, 0.0), judged(view.scene)
    image = np.zeros((SIZE, SIZE, 3))
    image[mask] = model.value
    found = sentences.diagnosis(fault("shown", FAULTS[words](image), model, mask))
    assert found == (words and f"shown is {words}")


def test_where_the_encoding_is_wrong_no_model_is_named(kit):
    for name in VIEWS:
        write_exr(render(kit, name), srgb(read(render(kit, name))), {})
    run = check_kit(kit)
    assert has(result_of(run, "setup", "lambert"), "picture_srgb", "lambert_side")
    result = result_of(run, "model", "energy_compensation true, distant light")
    assert result.reason == "lambert_side is sRGB-encoded"
    assert names(run) == {}


def test_the_command_exports_and_judges(tmp_path, capsys):
    assert main(["kit", "export", str(tmp_path), "--size", "64"]) == 0
    assert main(["kit", "check", str(tmp_path)]) == 3
    write_pictures(tmp_path)
    assert main(["kit", "check", str(tmp_path), "--report", str(tmp_path / "report")]) == 0
    assert (tmp_path / "report" / "report.html").is_file()
    write_pictures(tmp_path, true="eon_rho_cubed")
    assert main(["kit", "check", str(tmp_path), "--json"]) == 1
    assert f"best match: {CUBED}" in capsys.readouterr().out


def write_osl(kit, library, profile):
    """Generate OSL for each material document of a kit, and return the folder."""
    header = mx.getDefaultDataSearchPath().find("libraries/stdlib/genosl/include/mx_funcs.h")
    folder = kit / "osl"
    folder.mkdir()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ApproximationWarning)
        for file in (kit / "materials").glob("*.mtlx"):
            text = generate(file, "osl", library=library, profile=profile)[0].stages["pixel"]
            text = text.replace('"mx_funcs.h"', f'"{header.asString()}"')
            (folder / f"{file.stem}.osl").write_text(text)
    return folder


def external_run(kit, library, profile=None):
    """Export a kit, render the kit with Cycles, and return the run of the checks."""
    with available("cycles"):
        python = interpreter()
    export_kit(kit, SIZE)
    sources = write_osl(kit, library, profile)
    command = [python, "-I", "-W", "ignore", EXTERNAL_RENDERER, kit, sources, "256"]
    subprocess.run(command, capture_output=True, check=True)
    return check_kit(kit, "Cycles")


def test_cycles_as_an_external_renderer_is_named_eon_with_rho_cubed(tmp_path):
    run = external_run(tmp_path, "stock")
    assert result_of(run, "setup", "lambert").verdict == "passed"
    assert set(names(run).values()) == {CUBED}
    assert len(names(run)) == 4


def test_cycles_with_the_profile_is_named_eon(tmp_path):
    run = external_run(tmp_path, "eonlib", "cycles")
    for light in ("distant light", "environment"):
        assert result_of(run, "model", f"energy_compensation true, {light}").verdict == "passed"
        assert names(run)[f"energy_compensation true, {light}"] == EON


def test_a_kit_may_show_a_node_of_a_studios_own(tmp_path, capsys):
    kit, definitions = tmp_path / "kit", ["--definitions", str(studio(tmp_path))]
    assert main(["kit", "export", str(kit), "--node", "studio_rough", *definitions]) == 0
    policy = Policy(definitions=(str(tmp_path / "studio"),))
    (shader,) = generate(kit / "materials" / "true.mtlx", "glsl", policy=policy)
    assert "eon_brdf" in shader.stages["pixel"]
    scene = (kit / "scenes" / "true_side.usda").read_text()
    assert '"ND_studio_rough"' in scene and "energy_compensation" not in scene
    assert main(["kit", "check", str(kit), "--claims", "eon"]) == 3
    assert "none of the 8 pictures exists" in capsys.readouterr().err


def test_a_missing_picture_is_not_run(kit):
    render(kit, "true_back").unlink()
    run = check_kit(kit)
    assert "true_back.exr: must be in" in result_of(run, "file", "true_back").reason
    assert result_of(run, "model", "energy_compensation true, distant").verdict == "not run"


def plant_nan(path):
    image = read(path)
    image[SIZE // 2, SIZE // 2, 1] = np.nan
    write_exr(path, image, {})


def round_to_bytes(path):
    write_exr(path, np.rint(read(path) * 255.0) / 255.0, {})


def damage_header(path):
    path.write_bytes(path.read_bytes().replace(b"\0chlist\0", b"\0\xffhlist\0", 1))


def channels(*names, x=0, y=0):
    """Function that replaces a picture file by a picture with the given channels and origin."""
    spec = oiio.ImageSpec(SIZE, SIZE, len(names), oiio.FLOAT)
    spec.channelnames, spec.x, spec.y = list(names), x, y
    return lambda path: oiio.ImageBuf(spec).write(str(path))


def write_png(path):
    path.unlink()
    image = oiio.ImageBuf(oiio.ImageSpec(SIZE, SIZE, 3, oiio.UINT8))
    assert image.write(str(path.with_suffix(".png")))


LAYERS = ("a.R", "a.G", "a.B", "b.R", "b.G", "b.B")
SPOILED = {  # pictures, a function that damages each picture, and words of the diagnosis
    "true_front": (plant_nan, "must be finite numbers; got .* row 32, column 32"),
    "true_side": (
        lambda path: write_exr(path, read(path)[:32], {}),
        "must be 64 x 64 pixels; got 64 x 32",
    ),
    "true_back": (round_to_bytes, "never quantized to 8 bits"),
    "true_furnace": (damage_header, r"\\xffhlist"),
    "half_side": (write_png, "got uint8"),
    "false_front": (lambda path: path.with_suffix(".csv").write_text(""), "must be one file"),
    "false_side": (lambda path: path.write_text("nothing"), "must be an EXR file"),
    "false_back": (channels(*"XYZ"), "must hold one R, G and B; got channels X, Y, Z"),
    "false_furnace": (channels(*LAYERS), f"one R, G and B; got channels {', '.join(LAYERS)}"),
    "black_side": (channels(*"RGB", x=5, y=9), r"display window's corner; got \(5, 9\)"),
    "white_furnace": (lambda path: path.write_bytes(path.read_bytes()[:900]), "must be"),
}


def test_each_unusable_picture_costs_itself_alone_and_is_diagnosed(kit):
    for name, (spoil, _) in SPOILED.items():
        spoil(render(kit, name))
    run = check_kit(kit)
    for name, (_, words) in SPOILED.items():
        result = result_of(run, "file", name)
        assert result.verdict == "failed" and re.search(f"{name}.*{words}", said(result))
    assert [each.check for each in run.results].count("file") == len(SPOILED)
    assert result_of(run, "setup", "lambert").verdict == "passed"


@pytest.mark.parametrize(
    "key, value, words",
    [
        ("format", True, "format must be 1; got True"),
        ("size", 10**400, r"size must lie in \[64, 2048\]"),
        ("camera", {}, "camera must be as kit export writes it: export it again"),
        ("materials", {"clay": 1}, "materials must be as kit export writes it"),
    ],
)
def test_an_edited_description_is_refused(tmp_path, capsys, key, value, words):
    write_kit(tmp_path)
    content = json.loads((tmp_path / "kit.json").read_text())
    (tmp_path / "kit.json").write_text(json.dumps(content | {key: value}))
    assert main(["kit", "check", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert re.search(f"kit.json: {words}", error) and error.count("\n") == 1


def test_what_the_check_lacks_is_said_with_the_export_and_before_the_pictures(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setitem(sys.modules, "scipy.special", None)
    said = "kit check needs scipy: pip install '.[kit]' in a checkout of mxeon\n"
    assert main(["kit", "export", str(tmp_path), "--size", "64"]) == PASSED
    assert capsys.readouterr().err == f"mxeon: warning: {said}"
    assert main(["kit", "check", str(tmp_path)]) == MISUSE
    assert capsys.readouterr().err == f"mxeon: {said}"
