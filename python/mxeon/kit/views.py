# SPDX-License-Identifier: Apache-2.0
"""Views of the kit, which show each material under one or more lights."""

from dataclasses import dataclass, replace

from mxeon.errors import InputError
from mxeon.shaders.scene import BACK, FRONT, FURNACE, SIDE, Scene

COLOR = (0.2, 0.5, 0.8)  # different channels reveal a wrong power of the color

# Widths of pictures in pixels. Below the smallest width, corners of judged pixels may be outside
# the sphere. Widths above the largest width have no advantage.
SMALLEST, USUAL, LARGEST = 64, 128, 2048


@dataclass(frozen=True)
class Material:
    """A rough diffuse material. The name is one lower-case word."""

    name: str
    color: tuple[float, float, float]
    roughness: float
    energy_compensation: bool

    @property
    def model(self) -> str:
        """Name of the model that the node must have for this value of `energy_compensation`."""
        return "eon" if self.energy_compensation else "qon"


TRUE = Material("true", COLOR, 1.0, True)
FALSE = Material("false", COLOR, 1.0, False)
HALF = Material("half", COLOR, 0.5, True)
BLACK_MATERIAL = Material("black", (0.0, 0.0, 0.0), 1.0, True)
WHITE_MATERIAL = Material("white", (1.0, 1.0, 1.0), 1.0, True)
LAMBERT = Material("lambert", COLOR, 0.0, True)
MATERIALS = (LAMBERT, TRUE, HALF, FALSE, BLACK_MATERIAL, WHITE_MATERIAL)


@dataclass(frozen=True)
class View:
    material: Material
    scene: Scene

    @property
    def name(self) -> str:
        return f"{self.material.name}_{self.scene.name}"


# Lambert under a distant light reveals errors of light, orientation and encoding in any model.
SETUP = View(LAMBERT, SIDE)
PICTURES = (
    SETUP,
    *(View(TRUE, scene) for scene in (FRONT, SIDE, BACK, FURNACE)),
    View(HALF, SIDE),
    *(View(FALSE, scene) for scene in (FRONT, SIDE, BACK, FURNACE)),
    View(BLACK_MATERIAL, SIDE),
    View(WHITE_MATERIAL, FURNACE),
)


def views(size: int) -> tuple[View, ...]:
    """All views, as pictures of `size` x `size` pixels."""
    if not SMALLEST <= size <= LARGEST:
        raise InputError(f"size must lie in [{SMALLEST}, {LARGEST}]; got {size}")
    return tuple(replace(view, scene=replace(view.scene, size=size)) for view in PICTURES)
