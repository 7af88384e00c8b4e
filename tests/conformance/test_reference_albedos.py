# SPDX-License-Identifier: Apache-2.0
"""The reference's albedos over a picture: interpolated where a series follows them, and only there."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.reference import lobes
from mxeon.conformance.reference.lobes import TAIL, furnace
from mxeon.errors import NotRun
from mxeon.models import nodes as pbrlib
from mxeon.models.microfacet.albedo import conductor_albedo_dir
from mxeon.models.sheen import conty_kulla_albedo_dir


def test_the_albedo_over_a_picture_is_interpolated_closely():
    mu = np.linspace(0.01, 1.0, 1001)
    wo = np.stack([np.sqrt(1.0 - mu**2), 0.0 * mu, mu], axis=1)
    for roughness in (0.02, 0.3, 1.0):  # of which the first exceeds 1
        inputs = {"color": np.ones((1, 3)), "roughness": np.array([roughness])}
        values = furnace(wo, 1.0)(pbrlib.node("conty_kulla"), inputs, False).value
        truth = conty_kulla_albedo_dir(mu, roughness)[:, None]
        assert np.abs(values - truth).max() < 10.0 * TAIL


def test_what_no_polynomial_follows_is_not_interpolated():
    mu = np.linspace(0.01, 1.0, 1001)
    wo = np.stack([np.sqrt(1.0 - mu**2), 0.0 * mu, mu], axis=1)
    step = replace(
        pbrlib.node("conty_kulla"), integral=lambda wo, inputs: inputs["color"] * (wo[:, 2:] > 0.5)
    )
    inputs = {"color": np.ones((1, 3)), "roughness": np.array([0.5])}
    values = furnace(wo, 1.0)(step, inputs, False).value
    assert np.array_equal(values[:, 0], mu > 0.5)


def test_the_albedo_of_brushed_metal_is_interpolated_closely(monkeypatch):
    random = np.random.default_rng(5)
    mu, phi = 0.05 + 0.95 * random.random(1000), random.uniform(-np.pi, np.pi, 1000)
    wo = np.stack([np.sqrt(1 - mu**2) * f(phi) for f in (np.cos, np.sin)] + [mu], axis=1)
    inputs = {"ior": np.full((1, 3), 0.2), "extinction": np.full((1, 3), 3.0)}
    inputs["roughness"] = np.array([[0.3, 0.2]])
    row = pbrlib.node("conductor")
    values = furnace(wo, 1.0)(row, inputs, False).value[:20]
    truth = conductor_albedo_dir(wo[:20], [0.3, 0.2], [0.2], [3.0])
    assert np.abs(values - truth).max() < 10.0 * TAIL
    inputs["roughness"] = np.array([[1.0, 1e-3]])
    monkeypatch.setattr(lobes, "ANISOTROPIC", ((8, 4),))
    with pytest.raises(NotRun, match="so anisotropic a lobe takes too long"):
        furnace(wo, 1.0)(row, inputs, False)
