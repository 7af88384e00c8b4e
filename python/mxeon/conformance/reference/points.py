# SPDX-License-Identifier: Apache-2.0
"""The points of a picture, or the pairs of an evaluation: directions, frames and light."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mxeon.conformance.reference.lobes import Lobe, furnace, kept, lit
from mxeon.conformance.reference.operations import Values
from mxeon.errors import NotRun, OutsideModel

UNIT = 1e-3  # by how much the length of a normal may differ from 1


@dataclass(frozen=True, eq=False)
class ShadingPoints:
    """Where a graph is evaluated, and by which light."""

    wo: Values  # unit vectors to the viewer, in world space
    wi: Values | None  # unit vectors to a distant light; None in a uniform environment
    strength: float  # irradiance of the light, or radiance of the environment
    normal: Values  # of the surface, orthogonal unit vectors in world space
    tangent: Values
    texcoord: Values | None = None
    # Points with materials of their own whose albedos are integrated; see `lobes.lit`.
    most: float = np.inf
    round: bool = False  # whether these are points of the unit sphere
    behind: bool = False  # whether light that is transmitted is asked for, and no other

    def lobe(self, normal: Values, tangent: Values) -> Lobe:
        """Lobe whose frame has a normal, turned to the viewer, and a tangent.

        Raise OutsideModel if a normal is no unit vector.
        """
        own = np.array_equal(normal, self.normal) and np.array_equal(tangent, self.tangent)
        return self._own if own else self._turned(normal, tangent)

    def geometry(self, name: str) -> Values:
        """A property of the surface by its name in MaterialX; raises NotRun if it is not known."""
        known = {
            "Nworld": self.normal,
            "Tworld": self.tangent,
            "Bworld": np.cross(self.normal, self.tangent),
            "UV0": self.texcoord,
        }
        if (value := known.get(name)) is None:
            raise NotRun(f"reference: the surface has no {name} here")
        return value

    @cached_property
    def view(self) -> Values:
        """Unit vectors to the viewer in the frame of the surface, (N, 3)."""
        return _within(self._axes(self.normal, self.tangent), self.wo)

    @cached_property
    def _own(self) -> Lobe:
        """Lobe in the frame of the surface; the last ones are kept, which another library's document has too."""
        return kept(self._turned(self.normal, self.tangent))

    def _turned(self, normal: Values, tangent: Values) -> Lobe:
        wo, wi = self.directions(normal, tangent)
        if wi is None:
            return furnace(wo, self.strength, self.most, self.behind)
        return lit(wo, wi, self.strength, self.most)

    def directions(self, normal: Values, tangent: Values) -> tuple[Values, Values | None]:
        """Directions to the viewer and to the light in a frame, whose normal is turned to the viewer.

        Raise OutsideModel if a normal is no unit vector.
        """
        length = np.linalg.norm(normal, axis=-1)
        if (wrong := np.ravel(length)[np.ravel(~(np.abs(length - 1.0) <= UNIT))]).size:
            raise OutsideModel(f"reference: normal must have the length 1; got {wrong[0]:g}")
        side = np.where((self.wo * normal).sum(axis=-1, keepdims=True) < 0.0, -1.0, 1.0)
        axes = self._axes(side * normal, tangent)
        return _within(axes, self.wo), None if self.wi is None else _within(axes, self.wi)

    def _axes(self, z: Values, tangent: Values) -> Values:
        """Axes of a frame, orthogonal unit vectors, as rows (N, 3, 3)."""
        x = tangent - (tangent * z).sum(axis=-1, keepdims=True) * z
        axes = np.stack(np.broadcast_arrays(x, np.cross(z, x), z), axis=1)
        with np.errstate(invalid="ignore"):  # a tangent along the normal shows in the values
            return np.asarray(axes / np.linalg.norm(axes, axis=2, keepdims=True))


def _within(axes: Values, directions: Values) -> Values:
    """Directions in a frame, whose axes are the rows, as unit vectors (N, 3)."""
    local = (axes @ directions[:, :, np.newaxis])[:, :, 0]
    return np.asarray(local / np.linalg.norm(local, axis=1, keepdims=True), np.float64)
