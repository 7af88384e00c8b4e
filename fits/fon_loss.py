# SPDX-License-Identifier: Apache-2.0
"""Coefficients of `fon_loss` in the shaders: H(mu) without an inverse cosine and without a division.

    H(mu) = mu [P(mu) + (1 - S)(1 - mu) Q(mu)],  S = sqrt(1 - mu^2)

P takes the even part of H in S, and Q the odd part, which vanishes like 1 - mu at normal incidence.
With 1 - S in place of S the second term also vanishes at grazing, so that nothing cancels there.
The largest relative error of H is made least by linear programming, from the closed form alone.

    python fits/fon_loss.py
"""

import numpy as np
from scipy.optimize import linprog

# One degree less in either costs a factor above ten; the table that this script prints says so.
DEGREE_P, DEGREE_Q = 4, 3
DIGITS = 9  # decimal digits that tell any two float32 numbers apart
SCALE = 1e6  # brings errors near 1e-7 above the solver's tolerance of 1e-7

# Extrema of a Chebyshev polynomial, dense towards both ends, where errors of fits are largest.
NODES = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 401)[1:])

# Every decade from 1e-8 and every part of [0, 1], exactly representable.
CHECKED = np.unique(
    np.concatenate([np.logspace(-8, 0, 100_000), np.linspace(1e-5, 1, 100_000)]).astype("f4")
)


def closed_form(mu):
    """H(mu) = c1 - G_F(mu) / pi, [Portsmouth2025], Eq. (13), in float64, without cancellation.

    Put theta = pi / 2 - 2 atan(t), t = mu / (1 + S), and 1 - S = mu t into Eq. (13).
    """
    mu = np.float64(mu)
    c1 = 0.5 - 2.0 / (3.0 * np.pi)
    S = np.sqrt((1.0 - mu) * (1.0 + mu))
    t = mu / (1.0 + S)
    return mu * t * (c1 - S * t * (2.0 + S) / (3.0 * np.pi)) + 2.0 / np.pi * S * np.arctan(t)


def fitted(mu, p, q):
    """H(mu) from coefficients, in the precision of `mu`, operation by operation as the shaders."""
    one = mu.dtype.type(1.0)
    m = one - mu
    S = np.sqrt(m * (one + mu))
    return mu * (_horner(mu, p) + (one - S) * m * _horner(mu, q))


def fit(degree_p=DEGREE_P, degree_q=DEGREE_Q):
    """Coefficients with the least largest relative error on `NODES`.

    Parameters
    ----------
    degree_p, degree_q : int
        Degrees of P and Q.

    Returns
    -------
    p, q : ndarray, shapes (degree_p + 1,) and (degree_q + 1,)
        Rounded to `DIGITS` digits, lowest power first.
    """
    m, S = 1.0 - NODES, np.sqrt(1.0 - NODES**2)
    even = [NODES**k for k in range(degree_p + 1)]
    odd = [(1.0 - S) * m * NODES**k for k in range(degree_q + 1)]
    basis = np.stack(even + odd, axis=1) * (NODES / closed_form(NODES))[:, None] * SCALE

    # Minimise e with |basis x - 1| <= e, both sides scaled.
    e, target = np.ones((len(NODES), 1)), np.full(len(NODES), SCALE)
    constraints = np.block([[basis, -e], [-basis, -e]])
    cost = np.append(np.zeros(basis.shape[1]), 1.0)
    bounds = np.append(target, -target)
    found = linprog(cost, constraints, bounds, bounds=(None, None), method="highs-ds")
    rounded = np.array([float(f"{x:.{DIGITS}g}") for x in found.x[:-1]])
    return rounded[: degree_p + 1], rounded[degree_p + 1 :]


def largest_errors(p, q):
    """Largest relative error of H over `CHECKED` in float64, and in simulated float32."""
    exact = closed_form(CHECKED)
    double = fitted(np.float64(CHECKED), p, q)
    single = fitted(CHECKED, np.float32(p), np.float32(q))
    return tuple(float(np.max(np.abs(each / exact - 1.0))) for each in (double, single))


def defines():
    """The coefficients as the lines that stand in the shaders.

    Returns
    -------
    list of str
    """
    rows = zip("PQ", fit(), strict=True)
    return [
        f"#define EON_{name}{k} {x:.{DIGITS}g}" for name, row in rows for k, x in enumerate(row)
    ]


def _horner(mu, coefficients):
    value = np.full_like(mu, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        value = coefficient + mu * value
    return value


def main():
    """Print the lines for the shaders, and what other degrees would give."""
    print(*defines(), sep="\n")
    print("\ncoefficients  P  Q   float64   float32   (largest relative error of H)")
    for total in (8, 9, 10):
        for degree_q in range(5):
            degree_p = total - 2 - degree_q
            double, single = largest_errors(*fit(degree_p, degree_q))
            chosen = " <" if (degree_p, degree_q) == (DEGREE_P, DEGREE_Q) else ""
            print(f"{total:12}  {degree_p}  {degree_q}  {double:.2e}  {single:.2e}{chosen}")


if __name__ == "__main__":
    main()
