# SPDX-License-Identifier: Apache-2.0
"""EON compiled by Numba, to time the package against; needs the extra `numba`, and is not shipped.

Values and errors are those of `mxeon.models`. The formulas of `mxeon.models.diffuse.formulas` stand here once
more, written so that the compiler makes vector instructions of them: no calls and no branches.
"""

import math

import numba
import numpy as np

from mxeon.models.core.arguments import UNIT_TOLERANCE, checked, checked_directions
from mxeon.models.diffuse.formulas import C1, C2

TINY = np.finfo(np.float64).tiny
# Products and sums may become one rounding; NaN and infinity keep their meaning.
OPTIONS = {"error_model": "numpy", "fastmath": {"contract", "nsz"}}
FAST = numba.njit(cache=True, **OPTIONS)
PAIRS = 2048  # of one block, whose terms stay in a first-level cache

# Our fit, tools/fits/arc_tangent.py: atan(t) / t in powers of t^2, t in [0, 1], in rows of four. Largest
# relative error: 9.9e-17.
ATAN = (
    (1.0, -0.333333333333307, 0.1999999999964796, -0.14285714266926733),
    (0.11111110578002083, -0.090908997932173413, 0.076921989974582938, -0.066657649106897227),
    (0.058768281144872724, -0.052374234719188166, 0.046687453048485289, -0.040811247503178855),
    (0.033871267027006748, -0.025568623644371739, 0.01671959606350739, -0.0089910805426582606),
    (0.0037511384839651412, -0.0011252544302234645, 0.00021423810738603946, -1.93423475928923e-05),
)


def eon_brdf(wo, wi, rho, roughness):
    """BRDF of EON, on as many threads as `numba.get_num_threads()`.

    Parameters
    ----------
    wo, wi : array_like, shape (..., 3)
        Directions that leave the surface, unit vectors to 1e-6, normal +z, z >= 0.
    rho : array_like, shape (..., C)
        Reflectance per channel, dimensionless, in [0, 1]; a number is one channel.
    roughness : array_like, shape (...)
        Dimensionless, in [0, 1].

    Returns
    -------
    ndarray, shape (..., C), float64
        BRDF in 1/sr.

    Raises
    ------
    ValueError
        If an argument leaves its range or the shapes do not broadcast; names the first bad element.

    Notes
    -----
    Accuracy: that of `mxeon.models.eon_brdf`.

    References
    ----------
    [Portsmouth2025], Eqs. (16), (19).
    """
    rho, roughness = np.atleast_1d(checked("rho", rho)), checked("roughness", roughness)
    arrays = [np.asarray(wo), np.asarray(wi), rho, roughness[..., np.newaxis]]
    if arrays[0].shape[-1:] != (3,) or arrays[1].shape[-1:] != (3,):
        checked_directions("wo", wo)
        checked_directions("wi", wi)
    shape = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    uniform = rho.size == rho.shape[-1] and roughness.size == 1
    rows = [_row(array, shape, uniform and k > 1) for k, array in enumerate(arrays)]
    out = np.empty(shape + rho.shape[-1:])
    if not _fill(*rows, rho.shape[-1], out.reshape(-1)):
        checked_directions("wo", wo)
        checked_directions("wi", wi)
    return out


def _row(array, shape, uniform):
    """`array` broadcast to (*shape, last), and flat; values of a material for all pairs once."""
    shape = (1,) * len(shape) if uniform else shape
    array = np.broadcast_to(np.asarray(array, dtype=np.float64), shape + array.shape[-1:])
    return np.ascontiguousarray(array).reshape(-1)


@FAST
def _four(z, c):
    """Four terms of the arc tangent; together, for fewer steps that wait for one another."""
    return (c[0] + z * c[1]) + z * z * (c[2] + z * c[3])


@FAST
def _fon_loss(mu):
    """`mxeon.models.diffuse.formulas.fon_loss`, with a polynomial for the arc tangent."""
    S = math.sqrt((1.0 - mu) * (1.0 + mu))
    t = mu / (1.0 + S)
    z = t * t
    z4 = (z * z) * (z * z)
    arc = _four(z, ATAN[2]) + z4 * (_four(z, ATAN[3]) + z4 * _four(z, ATAN[4]))
    arc = _four(z, ATAN[0]) + z4 * (_four(z, ATAN[1]) + z4 * arc)
    single = C1 - S * t * (2.0 + S) * (1.0 / (3.0 * math.pi))
    return mu * t * single + (2.0 / math.pi) * S * (t * arc)


@FAST
def _are_directions(w):
    """Whether all are unit vectors on or above the horizon."""
    bad = 0
    for k in range(w.size // 3):
        x, y, z = w[3 * k], w[3 * k + 1], w[3 * k + 2]
        good = (abs(x * x + y * y + z * z - 1.0) <= UNIT_TOLERANCE) & (z >= 0.0)
        bad += 1 - good
    return bad == 0


@FAST
def _terms(wo, wi, quotient, lost):
    """s / t_F and H(mu_o) H(mu_i) of a block."""
    for k in range(quotient.size):
        mu_o, mu_i = wo[3 * k + 2], wi[3 * k + 2]
        mu_o = mu_o if mu_o < 1.0 else 1.0
        mu_i = mu_i if mu_i < 1.0 else 1.0
        s = wo[3 * k] * wi[3 * k] + wo[3 * k + 1] * wi[3 * k + 1]
        high = mu_o if mu_o > mu_i else mu_i
        ahead = s if s > 0.0 else 0.0
        ratio = ahead / (high if high > TINY else TINY)
        quotient[k] = (ratio if high >= TINY else 0.0) + (s - ahead)
        lost[k] = _fon_loss(mu_o) * _fon_loss(mu_i)


@FAST
def _value(quotient, lost, rho, r):
    """`mxeon.models.diffuse.formulas.eon_brdf` of one channel."""
    d = 1.0 + C1 * r
    multiple = lost * (r * (1.0 + C2 * r) / (C1 - C2))
    lobe = rho * multiple / (d - rho * (r * (C1 - C2)))
    return rho * (1.0 / (math.pi * d)) * (1.0 + r * quotient + lobe)


@FAST
def _values(quotient, lost, rho, roughness, channels, out):
    """Values of a block from its terms, with a material for each pair."""
    for k in range(quotient.size):
        for c in range(channels):
            at = channels * k + c
            out[at] = _value(quotient[k], lost[k], rho[at], roughness[k])


@FAST
def _colors(quotient, lost, rho, roughness, out):
    """`_values` of three channels, whose number the compiler knows."""
    for k in range(quotient.size):
        q, h, r = quotient[k], lost[k], roughness[k]
        out[3 * k] = _value(q, h, rho[3 * k], r)
        out[3 * k + 1] = _value(q, h, rho[3 * k + 1], r)
        out[3 * k + 2] = _value(q, h, rho[3 * k + 2], r)


@FAST
def _one_material(quotient, lost, rho, r, out):
    """Values of a block from its terms, with one material for all pairs."""
    for c, tint in enumerate(rho):
        d = 1.0 + C1 * r
        single = tint / (math.pi * d)
        multiple = tint * (r * (1.0 + C2 * r) / (C1 - C2)) / (d - tint * (r * (C1 - C2)))
        for k in range(quotient.size):
            out[len(rho) * k + c] = single * (1.0 + r * quotient[k] + multiple * lost[k])


@numba.njit(parallel=True, cache=True, **OPTIONS)
def _fill(wo, wi, rho, roughness, channels, out):
    """Values into `out`, block by block; whether all directions were valid."""
    bad, pairs = 0, len(wo) // 3
    for block in numba.prange((pairs + PAIRS - 1) // PAIRS):
        low, high = block * PAIRS, min(block * PAIRS + PAIRS, pairs)
        near, far = wo[3 * low : 3 * high], wi[3 * low : 3 * high]
        bad += not (_are_directions(near) and _are_directions(far))
        quotient, lost = np.empty(high - low), np.empty(high - low)
        _terms(near, far, quotient, lost)
        part = out[channels * low : channels * high]
        if len(roughness) == 1:
            _one_material(quotient, lost, rho, roughness[0], part)
            continue
        tints, r = rho[channels * low : channels * high], roughness[low:high]
        if channels == 3:
            _colors(quotient, lost, tints, r, part)
        else:
            _values(quotient, lost, tints, r, channels, part)
    return bad == 0
