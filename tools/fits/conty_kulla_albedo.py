# SPDX-License-Identifier: Apache-2.0
"""The shaders' fit of min(E, 1), where E is the directional albedo of the Conty-Kulla sheen.

    E(mu, r) = exp(-mu^2 / (r (8 - 4 mu^2))) s^2 / (mu + s)^3 N / D,
    s = sqrt(r),  z = sqrt(mu / (mu + s)),

where N and D are polynomials in z and s. At small roughness r, only light near the horizon
contributes. In this limit, the exponential is sin(theta_h)^(1 / r) for the lowest possible half
vector, and the quotient s^2 / (mu + s)^3 is proportional to E at mu = 0 and at mu = 1. The fit
minimizes the largest absolute error of min(E, 1). As in `ggx_albedo.py`, the quadrature only uses
sums, products, quotients and square roots. Roughness is 4 / k with an integer k, so the quadrature
can compute powers by square roots and products.

    python -m tools.fits.conty_kulla_albedo
"""

import numpy as np

from tools.fits.ggx_albedo import graded, legendre
from tools.fits.minimax import Form, extrema, mp, printed, refined

FORM = Form(
    above=((0, 0), (0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 2), (3, 0), (3, 2)),
    below=((0, 1), (0, 2), (0, 3), (1, 0), (1, 1), (1, 2), (2, 0), (3, 0)),
)
START = (
    *(0.377934, -0.0814393, 0.196272, -0.816149, -0.489525, 0.899376),
    *(0.695761, -0.478227, -0.475273),
    *(-0.498106, 0.297915, -0.0293167, -1.9829, 0.46172, -0.258082, 1.08952, -0.102918),
)
EIGHTHS = (
    *(4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 36, 40, 44, 48, 56, 64, 80, 100, 128),
    *(170, 230, 320, 450, 640, 900, 1300, 2000, 3000, 5000, 8000, 13000, 20000, 40000),
)
TOP, LEAST = 1.02, 1e-4  # largest and smallest albedo in the fit; shaders clamp to 1
NODES = 20  # quadrature nodes per 90 degrees of azimuth


def albedo(mu, eighths):
    """Integral of f cos at roughness r = 4 / eighths, with an error below 1e-4 max(E, 1).

    f cos = (1 + p) sin(theta_h)^(2 p) / (4 pi) mu_i / (mu + mu_i - mu mu_i),  p = 1 / (2 r)
    """
    mu_i, weight = (each[:, None, None] for each in graded())
    x, w = (each[None, :, None] for each in legendre(NODES))
    s, s_i = np.sqrt((1.0 - mu) * (1.0 + mu)), np.sqrt((1.0 - mu_i) * (1.0 + mu_i))
    M = mu + mu_i
    total = np.zeros_like(mu)
    # The tangent of phi / 2 is x if phi < pi / 2, and 1 / x if phi > pi / 2, where x <= 1.
    for near, far in ((1.0, x * x), (x * x, 1.0)):
        half = near / (near + far)
        flat = (s - s_i) * (s - s_i) + 4.0 * s * s_i * half
        # Compute `lobe` = sin(theta_h)^(2 p) by square roots and products.
        base, lobe, power = np.sqrt(np.sqrt(np.sqrt(flat / (flat + M * M)))), 1.0, eighths
        while power:
            if power & 1:
                lobe = lobe * base
            base, power = base * base, power >> 1
        inner = np.add.reduce(lobe * (4.0 * w / (1.0 + x * x)), axis=1)
        total += np.add.reduce((weight * mu_i / (M - mu * mu_i))[:, 0] * inner, axis=0)
    return (1.0 + eighths / 8.0) / (4.0 * np.pi) * total


def variables(mu, roughness):
    """Returns (z, s), s^2 / (mu + s)^3, and the exponent -mu^2 / (r (8 - 4 mu^2))."""
    s = np.sqrt(roughness)
    factor = roughness / ((mu + s) * (mu + s) * (mu + s))
    exponent = -mu * mu / (roughness * (8.0 - 4.0 * mu * mu))
    return (np.sqrt(mu / (mu + s)), s), factor, exponent


def fitted(mu, roughness, coefficients):
    arguments, factor, exponent = variables(mu, roughness)
    return np.minimum(np.exp(exponent) * factor * FORM.value(arguments, coefficients), 1.0)


def points(count=37):
    """Cosines, roughnesses and albedos for the fit. Albedos are between `LEAST` and `TOP`."""
    ends = np.array(extrema(count), float)
    rows = []
    for eighths in EIGHTHS:
        roughness = 4.0 / eighths
        scaled = np.arange(1, count + 1) * 6.0 / count * np.sqrt(roughness)
        mu = np.unique(np.concatenate([ends[1:], scaled[scaled < 1.0], [1e-4, 1e-3]]))
        E = albedo(mu, eighths)
        selected = (E > LEAST) & (E < TOP)
        rows.append((mu[selected], np.full_like(mu, roughness)[selected], E[selected]))
    return tuple(np.concatenate(each) for each in zip(*rows, strict=True))


def fit():
    """Rounded coefficients of N, then of D."""
    mu, roughness, E = points()
    arguments, factor, exponent = variables(mu, roughness)
    factor = factor * np.array([float(mp.exp(mp.mpf(float(x)))) for x in exponent])
    return refined(FORM, arguments, E / factor, factor / np.maximum(E, 1.0), START)


if __name__ == "__main__":
    found = fit()
    mu, roughness, E = points(75)  # a finer grid than the grid of the fit
    largest = np.max(np.abs(fitted(mu, roughness, found) - np.minimum(E, 1.0)))
    print(*printed(found))
    print(f"largest absolute error {largest:.3g}")
