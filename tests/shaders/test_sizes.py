# SPDX-License-Identifier: Apache-2.0
"""Sizes of generated shaders with eonlib, as factors of stock MaterialX's: no machine enters."""

import pytest

from benchmarks.instructions import compiled, sources
from tests.support.availability import available

# Node, and the largest factors of text and of SPIR-V instructions: what was counted, and a twentieth.
SIZES = {
    "oren_nayar": (0.95, 1.07),
    "dielectric_bsdf": (1.79, 1.59),
    "conductor_bsdf": (1.63, 1.63),
    "generalized_schlick_bsdf": (1.78, 1.60),
    "open_pbr_surface": (1.37, 1.23),
    "standard_surface": (1.47, 1.24),
    "gltf_pbr": (1.35, 1.29),
    "UsdPreviewSurface": (1.34, 1.32),
    "chiang_hair_bsdf": (1.17, 0.49),
    "sheen_bsdf, conty_kulla": (1.08, 0.93),
    "sheen_bsdf, zeltner": (1.08, 0.93),
    "subsurface_bsdf": (1.06, 1.02),
    "translucent_bsdf": (1.24, 1.03),
}
GROWTH = 1.05


@pytest.mark.parametrize("node", SIZES)
def test_a_shader_of_eonlib_is_no_longer_than_stated(node):
    with available("vulkan"):
        eonlib, stock = sources(node).values()
        text = len(eonlib) / len(stock)
        instructions = compiled(eonlib) / compiled(stock)
    for factor, stated in zip((text, instructions), SIZES[node], strict=True):
        assert stated / GROWTH**2 <= factor <= stated * GROWTH
