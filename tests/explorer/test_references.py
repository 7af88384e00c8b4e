# SPDX-License-Identifier: Apache-2.0
"""The page's reference tables contain the models' values, and correct shaders match the tables."""

import numpy as np
import pytest

from mxeon.explorer.references import SEEN, WI, WO, pairs, reference_of, views
from mxeon.explorer.sources import MATERIALS
from mxeon.models import eon_brdf
from mxeon.models.diffuse import eon_albedo_dir
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text

# Lobes of stock MaterialX whose defects appear only in layers or with a tilted normal.
ALIKE = ("lobe/sheen_zeltner",)
COLOR = (0.8, 0.4, 0.1)


def is_correct(host, text, library, reference):
    """Whether the errors in direct light and in white surroundings are within tolerances."""
    shader = host.compile(text, library=library)[0]
    direct = np.pi * host.evaluate(shader, WO, WI, {}, "direct")
    white = host.evaluate(shader, SEEN, SEEN, {}, "environment")
    expected = np.reshape(reference.direct, (-1, 3))
    scale = np.maximum(np.abs(expected).max(axis=1, keepdims=True), 1.0)
    direct_error = (np.abs(direct - expected) / scale).max()
    white_error = np.abs(white - np.reshape(reference.white, (-1, 3))).max()
    return direct_error <= reference.bounds.direct and white_error <= reference.bounds.white


@pytest.mark.parametrize("material", MATERIALS)
def test_eonlib_is_within_the_bounds_and_stock_is_not(gl, material):
    shader = generate(material.text, "essl", lights=True)[0]
    reference = reference_of(shader)
    assert is_correct(gl, material.text, "eonlib", reference)
    assert is_correct(gl, material.text, "stock", reference) == (material.key in ALIKE)


def test_the_values_are_those_of_the_model():
    text = material_text(OREN_NAYAR, {"color": COLOR, "roughness": 0.7, FLAG: True})
    reference = reference_of(generate(text, "essl", lights=True)[0])
    expected = np.pi * WI[:, 2:] * eon_brdf(WO, WI, COLOR, 0.7)
    # The tables have seven digits, so the relative error is half a unit of the last digit.
    assert np.allclose(np.reshape(reference.direct, (-1, 3)), expected, rtol=5e-7, atol=1e-16)
    white = eon_albedo_dir(SEEN[:, 2], COLOR, 0.7)
    assert np.allclose(np.reshape(reference.white, (-1, 3)), white, rtol=5e-7)
    assert len(pairs()) == len(WO) and len(views()) == len(SEEN)
