# SPDX-License-Identifier: Apache-2.0
"""A picture recorded from OSL's real programs, and stand-ins that replay the picture.

    python -c "from tests.support import osl; osl.record()"

This command records the picture again with the programs that the variables MXEON_OSLC,
MXEON_TESTRENDER and MXEON_TESTSHADE name.
"""

from pathlib import Path

import numpy as np

from mxeon.hosts import testrender_scene as scenes
from mxeon.hosts.testrender import VARIABLES, TestrenderHost
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text

FOLDER = Path(__file__).parent
# Title of the OSL build that was recorded.
TITLE = "oslc -- Open Shading Language compiler 1.15.6.0"
PICTURE = FOLDER / "pairs.tif"  # the recorded picture of direction pairs
INPUTS = {"color": (0.2, 0.5, 0.8), "roughness": 1.0, FLAG: True}
VIEWS = np.array([(0.6, 0.0, 0.8), (0.0, 0.28, 0.96), (-0.48, 0.64, 0.6), (0.96, 0.0, 0.28)])
LIGHTS = np.array([(0.0, 0.6, 0.8), (0.96, 0.0, 0.28), (0.48, -0.6, 0.64), (-0.6, 0.0, 0.8)])

# Scripts of the stand-ins. oslc prints the recorded title and copies sources as compiled shaders.
# If the scene is the recorded scene, testrender copies the recorded picture.
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
    return generate(material_text(OREN_NAYAR, INPUTS, OREN_NAYAR), "osl")[0]


def values(host):
    """Values that a host returns for the recorded pairs of directions."""
    return host.evaluate(shader(), VIEWS, LIGHTS, {}, "direct")


def write_replay(folder):
    """Write the stand-ins to a folder, and return the paths by environment variable."""
    words = {"title": TITLE, "folder": FOLDER}
    paths = {}
    for name, text in REPLAY.items():
        path = folder / name
        path.write_text(f"#!/bin/sh\n{text.format(**words)}")
        path.chmod(0o755)
        paths[VARIABLES[name]] = str(path)
    return paths


def record():
    """Record the picture again.

    TITLE is the first line of `oslc --help` and must be changed by hand.
    """
    with TestrenderHost() as host:
        values(host)
        folder = host._folder
        for name in (scenes.SCENE, scenes.POINTS, scenes.LIGHT):
            (FOLDER / name).write_text((folder / name).read_text())
        PICTURE.write_bytes((folder / "picture.tif").read_bytes())
