# SPDX-License-Identifier: Apache-2.0
"""What a run shows beside its verdicts: pictures, and albedos over the angle."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mxeon.io.images import difference

NOT_PLAIN = re.compile("[^A-Za-z0-9]+")


@dataclass(frozen=True)
class Picture:
    """One host's picture of one element, and the reference's where the models can express it.

    Attributes
    ----------
    document, element, host, library, scene : str
        The material, the host that rendered it, and the light.
    image : ndarray, shape (size, size, 3), float32
        Linear radiance; see `mxeon.shaders.scene` for its scale.
    reference : ndarray or None
        The same from the NumPy models; None where the material has other lobes.
    metadata : dict of str to str
        Its origin: version, host, device, library, document, element, scene.
    judged : ndarray or None, shape (size, size, 1), float32
        1 in the pixels that were compared with the reference, else 0; None where all were.
    """

    document: str
    element: str
    host: str
    library: str
    scene: str
    image: NDArray[np.floating]
    reference: NDArray[np.floating] | None
    metadata: dict[str, str]
    judged: NDArray[np.floating] | None = None

    def difference(self) -> NDArray[np.float64]:
        """Difference from the reference, (size, size): infinite where a value is not finite.

        Pixels between those of a judged lattice take the difference of the nearest one; other
        pixels that were not judged are NaN.
        """
        if self.reference is None:
            raise ValueError(f"{self.element}: a difference needs a reference; there is none")
        apart = difference(self.image, self.reference)
        apart = np.where(np.isfinite(apart), apart, np.inf)
        if self.judged is None:
            return apart
        judged = np.asarray(self.judged)[..., 0] > 0.0
        nearest = []
        for axis in (1, 0):
            lines = np.flatnonzero(judged.any(axis))
            gaps = np.abs(np.subtract.outer(np.arange(len(judged)), lines))
            nearest.append(lines[gaps.argmin(axis=1)])
        return np.where(judged, apart, np.nan)[np.ix_(*nearest)]


def image_names(pictures: Sequence[Picture]) -> tuple[str, ...]:
    """File names for pictures, without suffix: ASCII, and different whatever the case."""
    names, uses = [], Counter[str]()
    for picture in pictures:
        document = Path(picture.document).stem
        words = (document, picture.element, picture.host, picture.library, picture.scene)
        name = "-".join(NOT_PLAIN.sub("_", word)[:40] for word in words)
        uses[name.lower()] += 1
        # A counter is a sixth word, which no other name has.
        names.append(name if uses[name.lower()] == 1 else f"{name}-{uses[name.lower()]}")
    return tuple(names)


@dataclass(frozen=True)
class AlbedoCurve:
    """Directional albedo over the cosine `mu`, (N, 3), measured on a host beside its closed form."""

    subject: str
    host: str
    library: str
    rho: tuple[float, float, float]
    roughness: float
    mu: NDArray[np.float64]
    measured: NDArray[np.float64]
    expected: NDArray[np.float64]
