# SPDX-License-Identifier: Apache-2.0
"""The closures of renderers that generated text calls: their arguments, and their values.

A renderer's documentation says both; none is executed here. Directions and values are those of
`mxeon.models.diffuse.formulas`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from mxeon.conformance.text.interpreter import Array, Closure, Value, weighted
from mxeon.models.diffuse import formulas
from mxeon.shaders.nodes import FLAG

Closures = tuple[Closure, ...]
Builder = Callable[[Mapping[str, Value]], Closures]
ONES, ZEROS = np.ones((1, 1)), np.zeros((1, 1))
PBRLIB = "materialx::pbrlib_1_10::mx_oren_nayar_diffuse_bsdf"


@dataclass
class Renderer:
    """A renderer whose closures a text calls, and the faults of those calls."""

    name: str
    target: str  # of the text
    profile: str | None = None
    # Calls that the renderer would refuse or take for others, in words.
    faults: list[str] = field(default_factory=list)

    def closures(self) -> Mapping[str, Builder]:
        """The functions that give closures."""
        if self.target == "osl":
            return {
                "oren_nayar_diffuse_bsdf": self._oren_nayar,
                "null_closure": lambda arguments: (),
            }
        return {
            "material": lambda arguments: self._only(arguments, "surface"),
            "material_surface": lambda arguments: self._only(arguments, "scattering"),
            "df::weighted_layer": self._weighted_layer,
            "df::diffuse_reflection_bsdf": self._diffuse_reflection,
            PBRLIB: self._pbrlib,
        }

    def value(self, closure: Closure, wo: Array, wi: Array) -> Array:
        """Value of a closure times its weight, (N, 3)."""
        arguments = closure.arguments
        color, roughness = _channels(arguments["color"]), arguments["roughness"][:, 0]
        fon, eon = (
            each(wo, wi, color, roughness) for each in (formulas.fon_brdf, formulas.eon_brdf)
        )
        if self.target == "mdl":
            white = np.ones((3, 1))
            loss = formulas.eon_brdf(wo, wi, white, roughness)
            loss = loss - formulas.fon_brdf(wo, wi, white, roughness)
            values = fon + _channels(arguments["multiscatter_tint"]) * loss
        elif self.profile == "cycles":
            values = fon + color * (eon - fon)
        else:
            qon = formulas.qon_brdf(wo, wi, color, roughness)
            values = np.where(arguments[FLAG][:, 0] != 0.0, eon, qon)
        product: Array = closure.weight * np.moveaxis(values, 0, -1)
        return product

    def _oren_nayar(self, arguments: Mapping[str, Value]) -> Closures:
        """OSL's closure: (normal N, color albedo, float roughness, "energy_compensation", int)."""
        known = {"0": "normal", "1": "color", "2": "roughness"}
        keyword = f'"{FLAG}"'
        for name in arguments:
            if name not in (*known, keyword):
                kind = f"keyword {name}" if '"' in name else f"argument {name}"
                self.faults.append(f"{kind} is not known to OSL")
        # Read those that it has, of which Cycles lacks the flag.
        values = {FLAG: arguments.get(keyword, ZEROS)}
        if self.profile == "cycles" and keyword in arguments:
            self.faults.append(f"keyword {keyword} is not known to Cycles")
        for position, name in known.items():
            values[name] = self._typed(name, arguments.get(position))
        return self._closure(values)

    def _diffuse_reflection(self, arguments: Mapping[str, Value]) -> Closures:
        """MDL's closure, with its defaults."""
        names = {"tint": "color", "roughness": "roughness", "multiscatter_tint": None}
        values = {"color": ONES, "roughness": ZEROS, "multiscatter_tint": ZEROS}
        for name, value in self._named(arguments, names).items():
            values[names[name] or name] = value
        values["roughness"] = self._typed("roughness", values["roughness"])
        return self._closure(values)

    def _weighted_layer(self, arguments: Mapping[str, Value]) -> Closures:
        known = self._named(arguments, ("weight", "normal", "layer", "base"))
        layer = tuple(
            Closure(each.name, each.weight, {**each.arguments, "normal": known.get("normal")})
            for each in known.get("layer", ())
        )
        weight = self._typed("weight", known.get("weight", ONES))
        return weighted(layer, weight) + weighted(known.get("base", ()), 1.0 - weight)

    def _pbrlib(self, arguments: Mapping[str, Value]) -> Closures:
        """The function of MDL's module, which is FON, and with the flag a white lobe beside it."""
        names = [f"mxp_{name}" for name in ("weight", "color", "roughness", "normal", FLAG)]
        known = {
            name.removeprefix("mxp_"): value
            for name, value in self._named(arguments, names).items()
        }
        values = {"multiscatter_tint": known.pop(FLAG, ZEROS), **known}
        weight = values.pop("weight", ONES)
        return weighted(self._closure(values), weight)

    def _closure(self, values: Mapping[str, Value]) -> Closures:
        return (Closure(self.name, ONES, values),)

    def _only(self, arguments: Mapping[str, Value], name: str) -> Closures:
        """The one argument, closures, that matters of a structure's."""
        return tuple(self._named(arguments, (name,)).get(name, ()))

    def _named(self, arguments: Mapping[str, Value], names: object) -> dict[str, Value]:
        known = {name: value for name, value in arguments.items() if name in names}  # type: ignore[operator]
        self.faults += [
            f"argument {name} is not known to MDL" for name in arguments if name not in known
        ]
        return known

    def _typed(self, name: str, value: Value | None) -> Array:
        """A number, color or vector; another is a fault."""
        width = 3 if name in ("normal", "color") else 1
        if not isinstance(value, np.ndarray):
            self.faults.append(f"{name} is not passed")
            return np.zeros((1, width))
        if value.shape[1] > width:
            self.faults.append(f"{name} is a float but receives a color or vector")
            mean: Array = value.mean(axis=1, keepdims=True)
            return mean
        return value


def _channels(color: Array) -> Array:
    """A color with its channels on the first axis."""
    return np.moveaxis(np.broadcast_to(color, (len(color), 3)), -1, 0)
