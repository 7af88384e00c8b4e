# SPDX-License-Identifier: Apache-2.0
"""Separate noise from bias by the mean error in each tile of a picture.

A tile of 8 x 8 pixels has up to 16 squares of 2 x 2. The contrast of a square, (a - b - c + d) / 2,
has the variance of a pixel's noise and cancels smooth errors, which the mean error of the tile
contains. If noise is normal, the mean is independent of the contrasts, so the quotient of mean and
estimated deviation follows Student's t.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import PackageError, install

TILE = 8
FEWEST = 8  # least number of squares in a judged tile
CONFIDENCE = 0.999  # probability that a kit of correct pictures passes


@dataclass(frozen=True)
class Tiles:
    mean: NDArray[np.float64]  # (T, 3), mean error of a tile
    deviation: NDArray[np.float64]  # (T, 3), estimated standard deviation of the mean
    slack: NDArray[np.float64]  # (T, 3), mean deviation of correct noise-free pixels
    squares: NDArray[np.int64]  # (T,), number of squares, the degrees of freedom

    @property
    def pixel_noise(self) -> float:
        """Standard deviation of a pixel's noise, as a root mean square over the picture."""
        return float(np.sqrt(np.mean(self.deviation**2 * 4.0 * self.squares[:, None])))


def tiles(error: NDArray[np.float64], slack: NDArray[np.float64], mask: NDArray[np.bool_]) -> Tiles:
    """Tiles of a picture, computed from errors and slack, (N, 3), at the pixels of a mask."""
    complete = np.asarray(_squares(mask[..., None]).all(axis=-1))  # squares inside the mask
    square, slack = (_squares(_on_picture(each, mask)) for each in (error, slack))
    contrast = (square @ [1.0, -1.0, -1.0, 1.0]) / 2.0
    count = _sum(complete)
    judged = count[:, 0] >= FEWEST
    # Errors, squared contrasts and slack are averaged over a tile. Smooth errors cancel in a
    # contrast, because the weights of the four pixels sum to 0.
    parts = square.mean(axis=-1), contrast**2, slack.mean(axis=-1)
    mean, variance, slack = (_sum(complete * each)[judged] / count[judged] for each in parts)
    deviation = np.sqrt(variance / (4.0 * count[judged]))
    return Tiles(mean, deviation, slack, count[judged, 0])


def ratio(pictures: Sequence[Tiles], share: float = 1.0) -> float:
    """The largest mean error of a tile, divided by the largest error that slack and noise explain.

    For correct pictures, the ratio exceeds 1 with a probability of at most share (1 - CONFIDENCE).
    Each of n mean errors gets 1 / n of this probability (Bonferroni's correction).
    """
    stdtrit = student_quantile()
    total = sum(each.mean.size for each in pictures)
    false_rate = share * (1.0 - CONFIDENCE) / total
    ratios = []
    for each in pictures:
        reach = -stdtrit(each.squares, false_rate / 2.0)[:, None] * each.deviation
        ratios.append(float(np.max(np.abs(each.mean) / (each.slack + reach))))
    return max(ratios)


def student_quantile() -> Callable[..., NDArray[np.float64]]:
    """The quantile function of Student's t, called as (degrees of freedom, probability)."""
    try:
        from scipy.special import stdtrit  # scipy.stats is slow to import
    except ModuleNotFoundError as error:
        raise PackageError(f"kit check needs scipy: {install('kit')}") from error
    return cast(Callable[..., NDArray[np.float64]], stdtrit)


def _on_picture(values: NDArray[np.float64], mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    image = np.zeros((*mask.shape, values.shape[-1]))
    image[mask] = values
    return image


def _squares(image: NDArray[Any]) -> NDArray[Any]:
    """Split an image into tiles, and tiles into 2 x 2 squares, (tiles, tiles, 16, channels, 4)."""
    size, half = image.shape[0] // TILE, TILE // 2
    parts = image[: size * TILE, : size * TILE].reshape(size, half, 2, size, half, 2, -1)
    parts = parts.transpose(0, 3, 1, 4, 6, 2, 5)
    return parts.reshape(size, size, half * half, image.shape[-1], 4)


def _sum(values: NDArray[Any]) -> NDArray[Any]:
    """Sum over the squares of each tile, (tiles, channels)."""
    return np.asarray(values.sum(axis=2).reshape(-1, values.shape[-1]))
