# SPDX-License-Identifier: Apache-2.0
"""The shaders' fits of F_ss, the cosine-weighted average of a Fresnel reflectance.

For a dielectric with an IOR n above 1, the fit uses t = 1 / n:

    1 - F_ss = t N / D,

where N and D are polynomials in t. For an IOR below 1, 1 - F_ss(n) = n^2 (1 - F_ss(1 / n)). The fit
for metals is a sum over three cosines c_k:

    1 - F_ss = sum of w_k (1 - F(c_k)),

where the weights w_k minimize the largest error over metals. Schlick's curve needs no fit.

    python -m tools.fits.fresnel_average
"""

import re

import numpy as np

from mxeon.models.microfacet import fresnel
from mxeon.shaders.functions import source_file
from tools.fits.ggx_albedo import legendre
from tools.fits.minimax import DIGITS, Form, least_largest, mp, printed, roots

COUNT = 400
FORM = Form(above=tuple((k,) for k in range(5)), below=tuple((k,) for k in range(1, 4)))
STEPS = 12  # number of linear fits; more fits change no printed digit

COSINES = (0.22, 0.58, 0.9)
INDICES = (*(float(mp.mpf(5) ** (mp.mpf(k) / 6 - 1) / 4) for k in range(12)), 5.0)
EXTINCTIONS = (0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10)
NODES = 24  # quadrature nodes of the average over the hemisphere


def dielectric_average(n):
    """F_ss of a dielectric for n > 1, in closed form [Walsh1926]."""
    n2 = n * n
    n4 = n2 * n2
    return (
        mp.mpf(1) / 2
        + (n - 1) * (3 * n + 1) / (6 * (n + 1) ** 2)
        + n2 * (n2 - 1) ** 2 / (n2 + 1) ** 3 * mp.log((n - 1) / (n + 1))
        - 2 * n**3 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1))
        + 8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) ** 2) * mp.log(n)
    )


def dielectric_fit():
    """Coefficients of N and D by repeated linear fits that minimize (N - D T) / D'.

    T is the exact value of N / D, and D' is the denominator of the previous fit. The fits converge
    to the minimax fit.
    """
    t, above = roots(COUNT), len(FORM.above)
    T = [(1 - dielectric_average(1 / x)) / x for x in t]
    D = [mp.one] * COUNT
    for _ in range(STEPS):
        rows, right = [], []
        for x, quotient, divisor in zip(t, T, D, strict=True):
            factors = [x / divisor * x**k for k in range(above)]
            rows.append(factors + [-quotient * each for each in factors[1 : 1 + len(FORM.below)]])
            right.append(quotient * factors[0])
        found, _ = least_largest(rows, right)
        D = [1 + mp.fsum(each * x**k for k, each in enumerate(found[above:], 1)) for x in t]
    return tuple(float(mp.nstr(x, DIGITS)) for x in found)


def dielectric_error(coefficients):
    """Largest absolute error of F_ss at more points than the fit uses."""
    points = roots(4 * COUNT + 1)
    exact = np.array([dielectric_average(1 / x) for x in points], float)
    t = np.array(points, float)
    return float(np.abs(1.0 - exact - t * FORM.value((t,), coefficients)).max())


def metals(n, k):
    """F_ss of metals, with errors below 1e-6, and the metals' reflectances at COSINES, (N, 3)."""
    n, k = (each.ravel() for each in np.meshgrid(n, k, indexing="ij"))

    def at(c):
        return fresnel.conductor(np.full(n.shape, c), n, k)

    average = sum(2.0 * w * c * at(c) for c, w in zip(*legendre(NODES), strict=True))
    return average, np.stack([at(c) for c in COSINES], axis=1)


def conductor_error(weights, n, k):
    """Largest absolute error of the fit of F_ss for metals."""
    exact, at = metals(n, k)
    return float(np.abs(1.0 - (1.0 - at) @ weights - exact).max())


def conductor_fit():
    """Weights of the three cosines, chosen to minimize the largest absolute error over metals."""
    exact, at = metals(INDICES, EXTINCTIONS)
    weights, _ = least_largest((1.0 - at).tolist(), (1.0 - exact).tolist())
    return tuple(float(mp.nstr(w, DIGITS)) for w in weights)


def shipped_conductor():
    text = source_file("glsl", "fresnel_conductor").read_text(encoding="utf-8")
    pairs = re.findall(r"- ([\d.]+) \* \(1\.0 - mx_fresnel_conductor\(([\d.]+),", text)
    return np.array(pairs, float).T


if __name__ == "__main__":
    found = dielectric_fit()
    print("dielectrics", *printed(found))
    print(f"largest absolute error, dielectrics: {dielectric_error(found):.3g}")
    weights = conductor_fit()
    print("metals", *printed(weights))
    for least in (0.5, 0.2):  # the fit covers extinctions of at least 0.5
        error = conductor_error(weights, np.linspace(0.05, 5.0, 200), np.linspace(least, 10.0, 200))
        print(f"largest absolute error, metals of an extinction from {least}: {error:.3g}")
