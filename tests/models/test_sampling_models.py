# SPDX-License-Identifier: Apache-2.0
"""Samples of microfacets, sheen and coats have the right distribution and weights.

`test_catalog` checks two more properties of every model: the sampler returns the density `pdf`, and
the mean weight is the albedo. Seeds are fixed. With random seeds, some test of this file would fail
by chance with the probability FALSE_ALARM.
"""

from functools import partial

import numpy as np
import pytest

import mxeon
from mxeon.models import dielectric_brdf, fresnel_dielectric, smith_g1, smith_g2_anisotropic
from mxeon.models.sampling import ggx_pdf, ggx_sample, zeltner_sample
from mxeon.models.sheen import zeltner_albedo_dir, zeltner_brdf
from tests.support.cases import direction
from tests.support.hemispheres import probability, uniforms

FALSE_ALARM = 1e-4
FACETS = [(1.0, (0.3, 0.3)), (0.5, (0.2, 0.7)), (0.1, (0.5, 0.5)), (0.0, (1.0, 0.4))]
COATS = [(1.0, 0.3, 1.5), (0.5, 0.1, 1.5), (0.1, 0.5, 2.5), (0.0, 0.3, 1.1)]
CLAY = {"color": np.array([0.7, 0.35, 0.12]), "roughness": 0.6}
# Model, cosine of the view, inputs, and different inputs whose samples must fail the test.
SCENES = [
    *(("conductor", mu, {"roughness": a}, {"roughness": (1.1 * a[0] % 1.0, a[1])}) for mu, a in FACETS),
    *(
        ("zeltner", mu, {"roughness": r}, {"roughness": 1.2 * r % 1.0})
        for mu, r in ((1.0, 0.6), (0.7, 0.3), (0.1, 1.0), (0.0, 0.6))
    ),
    *(
        (name, mu, inputs, inputs | {"alpha": 1.5 * alpha})
        for name in ("dielectric_over_eon", "varnished")
        for mu, alpha, ior in COATS
        for inputs in [CLAY | {"alpha": alpha, "ior": ior}]
    ),
]  # fmt: skip
every_scene = pytest.mark.parametrize("mu, alpha", FACETS, ids=str)


@pytest.mark.parametrize("scene", range(len(SCENES)), ids=lambda k: f"{SCENES[k][0]} {k}")
def test_samples_pass_the_chi_square_test_against_their_density_and_others_fail(scene):
    name, mu, inputs, others = SCENES[scene]
    model, u = mxeon.model(name), uniforms(100_000, [scene, 7])
    for sampled in (inputs, others):
        sample, pdf = partial(model.sample, **sampled), partial(model.pdf, **inputs)
        p = probability(sample, pdf, direction(mu, 0.4), u, nodes=32)
        assert p > FALSE_ALARM / len(SCENES) if sampled is inputs else p < FALSE_ALARM


@every_scene
def test_the_weight_is_fresnel_times_the_quotient_of_maskings(mu, alpha):
    mu = max(mu, 1e-3)
    wo = direction(mu, 0.4)
    wi, pdf = ggx_sample(wo, uniforms(200, 5), alpha)
    wi, pdf = wi[wi[:, 2] > 1e-3], pdf[wi[:, 2] > 1e-3]
    value = dielectric_brdf(wo, wi, 1.0, alpha, 1.5, False, False)[:, 0]
    F = fresnel_dielectric(np.sqrt(0.5 + 0.5 * wi @ wo), 1.5)
    weight = F * smith_g2_anisotropic(wo, wi, alpha) / smith_g1(wo, alpha)
    assert np.allclose(value * wi[:, 2] / pdf, weight, rtol=1e-11, atol=0.0)
    assert (smith_g2_anisotropic(wo, wi, alpha) <= smith_g1(wo, alpha) * (1.0 + 1e-15)).all()


def test_a_mirror_reflects_in_the_mirror_direction():
    for alpha in ([0.0, 0.0], [0.0, 0.5]):
        wi, pdf = ggx_sample(direction(0.5), [0.3, 0.6], alpha)
        assert np.isfinite(wi).all() and pdf == 0.0
    assert np.allclose(ggx_sample(direction(0.5), [0.3, 0.6], [0.0, 0.0])[0], direction(0.5, np.pi))
    assert np.allclose(ggx_sample(direction(0.0), [0.3, 0.6], [0.0, 0.0])[0], direction(0.0, np.pi))
    assert ggx_pdf(direction(0.0), direction(0.0, np.pi), [0.5, 0.5]) > 0.0


@pytest.mark.parametrize("roughness", (0.0, 0.05, 0.3, 1.0))
@pytest.mark.parametrize("mu", (1.0, 0.5, 1e-3, 0.0))
def test_every_sample_of_sheen_weighs_the_albedo(mu, roughness):
    wo = direction(mu, 2.0)
    wi, pdf = zeltner_sample(wo, uniforms(200, 3), roughness)
    weight = zeltner_brdf(wo, wi, 1.0, roughness)[:, 0] * wi[:, 2] / pdf
    assert np.allclose(weight, zeltner_albedo_dir(mu, roughness), rtol=1e-9, atol=0.0)
