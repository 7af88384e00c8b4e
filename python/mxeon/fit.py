# SPDX-License-Identifier: Apache-2.0
"""Fits of models to measured BRDFs, with the uncertainty of each parameter.

A measured BRDF is an array of direction pairs with values, or a file of the MERL database. The fits
need scipy.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from mxeon.errors import InputError, PackageError, assert_known, install
from mxeon.io.files import AnyPath, one_name
from mxeon.models import dielectric_over_eon_brdf, eon_brdf, varnished_brdf
from mxeon.models.core.arrays import Array, ArrayLike, Numbers

__all__ = ["Fit", "MeasuredBrdf", "fit_brdf", "merl_directions", "read_merl"]

# Cells of MERL files along theta_h, theta_d and phi_d, and the scale of each channel [Matusik2003].
MERL_CELLS = (90, 90, 180)
MERL_SCALES = (1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0)


@dataclass(eq=False)
class MeasuredBrdf:
    """Measured values of a BRDF.

    - `wo`, `wi`: (N, 3). Unit vectors to the viewer and to the light, with the normal +z.
    - `value`: (N, C). BRDF in 1/sr, without the cosine.
    - `error`: Standard deviation of each value, in a shape that broadcasts to (N, C). If None, all
      values have the same weight, and the scatter of the values about the fit determines the
      uncertainty.

    Raises InputError if the shapes do not match, if a value is not finite, or if an error is not
    positive.
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
    """Raise InputError with the first invalid number and the number's position."""
    if not valid.all():
        index = tuple(np.argwhere(~valid)[0].tolist())
        place = f" at index {index}" if index else ""
        raise InputError(f"{rule}; got {array[index]}{place}")


def read_merl(path: AnyPath, step: int = 6) -> MeasuredBrdf:
    """Measured values for red, green and blue from a file of the MERL database.

    - `path`: Binary file of three integers, followed by 90 x 90 x 180 numbers for each channel.
    - `step`: Stride over the cells of each angle. The first cell is `step // 2`. A step of 1 uses
      all cells.

    Directions belong to the centers of the cells. Cells below the horizon and cells marked as
    unmeasured are skipped. MERL files have no errors. Raises InputError if the file has another
    format.

    [Matusik2003] describes the files, and [Rusinkiewicz1998] defines the angles.
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
    valid = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0) & (value >= 0.0).all(axis=1)
    return MeasuredBrdf(wo[valid], wi[valid], value[valid])


def merl_directions(theta_h: Array, theta_d: Array, phi_d: Array) -> tuple[Array, Array]:
    """Directions wo, wi from half and difference angles in radians, for a half vector of azimuth 0.

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


LEAST_ALPHA = 0.02  # measurements cannot resolve narrower lobes


@dataclass(frozen=True)
class FitModel:
    """A model to fit: `value(wo, wi, color, *scalars)`, (N, C), with inputs as in `mxeon.model`."""

    value: Callable[..., Array]
    scalars: Mapping[str, tuple[float, ...]]  # minimum, maximum, and starting values of the search

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        return {name: (low, high) for name, (low, high, *_) in self.scalars.items()}


COAT = dict(roughness=(0.0, 1.0, 0.5), alpha=(LEAST_ALPHA, 1.0, 0.1, 0.4), ior=(1.0, 4.0, 1.5))
FIT_MODELS = {
    "eon": FitModel(eon_brdf, {"roughness": (0.0, 1.0, 0.2, 0.8)}),
    "dielectric_over_eon": FitModel(dielectric_over_eon_brdf, COAT),
    "varnished": FitModel(varnished_brdf, COAT),
}


MISFIT = 1.5  # a larger scatter means that the model does not fit data with known errors
LEAST_SINGULAR = 1e-12  # smallest usable singular value, relative to the largest
ROUNDED = 1e-24  # largest squared component of a unit vector that is due to rounding
UNDETERMINED = "not determined by the data"  # printed if an error spans the parameter's range


@dataclass(frozen=True)
class Fit:
    """Best-fit parameters of a model for a measured BRDF, with standard deviations.

    - `values`, `errors`: The fitted color (C,) and other parameters, and the standard deviations of
      these values, by input name. The functions of `mxeon.model(fit.model)` accept `**fit.values`.
    - `covariance`: (P, P), in the order of `values`, with one row per channel of the color. Rows
      and columns of parameters that the data do not determine are infinite.
    - `scatter`: Square root of the sum of squared residuals divided by the number of degrees of
      freedom. If the data have errors, residuals are divided by the errors, and the right model has
      a scatter of about 1. Otherwise, the scatter is in 1/sr.
    - `weighted`: Whether the data had errors.

    If the data have errors, `errors` are propagated from the errors of the data, assuming that the
    model is right. A scatter of 10 means that the model is wrong, so that parameters are off by
    more than `errors`. If the data have no errors, the scatter is the error of each value, which
    may be noise or misfit.
    """

    model: str
    values: dict[str, Array]
    errors: dict[str, Array]
    covariance: Array
    scatter: float
    weighted: bool = True

    @property
    def fits(self) -> bool:
        """True if the scatter is at most 1.5, or if the data have no errors."""
        return not self.weighted or self.scatter <= MISFIT

    def brdf(self, wo: ArrayLike, wi: ArrayLike) -> Array:
        """The fitted model's BRDF in 1/sr, (..., C), for directions (..., 3) that broadcast."""
        pairs = np.broadcast_arrays(*(np.asarray(w, np.float64) for w in (wo, wi)))
        rows = (each.reshape(-1, 3) for each in pairs)
        value = FIT_MODELS[self.model].value(*rows, *self.values.values())
        return value.reshape(*pairs[0].shape[:-1], -1)

    def __str__(self) -> str:
        misfit = "" if self.fits else ": the model does not fit; its errors assume that it does"
        rows = [f"{self.model}, scatter {self.scatter:.3g}{misfit}"]
        width = max(map(len, self.values))
        for name, value in self.values.items():
            low, high = FIT_MODELS[self.model].bounds.get(name, (0.0, 1.0))
            pairs = zip(np.atleast_1d(value), np.atleast_1d(self.errors[name]), strict=True)
            texts = (f"{v:.4f} +- {e:.4f}" if e < high - low else UNDETERMINED for v, e in pairs)
            rows.append(f"  {name:{width}} " + ", ".join(texts))
        return "\n".join(rows)


def fit_brdf(measurement: MeasuredBrdf, model: str = "eon") -> Fit:
    """Best-fit parameters of a model for a measured BRDF, by least squares.

    - `model`: The model "eon" has `color` and `roughness`. The model "varnished" is EON below a
      rough dielectric interface, and adds `alpha` and `ior`. The model "dielectric_over_eon" is
      MaterialX's `layer`, and has the same parameters as "varnished". The fitted `color` of
      "dielectric_over_eon" is smaller than the color of the pigment.

    The search begins at several starting points, and the best fit is returned. Raises InputError if
    the model is unknown, and PackageError if scipy (part of the `fit` extra) is not installed.

    Errors that are derived from the measured values, such as 2 % of each value, bias the fit,
    because values lowered by noise get more weight. The fitted color is too small by about twice
    the square of the relative error, which can be one standard deviation. The remedy is to fit
    twice, and to use the same fraction of the first fit's `brdf` as errors of the second fit.

    The standard deviations are sqrt(diag((J^T J)^-1)), where J is the derivative of the residuals.
    The residuals are divided by the errors of the data. If the data have no errors, the standard
    deviations are multiplied by the scatter, which requires more values than parameters.
    Parameters that the data do not determine have infinite or very large errors and are printed
    without a number. Examples are the roughness of a black surface, and four parameters that are
    fitted to three values. If a parameter is at an end of its range, the error applies to the
    interior side.

        >>> from mxeon.models import eon_brdf
        >>> wo, wi = np.tile([0.6, 0.0, 0.8], (2, 1)), np.array([[0.0, 0.0, 1.0], [0.8, 0.0, 0.6]])
        >>> value = eon_brdf(wo, wi, [0.5], 0.25)
        >>> fitted = fit_brdf(MeasuredBrdf(wo, wi, value, 0.01 * value))
        >>> fitted.values["roughness"].round(6), fitted.errors["roughness"].round(4)
        (np.float64(0.25), np.float64(0.0313))
        >>> fit_brdf(MeasuredBrdf(wo, wi, value)).errors["roughness"]  # no third value tells a scatter
        np.float64(inf)
    """
    assert_known("model", model, FIT_MODELS)
    try:
        from scipy.optimize import least_squares
    except ImportError as error:
        raise PackageError(f"mxeon.fit needs scipy: {install('fit')}") from error
    row, data = FIT_MODELS[model], measurement
    channels, scale = data.value.shape[1], 1.0 if data.error is None else data.error

    def parameters(x: Array) -> dict[str, Array]:
        return {"color": x[:channels], **dict(zip(row.bounds, x[channels:], strict=True))}

    def residuals(x: Array) -> Array:
        value = row.value(data.wo, data.wi, x[:channels], *x[channels:])
        return np.ravel((value - data.value) / scale)

    lows, highs = zip(*([(0.0, 1.0)] * channels + list(row.bounds.values())), strict=True)
    albedo = list(np.clip(np.pi * data.value.mean(axis=0), 0.05, 0.95))
    starts = product(*(each[2:] for each in row.scalars.values()))
    options: dict[str, Any] = {"bounds": (lows, highs), "xtol": 1e-10, "ftol": 1e-10}
    found = (least_squares(residuals, [*albedo, *start], **options) for start in starts)
    best = min(found, key=lambda each: float(each.cost))
    x = best.x
    # Compute (J^T J)^-1. If there are too few values, rows of 0 complete the singular vectors.
    freedom = data.value.size - len(x)
    _, singular, rows = np.linalg.svd(np.pad(best.jac, ((0, max(-freedom, 0)), (0, 0))), False)
    determined = singular > LEAST_SINGULAR * singular[0]
    covariance = (rows[determined].T / singular[determined] ** 2) @ rows[determined]
    scatter = float(np.sqrt(2.0 * best.cost / max(freedom, 1)))
    if data.error is None:
        covariance *= scatter**2
    # Errors along undetermined directions are infinite. Without a scatter, all errors are infinite.
    undetermined = np.sum(rows[~determined] ** 2, axis=0) > ROUNDED
    undetermined |= data.error is None and freedom <= 0
    covariance[undetermined] = covariance[:, undetermined] = np.inf
    errors = parameters(np.sqrt(np.diag(covariance)))
    return Fit(model, parameters(x), errors, covariance, scatter, data.error is not None)
