# SPDX-License-Identifier: Apache-2.0
"""What is wrong with a picture whatever the model: its encoding, orientation or scale.

Judged on Lambert under a distant light, whose true values are beyond dispute.
"""

import numpy as np

from mxeon.io.images import srgb_decoded
from mxeon.kit.noise import tiles

LIKENESS = 0.02  # error without noise over value, both rms, of an explanation
SAME_SCALE = 0.005  # a factor nearer to 1 is noise or a mesh


def _tone_mapped_back(image):
    """Infinite where x / (1 + x) cannot have come from."""
    return np.divide(image, 1.0 - image, out=np.full_like(image, np.inf), where=image < 1.0)


# In words, and what undoes it.
FAULTS = (
    ("", lambda image: image),
    ("sRGB-encoded", lambda image: srgb_decoded(np.clip(image, 0.0, None))),
    ("encoded with a power of 1/2.2", lambda image: np.clip(image, 0.0, None) ** 2.2),
    ("tone-mapped by x / (1 + x)", _tone_mapped_back),
    ("upside down", lambda image: image[::-1]),
    ("mirrored left to right", lambda image: image[:, ::-1]),
    ("turned by half a turn", lambda image: image[::-1, ::-1]),
)
FACTORS = ((np.pi, "pi"), (1.0 / np.pi, "1/pi"), (np.pi**2, "pi^2"), (2.0, "2"), (0.5, "1/2"))


def fault(image, model, mask):
    """What explains that a picture is not what it should be, in words.

    Parameters
    ----------
    image : ndarray, shape (size, size, 3)
    model : mxeon.kit.expected.Expected
        What the pixels of the mask should hold.
    mask : ndarray of bool, shape (size, size)

    Returns
    -------
    str
        "" if nothing known does and it is right within LIKENESS.
    """
    if not image[mask].any():
        return "black"
    likeness = {words: _likeness(undone(image)[mask], model, mask) for words, undone in FAULTS}
    words = min(likeness, key=lambda each: likeness[each][1])
    factor, miss = likeness[words]
    if miss <= LIKENESS:
        scale = "" if abs(factor - 1.0) <= SAME_SCALE else f"{_called(factor)} times as bright"
        return " and ".join(filter(None, (words, scale)))
    if _clipped(image[mask], model.value):
        return "clipped"
    return "not Lambert's cosine in any known encoding: tone-mapped, or lit otherwise"


def _likeness(found, model, mask):
    """The factor by which values are too large, and what remains then, beyond noise, relative.

    Where no factor above 0 explains anything, infinity remains.
    """
    value = model.value
    if not np.isfinite(found).all():
        return 0.0, np.inf
    factor = (found * value).sum() / (value * value).sum()
    if not factor > 0.0:
        return 0.0, np.inf
    error = found - factor * value
    noise = tiles(error, model.slack, mask).pixel_noise
    rest = np.sqrt(max(0.0, np.mean(error**2) - noise**2))
    return factor, rest / np.sqrt(np.mean((factor * value) ** 2))


def _called(factor):
    named = (words for known, words in FACTORS if abs(factor / known - 1.0) <= SAME_SCALE)
    return next(named, f"{factor:.3g}")


def _clipped(found, value):
    """Whether many pixels share one largest value while what they should hold differs."""
    top = found >= found.max() - 1e-6
    return top.sum() > 20 and np.ptp(value[top]) > 0.02
