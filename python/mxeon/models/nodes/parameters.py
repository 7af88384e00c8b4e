# SPDX-License-Identifier: Apache-2.0
"""Inputs of the BSDF nodes: default, range and unit, in MaterialX's names and order."""

from __future__ import annotations

from dataclasses import dataclass

from mxeon.models.core.ranges import RANGES
from mxeon.models.hair import DEFAULTS as HAIR

Value = float | tuple[float, ...]
WHITE, GRAY, BLACK = (1.0,) * 3, (0.18,) * 3, (0.0,) * 3
FACETS: dict[str, Value] = {
    "roughness": (0.05, 0.05),
    "thinfilm_thickness": 0.0,
    "thinfilm_ior": 1.5,
}
# Defaults of the inputs of a node, in the order of its definition; those that select a mode and those of
# BY_NAME are left out. A test compares them with MaterialX's definitions.
DEFAULTS: dict[str, dict[str, Value]] = {
    "oren_nayar_diffuse_bsdf": {"color": GRAY, "roughness": 0.0},
    "burley_diffuse_bsdf": {"color": GRAY, "roughness": 0.0},
    "translucent_bsdf": {"color": WHITE},
    "subsurface_bsdf": {"color": GRAY, "radius": WHITE},
    "sheen_bsdf": {"color": WHITE, "roughness": 0.3},
    "dielectric_bsdf": {"tint": WHITE, "ior": 1.5, **FACETS},
    "conductor_bsdf": {
        "ior": (0.183, 0.421, 1.373),
        "extinction": (3.424, 2.346, 1.770),
        **FACETS,
    },
    "generalized_schlick_bsdf": {
        "color0": WHITE,
        "color82": WHITE,
        "color90": WHITE,
        "exponent": 5.0,
        **FACETS,
    },
    "chiang_hair_bsdf": HAIR,
    "uniform_edf": {"color": WHITE},
    "conical_edf": {"color": WHITE, "inner_angle": 60.0, "outer_angle": 0.0},
    "generalized_schlick_edf": {"color0": WHITE, "color90": WHITE, "exponent": 5.0, "base": BLACK},
    "absorption_vdf": {"absorption": BLACK},
    "anisotropic_vdf": {"absorption": BLACK, "scattering": BLACK, "anisotropy": 0.0},
}
FRAME = ("weight", "normal", "tangent", "retroreflective")
# Inputs of a lobe's weight, frame and mirror, which a call takes by name alone; others have ("weight", "normal").
BY_NAME = {
    **dict.fromkeys(("dielectric_bsdf", "conductor_bsdf", "generalized_schlick_bsdf"), FRAME),
    "chiang_hair_bsdf": ("normal", "curve_direction"),
}
# What an input is, where functions of `mxeon.models` have another name for it.
QUANTITIES = {
    ("uniform_edf", "color"): "radiance",
    ("conical_edf", "color"): "radiance",
    ("anisotropic_vdf", "anisotropy"): "g",
}
UNITS = {
    "sigma": "rad",
    "thinfilm_thickness": "nm",
    "absorption_coefficient": "1/radius",
    **dict.fromkeys(("absorption", "scattering"), "1/m"),
    **dict.fromkeys(("inner_angle", "outer_angle"), "degree"),
    **dict.fromkeys(("roughness_R", "roughness_TT", "roughness_TRT"), "rad^2, rad"),
}


@dataclass(frozen=True, repr=False)
class Parameter:
    """An input of a model.

    - `name`: MaterialX's name of it.
    - `default`: MaterialX's; a tuple of three for a color, of two for a pair.
    - `quantity`: What it is: the name that it has in functions of `mxeon.models`, which counts as
      well.
    """

    name: str
    default: Value
    quantity: str

    @property
    def channels(self) -> int:
        """3 for a color, 2 for a pair, 0 for a number."""
        return len(self.default) if isinstance(self.default, tuple) else 0

    @property
    def interval(self) -> tuple[float, float]:
        """Least and largest value, both allowed."""
        low, high, _ = RANGES[self.quantity]
        return low, high

    def __repr__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.name} = {self.default}, in {RANGES[self.quantity][2]}{unit}"

    @property
    def unit(self) -> str:
        """Its unit; "1" where it has none."""
        return UNITS.get(self.quantity, "1")


def parameter(category: str, name: str, quantity: str = "") -> Parameter:
    """Input of a node, by its category and name."""
    quantity = quantity or QUANTITIES.get((category, name), name)
    return Parameter(name, DEFAULTS[category][name], quantity)


WEIGHT = Parameter("weight", 1.0, "lobe_weight")
