# SPDX-License-Identifier: Apache-2.0
"""Faults of a picture that do not depend on the model: encoding, orientation and scale.

They are determined on Lambert under a distant light, whose values every model shares.
"""

import numpy as np
from numpy.typing import NDArray

from mxeon.io.srgb import srgb_decoded
from mxeon.kit.expected import Expected
from mxeon.kit.noise import tiles

LIKENESS = 0.02  # largest rms error over rms value, without noise, at which a fault explains it
SAME_SCALE = 0.005  # a factor nearer to 1 is noise or the depth of a mesh


def _tone_mapped_back(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """The inverse of x / (1 + x); infinity for values of 1 and more, which it has not."""
    return np.divide(image, 1.0 - image, out=np.full_like(image, np.inf), where=image < 1.0)


# Each fault in words, and the function that undoes it.
FAULTS = (
    ("", lambda image: image),
    ("sRGB-encoded", lambda image: srgb_decoded(np.clip(image, 0.0, None))),
    ("encoded with a power of 1/2.2", lambda image: np.clip(image, 0.0, None) ** 2.2),
    ("tone-mapped by x / (1 + x)", _tone_mapped_back),
    ("upside down", lambda image: image[::-1]),
    ("mirrored left to right", lambda image: image[:, ::-1]),
    ("rotated by 180 degrees", lambda image: image[::-1, ::-1]),
)
FACTORS = ((np.pi, "pi"), (1.0 / np.pi, "1/pi"), (np.pi**2, "pi^2"), (2.0, "2"), (0.5, "1/2"))


def fault(image: NDArray[np.float64], model: Expected, mask: NDArray[np.bool_]) -> str:
    """The fault that explains how a picture differs from the model, in words; "" within LIKENESS."""
    if not image[mask].any():
        return "black"
    likeness = {words: _likeness(undo(image)[mask], model, mask) for words, undo in FAULTS}
    words = min(likeness, key=lambda each: likeness[each][1])
    factor, miss = likeness[words]
    if miss <= LIKENESS:
        known = (name for each, name in FACTORS if abs(factor / each - 1.0) <= SAME_SCALE)
        times = next(known, f"{factor:.3g}")
        scale = "" if abs(factor - 1.0) <= SAME_SCALE else f"{times} times as bright"
        return " and ".join(filter(None, (words, scale)))
    # Many pixels share one largest value although their expected values differ.
    top = image[mask] >= image[mask].max() - 1e-6
    if top.sum() > 20 and np.ptp(model.value[top]) > 0.02:
        return "clipped"
    return "not Lambert's cosine in any known encoding: tone-mapped, or lit otherwise"


def _likeness(
    values: NDArray[np.float64], model: Expected, mask: NDArray[np.bool_]
) -> tuple[float, float]:
    """Best factor between values and model, and the error beyond noise; infinite if it is not positive."""
    value = model.value
    if not np.isfinite(values).all():
        return 0.0, np.inf
    factor = (values * value).sum() / (value * value).sum()
    if not factor > 0.0:
        return 0.0, np.inf
    error = values - factor * value
    noise = tiles(error, model.slack, mask).pixel_noise
    rest = np.sqrt(max(0.0, np.mean(error**2) - noise**2))
    return factor, rest / np.sqrt(np.mean((factor * value) ** 2))
