# SPDX-License-Identifier: Apache-2.0
"""EON compiled by Numba, for very many pairs; needs the extra `numba`.

Values and errors are those of `mxeon.models`. The formulas of `mxeon.formulas` stand here once
more, written so that the compiler makes vector instructions of them: no calls and no branches.
"""

import math

import numba
import numpy as np

from mxeon.formulas import C1, C2
from mxeon.geometry import UNIT_TOLERANCE, checked, checked_directions

TINY = np.finfo(np.float64).tiny
# Products and sums may become one rounding; NaN and infinity keep their meaning.
OPTIONS = {"error_model": "numpy", "fastmath": {"contract", "nsz"}}
FAST = numba.njit(cache=True, **OPTIONS)
PAIRS = 2048  # of one block, whose terms stay in a first-level cache


def eon_brdf(wo, wi, rho, roughness):
    """Reflection of EON, on as many threads as `numba.get_num_threads()`.

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
    given = [np.asarray(wo), np.asarray(wi), rho, roughness[..., np.newaxis]]
    if given[0].shape[-1:] != (3,) or given[1].shape[-1:] != (3,):
        checked_directions("wo", wo)
        checked_directions("wi", wi)
    shape = np.broadcast_shapes(*(each.shape[:-1] for each in given))
    wo_rows, wi_rows = (_rows(each, shape, False) for each in given[:2])
    single = rho.size == rho.shape[-1] and roughness.size == 1
    rho_rows, roughness_rows = (_rows(each, shape, single) for each in given[2:])
    out = np.empty((math.prod(shape), rho.shape[-1]))
    if not _fill(wo_rows.ravel(), wi_rows.ravel(), rho_rows, roughness_rows[:, 0], out):
        checked_directions("wo", wo)
        checked_directions("wi", wi)
    return out.reshape(shape + rho.shape[-1:])


def _rows(array, shape, single):
    """`array` broadcast to (N, last) and contiguous; of a single material one row."""
    shape = (1,) * len(shape) if single else shape
    array = np.broadcast_to(np.asarray(array, dtype=np.float64), shape + array.shape[-1:])
    return np.ascontiguousarray(array).reshape(-1, array.shape[-1])


@FAST
def _four(x2, k):
    """Four terms of atan(x) / x = 1 - x^2 / 3 + x^4 / 5 - ..., from the 4 k-th on, over x^(8 k)."""
    low, high = 1.0 / (8.0 * k + 1.0), 1.0 / (8.0 * k + 5.0)
    return low - x2 * (1.0 / (8.0 * k + 3.0) - x2 * (high - x2 / (8.0 * k + 7.0)))


@FAST
def _loss(mu):
    """`mxeon.formulas.loss` with atan(t) = 2 atan(x), x = t / (1 + sqrt(1 + t^2)).

    As x <= tan(pi / 8), twenty terms of the series leave 1.2e-17 of it.
    """
    S = math.sqrt((1.0 - mu) * (1.0 + mu))
    t = mu / (1.0 + S)
    x = t / (1.0 + math.sqrt(1.0 + t * t))
    x2 = x * x
    x8 = (x2 * x2) * (x2 * x2)
    arc = _four(x2, 2.0) + x8 * (_four(x2, 3.0) + x8 * _four(x2, 4.0))
    arc = _four(x2, 0.0) + x8 * (_four(x2, 1.0) + x8 * arc)
    single = C1 - S * t * (2.0 + S) * (1.0 / (3.0 * math.pi))
    return mu * t * single + (4.0 / math.pi) * S * (x * arc)


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
        share = ahead / (high if high > TINY else TINY)
        quotient[k] = (share if high >= TINY else 0.0) + (s - ahead)
        lost[k] = _loss(mu_o) * _loss(mu_i)


@FAST
def _values(quotient, lost, rho, roughness, out):
    """Values of a block from its terms; materials as many as pairs, or one."""
    if len(rho) == 1:
        r = roughness[0]
        d = 1.0 + C1 * r
        for c in range(out.shape[1]):
            tint = rho[0, c]
            scale = tint / (math.pi * d)
            weight = tint * (r * (1.0 + C2 * r) / (C1 - C2)) / (d - tint * (r * (C1 - C2)))
            for k in range(quotient.size):
                out[k, c] = scale * (1.0 + r * quotient[k] + weight * lost[k])
        return
    for k in range(quotient.size):
        r = roughness[k]
        d = 1.0 + C1 * r
        single, multiple = 1.0 + r * quotient[k], lost[k] * (r * (1.0 + C2 * r) / (C1 - C2))
        scale = 1.0 / (math.pi * d)
        for c in range(out.shape[1]):
            lobe = rho[k, c] * multiple / (d - rho[k, c] * (r * (C1 - C2)))
            out[k, c] = rho[k, c] * scale * (single + lobe)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def _fill(wo, wi, rho, roughness, out):
    """Values into `out`, block by block; whether all directions were valid."""
    bad = 0
    for block in numba.prange((len(out) + PAIRS - 1) // PAIRS):
        low, high = block * PAIRS, min(block * PAIRS + PAIRS, len(out))
        near, far = wo[3 * low : 3 * high], wi[3 * low : 3 * high]
        bad += not (_are_directions(near) and _are_directions(far))
        quotient, lost = np.empty(high - low), np.empty(high - low)
        _terms(near, far, quotient, lost)
        first, last = (0, 1) if len(roughness) == 1 else (low, high)
        _values(quotient, lost, rho[first:last], roughness[first:last], out[low:high])
    return bad == 0
