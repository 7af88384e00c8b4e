# SPDX-License-Identifier: Apache-2.0
"""Linear fits whose largest error is least, in 40 digits: the same on every machine.

With N unknowns, the least largest residual over many rows is that over N + 1 of them, a reference,
each of which takes it. Stiefel's exchange goes from reference to reference, each with a larger
residual, until no row exceeds it: the simplex method on the dual linear program.
"""

from mpmath import MPContext

mp = MPContext()
mp.dps = 40

STEPS = 500  # ten times what a fit of this project takes


def least_largest(rows, right):
    """Solution x of rows @ x = right, (M, N) with M > N, with the least largest residual; and that residual.

    Of the rows that the exchange starts from, any N are independent. ArithmeticError if it does not end.
    """
    count = len(rows[0])
    indices = [(len(rows) - 1) * k // count for k in range(count + 1)]
    signs = _signs([rows[i] for i in indices])
    for _ in range(STEPS):
        matrix = mp.matrix([_signed(rows[i], sign) for i, sign in zip(indices, signs, strict=True)])
        sides = mp.matrix([sign * right[i] for i, sign in zip(indices, signs, strict=True)])
        *x, level = mp.lu_solve(matrix, sides)
        residuals = [mp.fdot(row, x) - side for row, side in zip(rows, right, strict=True)]
        worst = max(range(len(rows)), key=lambda i: abs(residuals[i]))
        if abs(residuals[worst]) <= level * (1 + mp.sqrt(mp.eps)):
            return x, level
        sign = int(mp.sign(residuals[worst]))
        leaving = _leaving(matrix, _signed(rows[worst], sign))
        indices[leaving], signs[leaving] = worst, sign
    raise ArithmeticError(f"exchange must end within {STEPS} steps")


def _signed(row, sign):
    """Coefficients of sign (row @ x) - level, which is sign times the right side."""
    return [sign * each for each in row] + [-mp.one]


def _weights(matrix, total):
    """Weights of the rows of a reference whose weighted sum is `total`."""
    return list(mp.lu_solve(matrix.T, mp.matrix(total)))


def _signs(rows):
    """Signs with which the rows of a reference add up to zero under positive weights."""
    alternate = [(-1) ** k for k in range(len(rows))]
    matrix = mp.matrix([_signed(row, sign) for row, sign in zip(rows, alternate, strict=True)])
    weights = _weights(matrix, [0] * len(rows[0]) + [-1])
    return [sign * int(mp.sign(weight)) for sign, weight in zip(alternate, weights, strict=True)]


def _leaving(matrix, entering):
    """Row of a reference that another replaces with all weights staying positive."""
    weights = _weights(matrix, [0] * (len(entering) - 1) + [-1])
    change = _weights(matrix, entering)
    return min((w / d, k) for k, (w, d) in enumerate(zip(weights, change, strict=True)) if d > 0)[1]
