# SPDX-License-Identifier: Apache-2.0
"""Generated shaders with eonlib do not grow, relative to shaders with stock MaterialX."""

import pytest

from tests.support.availability import available
from tools.benchmarks.registers import compiled, sources

# Measured sizes of shaders with eonlib, divided by the sizes with stock MaterialX. A size is the
# length of the source or the number of SPIR-V instructions. The test fails if a ratio grows by 5 %,
# or falls by 10 %, after which the ratios must be measured again.
SIZES = {
    "oren_nayar": (0.95, 1.07),
    "dielectric_bsdf": (1.79, 1.79),
    "conductor_bsdf": (1.63, 1.55),
    "generalized_schlick_bsdf": (1.71, 1.69),
    "open_pbr_surface": (1.32, 1.30),
    "standard_surface": (1.38, 1.33),
    "gltf_pbr": (1.38, 1.38),
    "UsdPreviewSurface": (1.41, 1.41),
    "chiang_hair_bsdf": (0.99, 0.49),
    "sheen_bsdf, conty_kulla": (1.07, 0.93),
    "sheen_bsdf, zeltner": (1.07, 0.93),
    "subsurface_bsdf": (0.87, 1.03),
    "translucent_bsdf": (1.00, 1.03),
}
GROWTH = 1.05


@pytest.mark.parametrize("node", SIZES)
def test_a_shader_of_eonlib_is_no_longer_than_stated(node, tmp_path):
    with available("vulkan"):
        eonlib, stock = (stages["pixel"] for stages in sources(node).values())
        text = len(eonlib) / len(stock)
        own, other = (compiled(each, "frag", tmp_path / "frag.spv") for each in (eonlib, stock))
    for factor, stated in zip((text, own / other), SIZES[node], strict=True):
        assert stated / GROWTH**2 <= factor <= stated * GROWTH
