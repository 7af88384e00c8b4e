# SPDX-License-Identifier: Apache-2.0
"""Coefficients of the shaders' `fon_loss`, which computes H(mu) without inverse cosine or division.

    H(mu) = mu [P(mu) + (1 - S)(1 - mu) Q(mu)],  S = sqrt(1 - mu^2)

H and S have a branch point at mu = 1, so errors decrease geometrically with the degrees of P and Q.
The term with Q vanishes at mu = 0 and at mu = 1, so no digits cancel there. P and Q together
minimize the largest relative error of H.

    python -m tools.fits.fon_loss
"""

import numpy as np
from numpy.polynomial.polynomial import polyval

from mxeon.models import diffuse as formulas
from tools.fits.minimax import extrema, least_largest, mp

# If P or Q had one degree less, errors would be more than ten times larger.
DEGREE_P, DEGREE_Q = 4, 3
DIGITS = 9  # enough to distinguish any two float32 numbers
COUNT = 200

# Float32 cosines at which errors are measured, with many cosines in each decade from 1e-8.
CHECKED = np.unique(
    np.concatenate([np.logspace(-8, 0, 100_000), np.linspace(1e-5, 1, 100_000)]).astype("f4")
)


def closed_form(mu):
    """H(mu) = c1 - G_F(mu) / pi for mu > 0, in 40 digits: [Portsmouth2025], Eq. (13)."""
    S = mp.sqrt((1 - mu) * (1 + mu))
    G = S * (mp.acos(mu) - mu * S) + mp.mpf(2) / 3 * (S * (1 - S**3) / mu - S)
    return mp.mpf(1) / 2 - 2 / (3 * mp.pi) - G / mp.pi


def fitted(mu, p, q):
    """The fit of H(mu), computed with the operations of shaders in the precision of `mu`."""
    one = mu.dtype.type(1.0)
    m = one - mu
    S = np.sqrt(m * (one + mu))
    return mu * (polyval(mu, p) + (one - S) * m * polyval(mu, q))


def fit(degree_p=DEGREE_P, degree_q=DEGREE_Q):
    """Coefficients that minimize the largest relative error at COUNT points."""
    rows = []
    for mu in extrema(COUNT + 1)[1:]:
        p = mu / closed_form(mu)
        q = p * (1 - mp.sqrt(1 - mu**2)) * (1 - mu)
        rows.append(
            [p * mu**k for k in range(degree_p + 1)] + [q * mu**k for k in range(degree_q + 1)]
        )
    x, _ = least_largest(rows, [mp.one] * len(rows))
    rounded = np.array([float(mp.nstr(each, DIGITS)) for each in x])
    return rounded[: degree_p + 1], rounded[degree_p + 1 :]


def largest_errors(p, q):
    """Largest relative errors of H at `CHECKED`, in float64 and in simulated float32."""
    exact = formulas.fon_loss_mu(np.float64(CHECKED))
    double = fitted(np.float64(CHECKED), p, q)
    single = fitted(CHECKED, np.float32(p), np.float32(q))
    return tuple(float(np.max(np.abs(each / exact - 1.0))) for each in (double, single))


def defines():
    rows = zip("PQ", fit(), strict=True)
    return [
        f"#define EON_{name}{k} {x:.{DIGITS}g}" for name, row in rows for k, x in enumerate(row)
    ]


if __name__ == "__main__":
    print(*defines(), sep="\n")
    print("\ncoefficients  P  Q   float64   float32   (largest relative error of H)")
    for total in (8, 9, 10):
        for q in range(5):
            p = total - 2 - q
            double, single = largest_errors(*fit(p, q))
            chosen = " <" if (p, q) == (DEGREE_P, DEGREE_Q) else ""
            print(f"{total:12}  {p}  {q}  {double:.2e}  {single:.2e}{chosen}")
