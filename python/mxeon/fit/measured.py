# SPDX-License-Identifier: Apache-2.0
"""Measured BRDFs: direction pairs with values, and files of the MERL database."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mxeon.errors import InputError
from mxeon.io.files import AnyPath, one_name
from mxeon.models.core.arrays import Array, Numbers

# Format of MERL files: cells along theta_h, theta_d and phi_d; scale per channel. [Matusik2003].
MERL_CELLS = (90, 90, 180)
MERL_SCALES = (1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0)


@dataclass(eq=False)
class MeasuredBrdf:
    """Measured values of a BRDF.

    - `wo`, `wi`: (N, 3). Directions to the viewer and to the light, unit vectors, normal +z.
    - `value`: (N, C). BRDF in 1/sr, without the cosine.
    - `error`: (N, C), or a shape that broadcasts to it. Standard deviation of each value. If None,
      all values have the same weight, and their scatter about the fit gives the uncertainty.

    Raises InputError if the shapes do not match, a value is not finite or an error is not positive.
    """

    wo: Array
    wi: Array
    value: Array
    error: Array | None = None

    def __post_init__(self) -> None:
        self.wo, self.wi, self.value = (
            np.asarray(each, np.float64) for each in (self.wo, self.wi, self.value)
        )
        if self.error is not None:
            self.error = np.asarray(self.error, np.float64)
        count = len(np.atleast_1d(self.wo))
        if self.wo.shape != (count, 3) or self.wi.shape != (count, 3) or not count:
            raise InputError(f"wo, wi must have shape (N, 3); got {self.wo.shape}, {self.wi.shape}")
        shape = self.value.shape
        if len(shape) != 2 or shape[0] != count or not shape[1]:
            raise InputError(f"value must have shape ({count}, C); got {shape}")
        _require("value must be finite", self.value, np.isfinite(self.value))
        if self.error is not None:
            try:
                np.broadcast_to(self.error, shape)
            except ValueError:
                rule = f"error must broadcast to the shape of value, {shape}"
                raise InputError(f"{rule}; got {self.error.shape}") from None
            _require("error must be above 0", self.error, self.error > 0.0)


def _require(rule: str, array: Numbers, valid: Numbers) -> None:
    """Raise InputError with the first invalid number and its index."""
    if not valid.all():
        index = tuple(np.argwhere(~valid)[0].tolist())
        place = f" at index {index}" if index else ""
        raise InputError(f"{rule}; got {array[index]}{place}")


def read_merl(path: AnyPath, step: int = 6) -> MeasuredBrdf:
    """Measured values from a file of the MERL database: red, green and blue.

    - `path`: Binary file: three integers, then 90 x 90 x 180 numbers for each channel.
    - `step`: Stride over the cells of each angle; the first cell taken is `step // 2`. With 1, all
      cells are taken.

    Directions are those of the cell centers. Cells below the horizon and cells marked as unmeasured
    are skipped. MERL files have no errors. Raises InputError if the file has another format.

    [Matusik2003]; [Rusinkiewicz1998] defines the angles.
    """
    path = one_name("path", path)
    raw = Path(path).read_bytes()
    start, size = np.array(MERL_CELLS, "<i4").tobytes(), 12 + 3 * 8 * int(np.prod(MERL_CELLS))
    if len(raw) != size or raw[:12] != start:
        raise InputError(
            f"{path}: must be a MERL file of 90 x 90 x 180 cells and 3 channels, {size} bytes that "
            f"start with {start.hex(' ', 4)}; got {len(raw)} that start with {raw[:12].hex(' ', 4)}"
        )
    values = np.frombuffer(raw[12:], "<f8").reshape(3, *MERL_CELLS)
    grid = np.meshgrid(*(np.arange(step // 2, n, step) for n in MERL_CELLS), indexing="ij")
    cells = [each.ravel() for each in grid]
    theta_h, theta_d, phi_d = ((each + 0.5) / n for each, n in zip(cells, MERL_CELLS, strict=True))
    wo, wi = merl_directions(0.5 * np.pi * theta_h**2, 0.5 * np.pi * theta_d, np.pi * phi_d)
    value = np.stack([each[tuple(cells)] for each in values], axis=-1) * MERL_SCALES
    kept = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0) & (value >= 0.0).all(axis=1)
    return MeasuredBrdf(wo[kept], wi[kept], value[kept])


def merl_directions(theta_h: Array, theta_d: Array, phi_d: Array) -> tuple[Array, Array]:
    """Directions wo, wi from half and difference angles in radian; the half vector has azimuth 0.

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
