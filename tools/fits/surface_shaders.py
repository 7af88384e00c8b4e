# SPDX-License-Identifier: Apache-2.0
"""Errors of surface shaders due to the fits of lobes' albedos.

    python -m tools.fits.surface_shaders

The layer equation needs the albedo of each lobe. The reference computes albedos by quadrature, and
eonlib uses fits. The script evaluates surfaces with quadrature and with all fits, in float64, for
random directions and materials that differ from the samples of the checks. The script prints the
largest errors of values, of albedos, and of means over a set.
"""

from contextlib import ExitStack, contextmanager, suppress
from itertools import count
from unittest.mock import patch

import numpy as np

from mxeon.conformance.reference import nodes
from mxeon.conformance.samples import SEED
from mxeon.conformance.specs import surface_shaders as specs
from mxeon.conformance.tolerance import mean_scaled, scaled
from mxeon.errors import OutsideModel
from mxeon.models import microfacet as microfacets
from mxeon.models.microfacet import fresnel
from tools.fits import conty_kulla_albedo, fresnel_average, ggx_anisotropic, ggx_cosine
from tools.fits.minimax import shipped

SETS = 32
LEAST = 1e-6  # smallest cosine and roughness to which shaders apply their fits
EXACT = nodes.ShadingPoints._albedo

DIELECTRIC = shipped("fresnel_dielectric", "ggx_cosine_dielectric")
SCHLICK = shipped("fresnel_schlick", "ggx_cosine_schlick")
SHEEN = shipped("conty_kulla_albedo", "conty_kulla_albedo_dir")
AVERAGE = shipped("fresnel_dielectric", "eonlib_fresnel_dielectric_avg")
WEIGHTS, COSINES = fresnel_average.shipped_conductor()


def facets(wo, roughness):
    """Directions, (3, N), and alphas, (2, N), clamped to the range of the shaders' fits."""
    alpha = np.broadcast_to(np.maximum(roughness, LEAST), (2, wo.shape[1]))
    return np.stack([*wo[:2], np.maximum(wo[2], LEAST)]), alpha


def missing(wo, roughness):
    """(1 - E_ss) / E_ss by the shader's fit."""
    E = ggx_anisotropic.corrected(*facets(wo, roughness))
    return (1.0 - E) / E


def dielectric_average(ior):
    """F_ss of a dielectric with an IOR of at least 1, by the shader's fit."""
    t = np.asarray(1.0 / ior)
    return 1.0 - t * fresnel_average.FORM.value((t,), AVERAGE)


def conductor_average(ior, extinction):
    """F_ss of a metal as the shader's sum over three cosines."""
    return 1.0 - sum(
        weight * (1.0 - fresnel.conductor(np.asarray(cosine), ior, extinction))
        for cosine, weight in zip(COSINES, WEIGHTS, strict=True)
    )


def lobe_albedo(points, exact, node, wo, inputs):
    """The fitted albedo of a lobe that can be a top layer, or the exact albedo of another lobe."""
    fit = LAYERED.get(node.name)
    if fit is None or exact is not node.albedo:
        return EXACT(points, exact, node, wo, inputs)
    return np.broadcast_to(fit(wo, inputs), (len(wo), 3))


def _microfacets(wo, inputs, curve):
    """E_ss F(c) (1 + F_ss (1 - E_ss) / E_ss), where `curve` computes F(c) and F_ss."""
    wo, roughness = facets(wo.T, inputs["roughness"].T)
    E = ggx_anisotropic.corrected(wo, roughness)[:, np.newaxis]
    F, average = curve(*ggx_anisotropic.visible(wo, roughness))
    return E * F + F * average * (1.0 - E)


def _dielectric(wo, inputs):
    def curve(mu, alpha):
        n = inputs["ior"]
        shape = np.sqrt((n - 1.0) / (n + 1.0))
        c = ggx_cosine.cosine(ggx_cosine.DIELECTRIC, mu, alpha, shape, DIELECTRIC)
        return (each[:, np.newaxis] for each in (fresnel.dielectric(c, n), dielectric_average(n)))

    return inputs["tint"] * _microfacets(wo, inputs, curve)


def _schlick(wo, inputs):
    assert np.all(inputs["color82"] == 1.0)  # no top layer uses color82

    def curve(mu, alpha):
        exponent = inputs["exponent"]
        shape = 4.0 / (3.0 + exponent)
        c = ggx_cosine.cosine(ggx_cosine.SCHLICK, mu, alpha, shape, SCHLICK)
        low, high = inputs["color0"], inputs["color90"]
        shares = (1.0 - c) ** exponent, 2.0 / ((exponent + 1.0) * (exponent + 2.0))
        return (low + (high - low) * share[:, np.newaxis] for share in shares)

    return _microfacets(wo, inputs, curve)


def _sheen(wo, inputs):
    E = conty_kulla_albedo.fitted(wo[:, 2], inputs["roughness"], SHEEN)
    return inputs["color"] * E[:, np.newaxis]


# Fitted albedos of top layers, by name of the node.
LAYERED = {"dielectric": _dielectric, "schlick": _schlick, "conty_kulla": _sheen}


@contextmanager
def fits():
    """Make the reference use the shader's fits instead of quadratures."""
    curve = microfacets.CONDUCTOR_CURVE
    exact = curve.average
    with ExitStack() as stack:
        stack.enter_context(patch.object(nodes.ShadingPoints, "_albedo", lobe_albedo))
        stack.enter_context(patch.object(microfacets, "missing_of", missing))
        stack.enter_context(patch.object(fresnel, "dielectric_avg", dielectric_average))
        stack.callback(object.__setattr__, curve, "average", exact)  # the class is frozen
        object.__setattr__(curve, "average", conductor_average)
        yield


def errors(shader, seed):
    """By name, the largest errors of values and albedos in a random set, and of mean values."""
    token = SEED.set(seed)
    [batch] = batches = shader.batches(shader.counts)
    [views] = shader.views(batches, shader.counts)
    SEED.reset(token)

    def evaluated():
        return np.pi * shader._reference(batch, "direct"), shader._reference(views, "environment")

    value, albedo = evaluated()
    with fits():
        fitted_value, fitted_albedo = evaluated()
    stretched = specs.stretched(batch)
    pairs = {
        "values": (fitted_value[~stretched], value[~stretched]),
        "albedos": (fitted_albedo, albedo),
        "values of two alphas": (fitted_value[stretched], value[stretched]),
    }
    return {
        f"{kind}{suffix}": float(metric(*pair).max())
        for kind, pair in pairs.items()
        if len(pair[0]) > 0
        for suffix, metric in {"": scaled, " in the mean": mean_scaled}.items()
    }


def largest(shader):
    """Largest errors by name, for random sets of inputs that the layer equation covers."""
    found, seeds = [], count(SEED.get() + 1)
    while len(found) < SETS:
        with suppress(OutsideModel):
            found.append(errors(shader, next(seeds)))
    return {name: max(each[name] for each in found) for name in found[0]}


if __name__ == "__main__":
    for each in specs.SURFACE_SHADERS:
        text = ", ".join(f"{name} {error:.2g}" for name, error in largest(each).items())
        print(f"{each.node}: {text}")
