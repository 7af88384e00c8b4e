# SPDX-License-Identifier: Apache-2.0
"""The lobes of surface shaders under one light.

Parameters are a mapping from the specification's names to values. Numbers have shape (N, 1) and
colors (N, 3), or (1, 1) and (1, 3) if all points share the value. Directions (N, 3) are unit
vectors in the frame of the geometric normal, above the horizon.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from mxeon.models.core.arrays import Array
from mxeon.models.nodes import node
from mxeon.models.nodes.node import PbrNode
from mxeon.models.shading_model import ALONG, UP
from mxeon.models.table import diffuse_model

Parameters: TypeAlias = Mapping[str, Array]
Values: TypeAlias = Mapping[str, ArrayLike]


def filled(defaults: Values, **inputs: ArrayLike) -> dict[str, Array]:
    """The parameters in `inputs`, and defaults for all other parameters, as columns.

    An array has a row for each point. A number or a tuple is valid for all points. Raises TypeError
    for unknown names.
    """
    if unknown := sorted(inputs.keys() - defaults.keys()):
        raise TypeError(f"parameters are {', '.join(defaults)}; got {', '.join(unknown)}")
    return {name: _column(value) for name, value in {**defaults, **inputs}.items()}


def _column(value: ArrayLike) -> Array:
    array = np.asarray(value, np.float64)
    varied = isinstance(value, np.ndarray) and array.ndim > 0
    return array.reshape(len(array) if varied else 1, -1)


@dataclass(frozen=True, eq=False)
class Frame:
    """A shading normal and tangent, (N or 1, 3), not necessarily orthogonal."""

    normal: Array
    tangent: Array

    def local(self, wo: Array, directions: Array) -> Array:
        """Directions (N, 3) in the shading frame, after the normal is flipped toward the viewer."""
        facing = np.where((wo * self.normal).sum(axis=1, keepdims=True) < 0.0, -1.0, 1.0)
        z = np.broadcast_to(facing * self.normal, wo.shape)
        x = self.tangent - (self.tangent * z).sum(axis=1, keepdims=True) * z
        x = x / np.linalg.norm(x, axis=1, keepdims=True)
        axes = np.stack([x, np.cross(z, x), z], axis=1)
        return np.asarray((axes @ directions[:, :, np.newaxis])[:, :, 0])

    def turned(self, angle: Array) -> Frame:
        """The frame, rotated counterclockwise about the normal by `angle`, (N, 1)."""
        tangent = np.cos(angle) * self.tangent
        tangent = tangent + np.sin(angle) * np.cross(self.normal, self.tangent)
        return Frame(self.normal, tangent)


PLAIN = Frame(np.array([UP]), np.array([ALONG]))


@dataclass(frozen=True, eq=False)
class Light:
    """A distant light of irradiance 1 at normal incidence, or a white environment of radiance 1.

    - `wo`: directions to the viewer.
    - `wi`: directions to the distant light; None for an environment.
    - `behind`: if true, the environment contributes only refracted light, as in rasterizers.
    """

    wo: Array
    wi: Array | None = None
    behind: bool = False

    def response(self, lobe: PbrNode, frame: Frame = PLAIN, **inputs: ArrayLike) -> Array:
        """Radiance that a lobe reflects, (N, 3): f cos(theta_i), or E in an environment."""
        if self.wi is None:
            return np.zeros(self.wo.shape) if self.behind else self.albedo(lobe, frame, **inputs)
        wo, wi = (frame.local(self.wo, each) for each in (self.wo, self.wi))
        lit = wi[:, 2:] > 0.0
        value = lobe.value(wo, np.where(lit, wi, [UP]), self._columns(inputs))
        return np.where(lit, value * wi[:, 2:], 0.0)

    def albedo(self, lobe: PbrNode, frame: Frame = PLAIN, **inputs: ArrayLike) -> Array:
        """Directional albedo E of a lobe for the viewer's direction, (N, 3)."""
        wo = frame.local(self.wo, self.wo)
        return np.broadcast_to(lobe.albedo(wo, self._columns(inputs)), wo.shape)

    def both(self, lobe: PbrNode, frame: Frame = PLAIN, **inputs: ArrayLike) -> tuple[Array, Array]:
        return self.response(lobe, frame, **inputs), self.albedo(lobe, frame, **inputs)

    def layered(
        self, lobe: PbrNode, frame: Frame, weight: Array | float, base: Array, **inputs: ArrayLike
    ) -> Array:
        """A lobe layered over `base` by albedo scaling: weight f + (1 - weight E) base."""
        if not np.any(weight):
            return base
        f, E = self.both(lobe, frame, **inputs)
        return weight * f + (1.0 - weight * E) * base

    def through(self, share: ArrayLike) -> Array:
        """Radiance `share`, (N, 3), refracted from a white environment; 0 if `behind` is false."""
        light = 1.0 if self.behind else 0.0
        return np.broadcast_to(light * np.asarray(share), self.wo.shape)

    def diffused(self, share: ArrayLike) -> Array:
        """Radiance diffusely transmitted from the other side, (N, 3). A distant light adds 0."""
        light = 1.0 if self.wi is None and not self.behind else 0.0
        return np.broadcast_to(light * np.asarray(share), self.wo.shape)

    def _columns(self, inputs: Mapping[str, ArrayLike]) -> dict[str, Array]:
        """Inputs of a lobe, broadcast to a row for each point. Numbers have shape (N,)."""
        count = len(self.wo)
        columns = {}
        for name, value in inputs.items():
            each = np.asarray(value, np.float64)
            width = each.shape[1] if each.ndim == 2 else 1
            column = np.broadcast_to(each.reshape(-1, width), (count, width))
            columns[name] = column[:, 0] if width == 1 else column
        return columns


EON, QON = diffuse_model("eon"), diffuse_model("qon")  # EON and QON are Lambertian at roughness 0
DIELECTRIC, SCHLICK = node("dielectric"), node("schlick")
CONDUCTOR, ZELTNER, CONTY_KULLA = node("conductor"), node("zeltner"), node("conty_kulla")
ONES = np.ones((1, 3))


def lerp(first: ArrayLike, second: ArrayLike, share: ArrayLike) -> Array:
    """Linear interpolation (1 - share) first + share second."""
    share = np.asarray(share, np.float64)
    return np.asarray((1.0 - share) * np.asarray(first) + share * np.asarray(second))


def f0_from_ior(eta: ArrayLike) -> Array:
    """Normal-incidence reflectance of a dielectric whose relative index of refraction is `eta`."""
    eta = np.asarray(eta, np.float64)
    return np.asarray(np.square((eta - 1.0) / (eta + 1.0)))


def schlick_inputs(
    f0: ArrayLike, f90: ArrayLike, alpha: Array, f82: ArrayLike = ONES
) -> dict[str, ArrayLike]:
    colors = {"color0": f0, "color82": f82, "color90": f90}
    return {**colors, "exponent": 5.0, "roughness": alpha}
