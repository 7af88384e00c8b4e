# SPDX-License-Identifier: Apache-2.0
"""Linear and rational minimax fits in 40 digits, whose results are the same on every machine.

For N unknowns, the minimax residual over many rows equals the minimax residual over some N + 1
rows, called the reference. Stiefel's exchange algorithm replaces rows of the reference until no row
has a larger residual than the reference. Each replacement raises the residual of the reference. The
algorithm is the simplex method on the dual linear program.

A rational fit is N / D with D = 1 + ..., where N and D are sums of given monomials. A search in
float64 finds starting coefficients or a denominator without zeros. Linear fits in 40 digits then
compute coefficients that are the same on every machine.
"""

import math
import re
from dataclasses import dataclass

from mpmath import MPContext

from mxeon.shaders.functions import source_file

mp = MPContext()
mp.dps = 40

EXCHANGES = 500  # maximum number of exchanges; fits in this folder need at most 50
DIGITS = 8  # decimal digits of a printed coefficient, one more than float32 resolves
SCATTER = 2654435769  # 2^32 / golden ratio; multiples modulo 2^32 are spread evenly
STEPS = 2  # Newton steps from coefficients with six digits; a third step changes no printed error


def least_largest(rows, right):
    """Minimax solution x of rows @ x = right, and the largest residual.

    `rows` has shape (M, N) with M > N. Any N of the starting rows must be independent. Raises
    ArithmeticError if the exchange does not converge.
    """

    def signed(i, sign):
        """Coefficients of x and `level` in the equation sign (rows[i] @ x - right[i]) = level."""
        return [sign * each for each in rows[i]] + [-mp.one]

    count = len(rows[0])
    indices = [(len(rows) - 1) * k // count for k in range(count + 1)]
    total = mp.matrix([0] * count + [-1])
    # Choose signs so that a sum of the reference's rows with positive weights is zero.
    signs = [(-1) ** k for k in range(count + 1)]
    weights = mp.lu_solve(mp.matrix(list(map(signed, indices, signs))).T, total)
    signs = [sign * int(mp.sign(weight)) for sign, weight in zip(signs, weights, strict=True)]
    for _ in range(EXCHANGES):
        matrix = mp.matrix(list(map(signed, indices, signs)))
        sides = mp.matrix([sign * right[i] for i, sign in zip(indices, signs, strict=True)])
        *x, level = mp.lu_solve(matrix, sides)
        residuals = [mp.fdot(row, x) - side for row, side in zip(rows, right, strict=True)]
        worst = max(range(len(rows)), key=lambda i: abs(residuals[i]))
        if abs(residuals[worst]) <= level * (1 + mp.sqrt(mp.eps)):
            return x, level
        # Replace the row of the reference whose removal keeps all weights positive.
        sign = int(mp.sign(residuals[worst]))
        weights = mp.lu_solve(matrix.T, total)
        change = mp.lu_solve(matrix.T, mp.matrix(signed(worst, sign)))
        ratios = enumerate(zip(weights, change, strict=True))
        leaving = min((w / d, k) for k, (w, d) in ratios if d > 0)[1]
        indices[leaving], signs[leaving] = worst, sign
    raise ArithmeticError(f"exchange must end within {EXCHANGES} steps")


def roots(count):
    """Roots of a Chebyshev polynomial on [0, 1], closely spaced near both ends."""
    return [(1 - mp.cos(mp.pi * (2 * k + 1) / (2 * count))) / 2 for k in range(count)]


def extrema(count):
    """Extrema of a Chebyshev polynomial on [0, 1], including both ends."""
    return [(1 - mp.cos(mp.pi * k / (count - 1))) / 2 for k in range(count)]


# --- rational fits --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Form:
    """The monomials of a rational function, as tuples of exponents."""

    above: tuple  # monomials of the numerator
    below: tuple  # monomials of the denominator, except the constant 1

    def value(self, variables, coefficients):
        """Values of N / D. Coefficients of N precede coefficients of D."""
        monomials, count = (*self.above, *self.below), len(self.above)
        terms = [c * _monomial(variables, m) for c, m in zip(coefficients, monomials, strict=True)]
        return sum(terms[:count]) / (1.0 + sum(terms[count:]))


def _monomial(point, exponents):
    return math.prod(x**k for x, k in zip(point, exponents, strict=True))


def _samples(form, variables, values, weights):
    """Yield for each point the monomials of N and of D, the value and the weight, in 40 digits."""
    for columns in zip(*variables, values, weights, strict=True):
        *point, value, weight = map(mp.mpf, columns)
        above, below = (
            [_monomial(point, m) for m in monomials] for monomials in (form.above, form.below)
        )
        yield above, below, value, weight


def refined(form, variables, values, weights, start):
    """Coefficients that minimize the largest weighted error, by Newton steps from `start`."""
    samples = list(_samples(form, variables, values, weights))
    found, count = [mp.mpf(c) for c in start], len(form.above)
    for _ in range(STEPS):
        rows, right = [], []
        for above, below, value, weight in samples:
            D = 1 + mp.fdot(below, found[count:])
            quotient = mp.fdot(above, found[:count]) / D
            factor = weight / D
            rows.append([factor * x for x in above] + [-factor * quotient * x for x in below])
            right.append(weight * (value - quotient))
        change, _ = least_largest(rows, right)
        found = [x + d for x, d in zip(found, change, strict=True)]
    return tuple(float(mp.nstr(x, DIGITS)) for x in found)


def numerator(form, variables, values, weights, below):
    """Minimax coefficients of N, followed by the given coefficients `below` of D."""
    rows, right = [], []
    for above, monomials, value, weight in _samples(form, variables, values, weights):
        factor = weight / (1 + mp.fdot(monomials, below))
        rows.append([factor * x for x in above])
        right.append(weight * value)
    # Shuffle the rows, so that the exchange starts from rows that lie on many grid lines.
    order = sorted(range(len(rows)), key=lambda i: i * SCATTER % 2**32)
    found, _ = least_largest([rows[i] for i in order], [right[i] for i in order])
    return (*(float(mp.nstr(x, DIGITS)) for x in found), *below)


def printed(coefficients):
    return [f"{x:.{DIGITS}g}" for x in coefficients]


def defines(form, coefficients, prefix):
    monomials = [("N", m) for m in form.above] + [("D", m) for m in form.below]
    return [
        f"#define {prefix}_{part}{''.join(map(str, m))} {x:.{DIGITS}g}"
        for (part, m), x in zip(monomials, coefficients, strict=True)
    ]


def shipped(stem, function):
    text = source_file("glsl", stem).read_text(encoding="utf-8")
    body = text.partition(f"{function}(")[2].partition("\n}")[0]
    parts = re.findall(r"float ([ND])\d? = (.*?);", body, re.DOTALL)
    ordered = " ".join(part for each in "ND" for kind, part in parts if kind == each)
    found = [float(x) for x in re.findall(r"-?\d+\.\d+", ordered)]
    found.remove(1.0)  # the constant 1 of the denominator
    return tuple(found)
