# SPDX-License-Identifier: Apache-2.0
"""Rational fits in several variables whose largest weighted error is least.

A fit is N / D with D = 1 + ..., both polynomials in some monomials. A search in float64, which need
not be repeatable, finds a start, or a denominator that stays away from 0. From there on linear fits
of least largest error in 40 digits, see `minimax.py`, give coefficients that are repeatable.
"""

import math
import re
from dataclasses import dataclass

import numpy as np

from mxeon.shaders.functions import source_file
from tools.fits.minimax import least_largest, mp

DIGITS = 8  # decimal digits of a printed coefficient, one more than float32 tells apart
SCATTER = 2654435769  # 2^32 over the golden ratio
STEPS = 2  # from a start of six digits; another changes no printed error


@dataclass(frozen=True)
class Form:
    """Monomials of a rational function, as tuples of exponents.

    Attributes
    ----------
    above, below : tuple of tuple of int
        Monomials of the numerator and of the denominator, whose constant 1 is left out.
    """

    above: tuple
    below: tuple

    def value(self, variables, coefficients):
        """Values at arrays of variables, numerator's coefficients first."""
        count = len(self.above)
        above = _polynomial(self.above, variables, coefficients[:count])
        return above / (1.0 + _polynomial(self.below, variables, coefficients[count:]))


def refined(form, variables, values, weights, start, steps=STEPS):
    """Coefficients with the least largest weighted error, by Newton steps from a start."""
    points = [[mp.mpf(float(x)) for x in row] for row in zip(*variables, strict=True)]
    above = [[_monomial(point, m) for m in form.above] for point in points]
    below = [[_monomial(point, m) for m in form.below] for point in points]
    goals, scale = ([mp.mpf(float(x)) for x in each] for each in (values, weights))
    found, count = [mp.mpf(c) for c in start], len(form.above)
    for _ in range(steps):
        rows, right = [], []
        for a, b, goal, weight in zip(above, below, goals, scale, strict=True):
            D = 1 + mp.fdot(b, found[count:])
            N = mp.fdot(a, found[:count]) / D
            factor = weight / D
            rows.append([factor * x for x in a] + [-factor * N * x for x in b])
            right.append(weight * (goal - N))
        change, _ = least_largest(rows, right)
        found = [x + d for x, d in zip(found, change, strict=True)]
    return tuple(float(mp.nstr(x, DIGITS)) for x in found)


def numerator(form, variables, values, weights, below):
    """Numerator's coefficients with the least largest weighted error, and the denominator's given ones."""
    points = [[mp.mpf(float(x)) for x in row] for row in zip(*variables, strict=True)]
    rows, right = [], []
    for point, value, weight in zip(points, values, weights, strict=True):
        D = 1 + mp.fdot([_monomial(point, m) for m in form.below], below)
        factor = mp.mpf(float(weight)) / D
        rows.append([factor * _monomial(point, m) for m in form.above])
        right.append(mp.mpf(float(weight)) * mp.mpf(float(value)))
    # Scattered, lest the rows that the exchange starts from lie on few lines of a grid.
    order = sorted(range(len(rows)), key=lambda i: i * SCATTER % 2**32)
    found, _ = least_largest([rows[i] for i in order], [right[i] for i in order])
    return (*(float(mp.nstr(x, DIGITS)) for x in found), *below)


def defines(form, coefficients, prefix):
    """Lines of GLSL that define the coefficients, in the order of the form."""
    count = len(form.above)
    parts = (("N", form.above, coefficients[:count]), ("D", form.below, coefficients[count:]))
    return [
        f"#define {prefix}_{letter}{''.join(map(str, m))} {x:.{DIGITS}g}"
        for letter, monomials, row in parts
        for m, x in zip(monomials, row, strict=True)
    ]


def shipped(stem, prefix, kinds="ND"):
    """Coefficients of a fit in a GLSL file, numerator first."""
    text = source_file("glsl", stem).read_text(encoding="utf-8")
    return tuple(float(x) for x in re.findall(rf"#define {prefix}_[{kinds}]\d+ (\S+)", text))


def _monomial(point, exponents):
    return math.prod((x**k for x, k in zip(point, exponents, strict=True)), start=mp.one)


def _polynomial(monomials, variables, coefficients):
    terms = (
        c * math.prod(x**k for x, k in zip(variables, m, strict=True))
        for m, c in zip(monomials, coefficients, strict=True)
    )
    return sum(terms, np.zeros_like(variables[0]))
