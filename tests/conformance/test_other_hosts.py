# SPDX-License-Identifier: Apache-2.0
"""Nodes are judged on other hosts than gl. Each behavior that depends on the host has a check.

`test_upstream.py` covers the failures on Cycles that docs/upstream describes.
"""

from itertools import product

import pytest

from tests.support.verdicts import FAILED, NOT_RUN, PASSED

EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
ZELTNER, DIELECTRIC = "sheen_bsdf, mode zeltner", "dielectric_bsdf, scatter_mode R"
TRANSLATED = ("hlsl", "dxc", "naga")
PICTURED = (  # checks and nodes for hosts that only render pictures
    *(("value", EON), ("environment", EON), ("furnace", EON), ("value", "burley_diffuse_bsdf")),
    *(("value", "translucent_bsdf"), ("value", DIELECTRIC)),
)
HAIR = (
    *("chiang_hair_roughness, roughness_TRT", "deon_hair_absorption_from_melanin"),
    "chiang_hair_absorption_from_color",
)


@pytest.mark.parametrize(
    "host, library, check, title, verdict, words",
    [
        ("webgl", "stock", "transmission", ZELTNER, FAILED, "all light passes"),
        ("webgl", "eonlib", "radiance", "conical_edf", PASSED, ""),
        ("wgsl", "stock", "transmission", ZELTNER, FAILED, "all light passes"),
        *((host, "stock", "transmission", ZELTNER, FAILED, "all light passes") for host in TRANSLATED),
        *((host, "eonlib", "environment", DIELECTRIC, PASSED, "") for host in TRANSLATED),
        ("hlsl", "eonlib", "output", HAIR[0], PASSED, ""),
        ("slang", "eonlib", "value", ZELTNER, PASSED, ""),
        ("slang", "eonlib", "value", DIELECTRIC, PASSED, ""),
        ("cycles", "stock", "value", "burley_diffuse_bsdf", PASSED, ""),
        ("cycles", "stock", "black", "translucent_bsdf", NOT_RUN, "'translucent_bsdf' is not supported"),
        ("cycles", "stock", "radiance", "generalized_schlick_edf", PASSED, ""),
        ("cycles", "eonlib", "radiance", "conical_edf", PASSED, ""),
        ("cycles", "stock", "radiance", "add, EDF", PASSED, ""),
        ("cycles", "stock", "opacity", "surface, an EDF alone", PASSED, ""),
        ("cycles", "stock", "implemented", "conical_edf", FAILED, ""),
        ("cycles", "stock", "transmittance", "anisotropic_vdf", NOT_RUN, ""),
        ("cycles", "stock", "inputs", HAIR[2], FAILED, ""),
        *(("cycles", "eonlib", "output", title, PASSED, "") for title in HAIR),
        ("cycles", "stock", "output", "blackbody", PASSED, ""),
        *((host, "eonlib", check, title, PASSED, "") for host, (check, title) in product(
            ("storm", "materialx"), PICTURED)),
        ("materialx", "eonlib", "environment", "translucent_bsdf", PASSED, ""),
        ("storm", "eonlib", "lobe", "UsdPreviewSurface", PASSED, ""),
    ],
)  # fmt: skip
def test_a_host_has_the_verdict_that_is_known(judged, host, library, check, title, verdict, words):
    result = judged(check, title, host, library)
    assert result.verdict == verdict and words in (result.reason or result.explanation)
    assert verdict == NOT_RUN or not result.control or result.control.caught
