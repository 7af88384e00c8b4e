# SPDX-License-Identifier: Apache-2.0
"""Facts about OSL's real programs, recorded from a build, and programs that replay them.

    python -m tests.support.osl

records them again with the programs that MXEON_OSLC, MXEON_TESTRENDER and MXEON_TESTSHADE name.
"""

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from mxeon.hosts import testrender_scene as scenes
from mxeon.hosts.osl.engines import VARIABLES, find_program
from mxeon.hosts.testrender import Host
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text

FOLDER = Path(__file__).parent
FACTS = FOLDER / "facts.json"
PICTURE = FOLDER / "pairs.tif"  # testrender's picture of the pairs
INPUTS = {"color": (0.2, 0.5, 0.8), "roughness": 1.0, FLAG: True}
VIEWS = np.array([(0.6, 0.0, 0.8), (0.0, 0.28, 0.96), (-0.48, 0.64, 0.6), (0.96, 0.0, 0.28)])
LIGHTS = np.array([(0.0, 0.6, 0.8), (0.96, 0.0, 0.28), (0.48, -0.6, 0.64), (-0.6, 0.0, 0.8)])

MISSPELLED = """shader wrong(output closure color out = 0)
{
    out = oren_nayar_diffuse_bsdf(N, color(0.5), 0.5, "energy_compensaton", 1);
}
"""

# Replays the recording: help with the recorded title, a compiled shader for each source, and the
# recorded picture for the recorded scene alone.
REPLAY = {
    "oslc": """case "$1" in
    --help) echo "{title}"; exit 0 ;;
esac
for last; do :; done
grep -n no_such_function "$last" && exit 1
cp "$last" "${{last%.osl}}.oso"
""",
    "testrender": """for last; do :; done
for name in scene.xml points.obj light.obj; do cmp $name "{folder}/$name" || exit 1; done
echo '{warning}' >&2
cp "{folder}/pairs.tif" "$last"
""",
    "testshade": "exit 1\n",
}


def facts():
    """The recorded facts, by name."""
    return json.loads(FACTS.read_text())


def shader():
    """The shader of the recorded picture."""
    return generate(material_text(OREN_NAYAR, INPUTS, OREN_NAYAR), "osl")[0]


def values(host):
    """What a host has for the recorded pairs."""
    return host.evaluate(shader(), VIEWS, LIGHTS, {}, "direct")


def write_replay(folder):
    """Write programs that replay the recording; their paths by the variable that names them."""
    words = {"title": facts()["title"], "warning": facts()["warning"], "folder": FOLDER}
    paths = {}
    for name, text in REPLAY.items():
        path = folder / name
        path.write_text(f"#!/bin/sh\n{text.format(**words)}")
        path.chmod(0o755)
        paths[VARIABLES[name]] = str(path)
    return paths


def record():
    """Record the facts again."""
    with Host() as host:
        values(host)
        folder = host._folder
        for name in (scenes.SCENE, scenes.POINTS, scenes.LIGHT):
            (FOLDER / name).write_text((folder / name).read_text())
        PICTURE.write_bytes((folder / "picture.tif").read_bytes())
    recorded = {
        "title": _run("oslc", "--help")[0].splitlines()[0],
        "warning": _warning(),
    }
    FACTS.write_text(json.dumps(recorded, indent=2) + "\n")


def _warning():
    """The line by which testrender says that a closure has no such keyword."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "wrong.osl").write_text(MISSPELLED)
        root = "shader root(closure color material = 0) { Ci = material; }"
        (Path(folder) / "root.osl").write_text(root)
        for name in ("wrong", "root"):
            _run("oslc", "-q", f"{name}.osl", folder=folder)
        (Path(folder) / "scene.xml").write_text(
            '<World><ShaderGroup name="plane">shader wrong material ; shader root root ; '
            "connect material.out root.material ;</ShaderGroup>"
            '<Quad corner="-1,-1,-1" edge_x="2,0,0" edge_y="0,2,0" /></World>'
        )
        output = _run("testrender", "--res", "2", "2", "scene.xml", "picture.tif", folder=folder)
    return output[1].strip()


def _run(program, *arguments, folder=None):
    """Standard output and error of a program."""
    command = [find_program(program), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return done.stdout, done.stderr
