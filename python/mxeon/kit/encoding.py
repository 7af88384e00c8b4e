# SPDX-License-Identifier: Apache-2.0
"""Faults of a picture that do not depend on the model: encoding, orientation and scale.

Faults are found on Lambert under a distant light, for which all models have equal values.
"""

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.results import Cause, Diagnosis, Kind
from mxeon.io.srgb import srgb_decoded
from mxeon.kit.expected import Expected
from mxeon.kit.noise import tiles

MISFIT = 0.02  # largest rms error without noise over rms value that leaves a fault as explanation
SAME_SCALE = 0.005  # factors closer to 1 are due to noise or a mesh


def _without_tone_mapping(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """The inverse of x / (1 + x), whose values are below 1; infinity for other values."""
    return np.divide(image, 1.0 - image, out=np.full_like(image, np.inf), where=image < 1.0)


# Keys of faults in `mxeon.conformance.words.DEFECTS`, and the functions that undo them.
FAULTS = (
    ("scaled", lambda image: image),
    ("srgb", lambda image: srgb_decoded(np.clip(image, 0.0, None))),
    ("power", lambda image: np.clip(image, 0.0, None) ** 2.2),
    ("tone_mapped", _without_tone_mapping),
    ("upside_down", lambda image: image[::-1]),
    ("mirrored", lambda image: image[:, ::-1]),
    ("rotated", lambda image: image[::-1, ::-1]),
)


def fault(
    name: str, image: NDArray[np.float64], model: Expected, mask: NDArray[np.bool_]
) -> Diagnosis:
    """Find the fault that turns the model into the picture `name`, or a known symptom."""

    def found(key: str, *factors: float) -> Diagnosis:
        return Diagnosis((Cause(Kind.DEFECT, f"picture_{key}", (name,), factors),))

    if not image[mask].any():
        return found("black")
    fits = {key: _fit(undo(image)[mask], model, mask) for key, undo in FAULTS}
    key = min(fits, key=lambda each: fits[each][1])
    factor, misfit = fits[key]
    if misfit <= MISFIT:
        if abs(factor - 1.0) > SAME_SCALE:
            return found(key, factor)
        return Diagnosis() if key == "scaled" else found(key)
    # A picture is clipped if many pixels share the largest value, but their expected values differ.
    top = image[mask] >= image[mask].max() - 1e-6
    clipped = top.sum() > 20 and np.ptp(model.value[top]) > 0.02
    return found("clipped" if clipped else "unknown")


def _fit(
    values: NDArray[np.float64], model: Expected, mask: NDArray[np.bool_]
) -> tuple[float, float]:
    """Best factor between values and model, and the error beyond noise; infinite without a fit."""
    if not np.isfinite(values).all() or (values * model.value).sum() <= 0.0:
        return 0.0, np.inf
    factor = (values * model.value).sum() / (model.value**2).sum()
    fitted = factor * model.value
    error = values - fitted
    noise = tiles(error, model.slack, mask).pixel_noise
    misfit = np.sqrt(max(0.0, np.mean(error**2) - noise**2))
    return factor, misfit / np.sqrt(np.mean(fitted**2))
