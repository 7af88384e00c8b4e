# SPDX-License-Identifier: Apache-2.0
"""Figures of the pages on light through microfacets, by the text's equations alone."""

import numpy as np

from mxeon.models import fresnel_schlick
from mxeon.models.microfacet.albedo import dielectric_albedo_dir, generalized_schlick_albedo_dir
from mxeon.models.microfacet.lobe import DIELECTRIC
from mxeon.models.transmission.btdf import evaluate_btdf
from mxeon.models.transmission.schlick import (
    READINGS,
    generalized_schlick_transmittance_dir,
    schlick_ior,
)
from mxeon.models.transmission.transmittance import dielectric_transmittance_dir

HEAD = "| quantity | measured | expected |\n|---|---|---|\n"
ROUGH, SMOOTH = (1.0, 1.0), (0.0, 0.0)
COLORS = (0.04, 0.25, 0.6), (1.0, 0.5, 0.8), 1.0  # color0, color82, color90
DARK = 0.0, 0.0, 1.0
EXPONENT = 5.0
NODES = 1 << 10  # in cosine and in azimuth: the sum is within 1e-4 of that of twice as many


def readings_block():
    """Light that each reading of Schlick's transmission loses or gains on a smooth surface."""
    wo = np.stack([_view(mu) for mu in np.linspace(0.02, 1.0, 50)])
    R = generalized_schlick_albedo_dir(wo, *COLORS, SMOOTH, EXPONENT, compensate=False)
    rows = []
    for name, reading in READINGS.items():
        T = generalized_schlick_transmittance_dir(wo, *COLORS, SMOOTH, EXPONENT, name)
        index = ", ".join(f"{n:.2f}" for n in schlick_ior(COLORS[0], name))
        excess = R + T - 1.0
        for word, value in (("least", excess.min()), ("largest", excess.max())):
            rows.append((f"{word} R + T - 1, index {index}: {reading.title}", value, 0))
    dark = generalized_schlick_transmittance_dir(wo, *DARK, SMOOTH, EXPONENT, "unclamped")
    rows.append(("largest T of color0 0, color82 0, color90 1, as it is", dark.max(), 1))
    rows.append(_sides())
    return _table(rows, "{:.3f}")


def _sides():
    """F at the angle outside over F at the angle inside, of one path through the surface."""
    outside = 0.2
    inside = np.sqrt(1.0 - (1.0 - outside**2) / 1.5**2)
    F = [fresnel_schlick(mu, 0.04, 1.0, 1.0, EXPONENT)[0] for mu in (outside, inside)]
    return "F at the angle inside, where F at that outside, mu 0.2, is as expected", F[1], F[0]


def energy_block():
    """What white glass reflects and transmits, by the text's equations."""
    wo, glass = _view(0.3), (1.0, ROUGH, 1.5)
    R = dielectric_albedo_dir(wo, *glass)[0]
    T = dielectric_transmittance_dir(wo, *glass)[0]
    rows = [
        ("R + T of white glass, ior 1.5, alpha 1, mu 0.3, R compensated", R + T, 1),
        ("factor that T needs for it", (1.0 - R) / T, 1),
        ("T without an interface, ior 1, alpha 1, mu 0.3", _passed(0.3, 1.0), 1),
        ("R + T of ior 1/1.5, light from inside, alpha 1, mu 0.3", _both(0.3, 1.0 / 1.5), 1),
        ("integral of f_t over all lights of one view, alpha 0.001, mu 1", _albedo(), 0.96),
        ("light of wo between directions that no facet joins, alpha 1, mu 0.3", _unjoined(), 0),
    ]
    return _table(rows, "{:.3f}")


def _passed(mu, ior):
    return dielectric_transmittance_dir(_view(mu), 1.0, ROUGH, ior)[0]


def _both(mu, ior):
    return _passed(mu, ior) + dielectric_albedo_dir(_view(mu), 1.0, ROUGH, ior)[0]


def _albedo():
    """Albedo of a view from outside, over all lights inside: radiance is divided by ior^2 there."""
    return dielectric_transmittance_dir(_view(1.0), 1.0, (1e-3, 1e-3), 1.5)[0] / 1.5**2


def inside_albedo():
    """The same albedo from inside, where radiance is multiplied by ior^2."""
    transmitted = dielectric_transmittance_dir(_view(1.0), 1.0, (1e-3, 1e-3), 1.0 / 1.5)[0]
    return {"inside": transmitted * 1.5**2}


def _unjoined():
    """Share of the light from wo that the text's BTDF passes without a facet between, ior 1.5."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    mu = 0.5 * (1.0 + x)
    phi = 2.0 * np.pi * (np.arange(NODES) + 0.5) / NODES
    radius = np.sqrt(1.0 - mu * mu)[:, np.newaxis]
    wi = np.stack(
        [radius * np.cos(phi), radius * np.sin(phi), -mu[:, np.newaxis] + 0.0 * phi], axis=-1
    )
    inputs = {"tint": np.ones(1)}
    both, joined = (
        evaluate_btdf(
            DIELECTRIC.at, _view(0.3), wi, ROUGH, 1.5, inputs, {}, radiance=False, anywhere=anywhere
        )[..., 0]
        for anywhere in (True, False)
    )
    return np.sum((both - joined) * (w * mu)[:, np.newaxis]) * np.pi / NODES


def _view(mu):
    """Direction with this cosine."""
    return np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])


def _table(rows, form):
    """The block of a page, from quantities with measured and expected numbers."""
    texts = [(name, *(form.format(round(each, 6) + 0.0) for each in pair)) for name, *pair in rows]
    lines = [f"| {name} | {measured} | {expected} |\n" for name, measured, expected in texts]
    return HEAD + "".join(lines)


OF_TRANSMISSION = {
    "pbrlib_transmission_readings": readings_block,
    "pbrlib_transmission_energy": energy_block,
}
