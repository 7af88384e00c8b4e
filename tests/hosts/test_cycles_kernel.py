# SPDX-License-Identifier: Apache-2.0
"""The Oren-Nayar header of Cycles' kernel computes EON once our patch is applied."""

from pathlib import Path

import numpy as np
import pytest

from mxeon.errors import NotRun
from mxeon.models import eon_brdf
from tests import support
from tests.support.availability import available, program
from tests.support.cases import directions
from tests.support.command import output
from tools.site.ledger import ROOT, apply, patches_of

PROGRAM = Path(support.__file__).with_name("oren_nayar.cpp")
# Absolute error of values up to 1, which contain an arc cosine and ten float32 roundings.
FLOAT32 = 2e-6
PAIRS = 500
KERNEL = ".venv-cycles/lib/*/site-packages/bpy/*/scripts/addons_core/cycles/source/kernel"
FILE = "closure/bsdf_oren_nayar.h"


def kernel():
    """Source folder of Cycles' kernel, which is part of Blender's Python module."""
    found = list(ROOT.glob(KERNEL))
    if not found:
        raise NotRun(f"no folder {ROOT / KERNEL}")
    return found[0]


@pytest.fixture(scope="module")
def values(tmp_path_factory):
    """Function that computes pi f cos of random pairs with the patched header and the model."""
    with available("cycles"):
        folder = kernel()
    rng = np.random.default_rng(5)
    wo, wi = directions((2, PAIRS), rng, least=0.01)
    rho, roughness = rng.uniform(size=(PAIRS, 3)), rng.uniform(size=(PAIRS, 1))
    lines = "\n".join(" ".join(map(str, row)) for row in np.hstack([wo, wi, rho, roughness]))
    right = np.pi * wi[:, 2:] * eon_brdf(wo, wi, rho, roughness[:, 0])

    def run(*patches):
        target = tmp_path_factory.mktemp("kernel")
        # These headers may be empty, because PROGRAM contains their definitions.
        for name in ("types.h", "sample/mapping.h"):
            (target / "kernel" / name).parent.mkdir(parents=True, exist_ok=True)
            (target / "kernel" / name).touch()
        (target / FILE).parent.mkdir()
        (target / FILE).write_bytes((folder / FILE).read_bytes())
        # `strip=4` removes `a/intern/cycles/kernel` from the paths in the patch.
        apply(target, *patches, strip=4)
        command = [program("g++"), "-std=c++17", f"-I{target}", PROGRAM, "-o", target / "program"]
        output(*command)
        found = output(target / "program", input=lines).split()
        return np.array(found, float).reshape(PAIRS, 3), right

    return run


def test_the_header_has_one_power_of_the_color_too_many(values):
    found, right = values()
    assert np.abs(found - right).max() > 0.01


def test_the_repaired_header_is_eon(values):
    found, right = values(*patches_of("cycles_rho_cubed"))
    assert np.abs(found - right).max() < FLOAT32
