# SPDX-License-Identifier: Apache-2.0
"""Measured BRDFs: pairs of directions with values, and files of the MERL database."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mxeon.errors import InputError
from mxeon.models.core.arrays import Array

# A file of MERL: cells of theta_h, theta_d and phi_d, and the scale of each channel: [Matusik2003].
MERL_CELLS = (90, 90, 180)
MERL_SCALES = (1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0)


@dataclass(frozen=True)
class MeasuredBrdf:
    """Measured values of a BRDF.

    - `wo`, `wi`: (N, 3). Directions to the viewer and to the light, unit vectors, normal +z.
    - `value`: (N, C). BRDF in 1/sr, without the cosine.
    - `error`: (N, C). Standard deviation of each value. Without it all values count alike, and
      their scatter about the fit tells the uncertainty.

    Raises InputError if the shapes do not belong together, or a number is not finite.
    """

    wo: Array
    wi: Array
    value: Array
    error: Array | None = None

    def __post_init__(self) -> None:
        for name in ("wo", "wi", "value", "error"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, np.asarray(getattr(self, name), np.float64))
        count = len(np.atleast_1d(self.wo))
        if self.wo.shape != (count, 3) or self.wi.shape != (count, 3) or not count:
            raise InputError(f"wo, wi must have shape (N, 3); got {self.wo.shape}, {self.wi.shape}")
        if self.value.ndim != 2 or len(self.value) != count or not np.isfinite(self.value).all():
            raise InputError(f"value must be finite, of shape ({count}, C); got {self.value.shape}")
        if self.error is not None and not (
            np.broadcast_shapes(self.error.shape, self.value.shape) == self.value.shape
            and (self.error > 0.0).all()
        ):
            raise InputError("error must be above 0, and have the shape of value")


def read_merl(path: str | Path, step: int = 6) -> MeasuredBrdf:
    """Values of a file of the MERL database, in red, green and blue.

    - `path`: Binary file: three integers, and 90 x 90 x 180 numbers for each channel.
    - `step`: Every how many cells of each of the three angles are taken, from half of it on; 1
      takes them all.

    They are at the centers of the cells, without those below the horizon or marked as unmeasured; the
    file tells no errors. Raises InputError if the file is none of that database.

    [Matusik2003]; [Rusinkiewicz1998] for the angles.
    """
    raw = Path(path).read_bytes()
    header, count = np.frombuffer(raw[:12], "<i4"), int(np.prod(MERL_CELLS))
    if tuple(header) != MERL_CELLS or len(raw) != 12 + 3 * 8 * count:
        raise InputError(f"{path}: must be a MERL file of 90 x 90 x 180 cells and 3 channels")
    values = np.frombuffer(raw[12:], "<f8").reshape(3, *MERL_CELLS)
    grid = np.meshgrid(*(np.arange(step // 2, n, step) for n in MERL_CELLS), indexing="ij")
    cells = [each.ravel() for each in grid]
    theta_h, theta_d, phi_d = ((each + 0.5) / n for each, n in zip(cells, MERL_CELLS, strict=True))
    wo, wi = merl_directions(0.5 * np.pi * theta_h**2, 0.5 * np.pi * theta_d, np.pi * phi_d)
    value = np.stack([each[tuple(cells)] for each in values], axis=-1) * MERL_SCALES
    kept = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0) & (value >= 0.0).all(axis=1)
    return MeasuredBrdf(wo[kept], wi[kept], value[kept])


def merl_directions(theta_h: Array, theta_d: Array, phi_d: Array) -> tuple[Array, Array]:
    """wo and wi of half and difference angles in radian, the half vector at azimuth 0.

    >>> wo, wi = merl_directions(*np.array([[0.0], [0.5 * np.pi / 3.0], [0.0]]))
    >>> wo.round(6), wi.round(6)
    (array([[-0.5     ,  0.      ,  0.866025]]), array([[0.5     , 0.      , 0.866025]]))
    """
    x, y = np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d)
    z, sine, cosine = np.cos(theta_d), np.sin(theta_h), np.cos(theta_h)
    wi = np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=-1)
    half = np.stack([sine, np.zeros_like(sine), cosine], axis=-1)
    wo = 2.0 * np.sum(wi * half, axis=-1, keepdims=True) * half - wi
    return wo, wi
