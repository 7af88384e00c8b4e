# SPDX-License-Identifier: Apache-2.0
"""The path tracer: values known in closed form, and samplers that agree."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.models import table as reference
from mxeon.shaders.scene import SIDE, sphere
from tests.support.tolerances import FURNACE_OPENED, TRACER_GRID, TWIN_WEIGHT
from tools.paper.tracer import MODELS, Trace, trace

# A mean is held to this many standard errors: a false alarm in 1e-5 of the tests, whose seeds are
# fixed.
STANDARD_ERRORS = 4.4
FURNACE = Trace("eon", environment=1.0, size=64, opened=False)
UNBIASED = ("uniform", "cosine", "ltc0", "eon_cltc", "eon")


def mean(image):
    """Mean of a picture, and its standard error were its pixels drawn from one distribution."""
    gray = image.mean(axis=-1, dtype=np.float64)
    return gray.mean(), gray.std() / np.sqrt(gray.size)


@pytest.mark.parametrize("sampler", UNBIASED)
def test_white_eon_returns_the_light_of_a_furnace(gl, sampler):
    value, error = mean(trace(gl, replace(FURNACE, sampler=sampler)))
    assert abs(value - 1.0) <= STANDARD_ERRORS * error + TWIN_WEIGHT


def test_white_open_ball_returns_all_light_once_paths_may_be_long(gl):
    image = trace(gl, replace(FURNACE, sampler="eon", opened=True, bounces=300))
    assert np.abs(image - 1.0).max() <= FURNACE_OPENED


TRACED = [row for row in reference.MODELS if row.name in MODELS]


@pytest.mark.parametrize("model", TRACED, ids=lambda model: model.name)
def test_side_lit_ball_has_the_values_of_the_numpy_models(gl, model):
    points, rho = sphere(512), (0.8, 0.4, 0.1)
    normal = points.normal[points.mask]
    lit = normal @ np.asarray(SIDE.light) > 0.0
    light = normal[lit] @ np.asarray(SIDE.light)
    wo, wi = frames(normal[lit], (0.0, 0.0, 1.0)), frames(normal[lit], SIDE.light)
    value = np.pi * model.brdf(wo, wi, rho, *([1.0] if model.parameter else [])) * light[:, None]
    picture = Trace(model.name, rho=rho, light=SIDE.light, opened=False, size=64)
    found = trace(gl, picture).mean(axis=(0, 1), dtype=np.float64)
    np.testing.assert_allclose(found, value.sum(axis=0) / 512**2, rtol=0.0, atol=TRACER_GRID)


def frames(normal, w):
    """A direction in the local frames of normals with z > 0."""
    x = np.cross([0.0, 1.0, 0.0], normal)
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    local = np.stack([x @ w, np.cross(normal, x) @ w, normal @ w], axis=-1)
    return local / np.linalg.norm(local, axis=-1, keepdims=True)
