# SPDX-License-Identifier: Apache-2.0
"""Hydra Storm, with the MaterialX 1.39.3 that Blender ships, draws what the models say."""

import json
import subprocess
import sys
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

from mxeon.hosts.cycles.process import interpreter
from mxeon.models import dielectric_brdf, eon_brdf
from mxeon.shaders.library import eonlib_folder
from mxeon.shaders.nodes import OREN_NAYAR
from tests.support import storm
from tests.support.availability import available
from tests.support.documents import lobe, material
from tests.support.tolerances import STORM

ALPHA = 0.5
DOCUMENTS = (
    material(lobe(OREN_NAYAR, color="0.8, 0.8, 0.8", roughness="1.0", energy_compensation="true")),
    material(lobe("dielectric_bsdf", roughness=f"{ALPHA}, {ALPHA}")),
)
# Directions in the frame of the normal, which leans towards the light.
WO = np.array([-sin(storm.LEAN), 0.0, cos(storm.LEAN)])
WI = np.array([sin(storm.LIGHT - storm.LEAN), 0.0, cos(storm.LIGHT - storm.LEAN)])


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """A function that draws the documents with a library: the color of each."""
    with available("cycles"):  # USD with Storm comes with Blender
        python = interpreter()
    find = (
        "import importlib.util as each; print(each.find_spec('bpy').submodule_search_locations[0])"
    )
    blender = subprocess.run([python, "-c", find], capture_output=True, text=True, check=True)
    folder = tmp_path_factory.mktemp("storm")
    files = [folder / f"{number}.mtlx" for number in range(len(DOCUMENTS))]
    for file, text in zip(files, DOCUMENTS, strict=True):
        file.write_text(text)

    def draw(library):
        script = Path(storm.__file__)
        command = [sys.executable, "-P", script, blender.stdout.strip(), library, *files]
        done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
        assert done.returncode == 0, done.stderr
        return np.array(json.loads(done.stdout.splitlines()[-1]))

    return draw


def expected():
    """The values of the models under a light of irradiance pi."""
    eon = eon_brdf(WO, WI, 0.8, 1.0)
    dielectric = dielectric_brdf(WO, WI, 1.0, [ALPHA, ALPHA], 1.5)
    return pi * WI[2] * np.array([float(np.ravel(each)[0]) for each in (eon, dielectric)])


def test_the_folder_gives_the_models_and_materialx_alone_does_not(pictures):
    ours, stock = pictures(str(eonlib_folder())), pictures("")
    assert np.abs(ours[:, :3] - expected()[:, None]).max() <= STORM
    assert np.abs(stock[:, :3] - expected()[:, None]).max(1)[0] > 50.0 * STORM
