# SPDX-License-Identifier: Apache-2.0
"""A picture of OSL's real programs, recorded from a build, and programs that replay it.

    python -c "from tests.support import osl; osl.record()"

records it again with the programs that MXEON_OSLC, MXEON_TESTRENDER and MXEON_TESTSHADE name.
"""

from pathlib import Path

import numpy as np

from mxeon.hosts import testrender_scene as scenes
from mxeon.hosts.testrender import VARIABLES, TestrenderHost
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text

FOLDER = Path(__file__).parent
TITLE = "oslc -- Open Shading Language compiler 1.15.6.0"  # title of the recorded build
PICTURE = FOLDER / "pairs.tif"  # testrender's picture of the pairs
INPUTS = {"color": (0.2, 0.5, 0.8), "roughness": 1.0, FLAG: True}
VIEWS = np.array([(0.6, 0.0, 0.8), (0.0, 0.28, 0.96), (-0.48, 0.64, 0.6), (0.96, 0.0, 0.28)])
LIGHTS = np.array([(0.0, 0.6, 0.8), (0.96, 0.0, 0.28), (0.48, -0.6, 0.64), (-0.6, 0.0, 0.8)])

# Replays the recording: help with the recorded title, a compiled shader for each source, and the
# recorded picture, only for the recorded scene.
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
cp "{folder}/pairs.tif" "$last"
""",
    "testshade": "exit 1\n",
}


def shader():
    """The shader of the recorded picture."""
    return generate(material_text(OREN_NAYAR, INPUTS, OREN_NAYAR), "osl")[0]


def values(host):
    """A host's values for the recorded pairs."""
    return host.evaluate(shader(), VIEWS, LIGHTS, {}, "direct")


def write_replay(folder):
    """Write programs that replay the recording; their paths by the variable that names them."""
    words = {"title": TITLE, "folder": FOLDER}
    paths = {}
    for name, text in REPLAY.items():
        path = folder / name
        path.write_text(f"#!/bin/sh\n{text.format(**words)}")
        path.chmod(0o755)
        paths[VARIABLES[name]] = str(path)
    return paths


def record():
    """Record the picture again; TITLE is the first line of `oslc --help`."""
    with TestrenderHost() as host:
        values(host)
        folder = host._folder
        for name in (scenes.SCENE, scenes.POINTS, scenes.LIGHT):
            (FOLDER / name).write_text((folder / name).read_text())
        PICTURE.write_bytes((folder / "picture.tif").read_bytes())
