# SPDX-License-Identifier: Apache-2.0
"""Errors of surface shaders due to the fits of eonlib's lobes: python -m tools.fits.surface_shaders.

The layer equation uses each lobe's albedo by quadrature; eonlib uses a fit. The script compares
both in float64, for pairs and materials drawn as in the checks, but with other seeds. It prints the
largest errors of values and albedos due to all fits together, and of their means over a set.
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
    """Views (3, N) and alphas (2, N), clamped as in the shaders' fits."""
    alpha = np.broadcast_to(np.maximum(roughness, LEAST), (2, wo.shape[1]))
    return np.stack([*wo[:2], np.maximum(wo[2], LEAST)]), alpha


def albedo(wo, roughness):
    """E_ss by the shader's fit."""
    factors = ggx_anisotropic.terms(wo, roughness)[1]
    scale = 1.0 + np.tensordot(ggx_anisotropic.MISSED, factors, axes=1)
    return 1.0 - ggx_anisotropic.missed(wo, roughness) * scale


def missing(wo, roughness):
    """(1 - E_ss) / E_ss by the shader's fit."""
    E = albedo(*facets(wo, roughness))
    return (1.0 - E) / E


def dielectric_average(ior):
    """F_ss of a dielectric with an index of at least 1, by the shader's fit."""
    t = np.asarray(1.0 / ior)
    return 1.0 - t * fresnel_average.FORM.value((t,), AVERAGE)


def conductor_average(ior, extinction):
    """F_ss of a metal as the shader's sum over three cosines."""
    return 1.0 - sum(
        weight * (1.0 - fresnel.conductor(np.asarray(cosine), ior, extinction))
        for cosine, weight in zip(COSINES, WEIGHTS, strict=True)
    )


def fitted_albedo(points, exact, node, wo, inputs):
    """Albedo of a lobe: the shader's fit if the lobe lies over another, otherwise exact."""
    fit = LAYERED.get(node.name)
    if fit is None or exact is not node.albedo:
        return EXACT(points, exact, node, wo, inputs)
    return np.broadcast_to(fit(wo, inputs), (len(wo), 3))


def _microfacets(wo, inputs, curve):
    """E_ss F(c) (1 + F_ss (1 - E_ss) / E_ss); `curve` computes F(c) and F_ss from mu and alpha."""
    wo, roughness = facets(wo.T, inputs["roughness"].T)
    E = albedo(wo, roughness)[:, np.newaxis]
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
    assert np.all(inputs["color82"] == 1.0)  # no material has layers below a lobe with a dip

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


# Functions that compute fitted albedos, by name of the node.
LAYERED = {"dielectric": _dielectric, "schlick": _schlick, "conty_kulla": _sheen}


@contextmanager
def fits():
    """Context in which the reference uses the shader's fits instead of quadratures."""
    curve = microfacets.CONDUCTOR_CURVE
    exact = curve.average
    with ExitStack() as stack:
        stack.enter_context(patch.object(nodes.ShadingPoints, "_albedo", fitted_albedo))
        stack.enter_context(patch.object(microfacets, "missing_of", missing))
        stack.enter_context(patch.object(fresnel, "dielectric_avg", dielectric_average))
        stack.callback(object.__setattr__, curve, "average", exact)  # the class is frozen
        object.__setattr__(curve, "average", conductor_average)
        yield


def errors(shader, seed):
    """Errors in a random set by name: of values and albedos, the largest and that of the mean."""
    token = SEED.set(seed)
    [batch] = batches = shader.batches(shader.counts)
    [views] = shader.views(batches, shader.counts)
    SEED.reset(token)
    asked = ((batch, "direct"), (views, "environment"))
    exact = [shader._reference(*each) for each in asked]
    with fits():
        fitted = [shader._reference(*each) for each in asked]
    exact[0], fitted[0] = np.pi * exact[0], np.pi * fitted[0]
    stretched = specs.stretched(batch)
    pairs = {
        "values": (fitted[0][~stretched], exact[0][~stretched]),
        "albedos": (fitted[1], exact[1]),
        "values of two alphas": (fitted[0][stretched], exact[0][stretched]),
    }
    return {
        f"{kind}{suffix}": float(metric(*pair).max())
        for kind, pair in pairs.items()
        if len(pair[0]) > 0
        for suffix, metric in {"": scaled, " in the mean": mean_scaled}.items()
    }


def largest(shader, sets=SETS):
    found, seeds = [], count(SEED.get() + 1)
    while len(found) < sets:
        with suppress(OutsideModel):  # the layer equation does not cover the material
            found.append(errors(shader, next(seeds)))
    return {name: max(each[name] for each in found) for name in found[0]}


if __name__ == "__main__":
    for each in specs.SURFACE_SHADERS:
        text = ", ".join(f"{name} {error:.2g}" for name, error in largest(each).items())
        print(f"{each.node}: {text}")
