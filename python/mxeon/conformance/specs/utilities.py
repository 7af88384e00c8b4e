# SPDX-License-Identifier: Apache-2.0
"""Specs of utility nodes, which compute inputs of lobes.

The nodes are pbrlib's utility nodes, and eonlib's nodes that compute the color for an EON albedo.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance import spec, tolerance
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, Counts, Values, float32, generator
from mxeon.conformance.spec import EngineError, Input
from mxeon.conformance.tolerance import Compared, Term, Tolerance, roundings, single, sum_in, sum_of
from mxeon.hosts.calls import GRAPH
from mxeon.models import diffuse
from mxeon.models.nodes import utilities
from mxeon.models.nodes.node import Variant
from mxeon.shaders import nodes
from mxeon.shaders.nodes import INVERSIONS, Node, connection_text, document_text, node_text

NAME, COLOR = "value", "color"  # names of the utility node, and of a node that converts to color
TYPES = {(): "float", (2,): "vector2", (3,): "color3"}  # input types by array shape
SHARES = (0.0, 1e-4, 1e-3, 0.5, 0.98, 0.99, 0.9999, 1.0)  # special values of most inputs
PIGMENTS = (0.01, 0.5, 1.0)
TEMPERATURES = (800.0, 1000.0, 1667.0, 2222.0, 4000.0, 6504.0, 25000.0)
BEYOND = (-1.0, 0.0, 0.5, 1.0, 2.0, 1e3)  # values inside and outside of most inputs' ranges
# fmt: off
# Inputs with special ranges.
INPUTS = {
    each.name: each
    for each in (
        Input("temperature", "float", *(TEMPERATURES[0], TEMPERATURES[-1], TEMPERATURES, 2000.0),
              logarithmic=True, default=5000.0, beyond=(-1.0, 0.0, 1.0, 800.0, 25000.0, 1e9)),
        Input("scale_TT", high=3.0, edges=(0.0, 0.5, 1.0), change=0.7, default=0.5),
        Input("scale_TRT", high=3.0, edges=(0.0, 1.0, 2.0), change=1.5, default=2.0),
        Input("eumelanin_color", "color3", 0.01, 1.0, PIGMENTS, 0.25, default=0.5),
        Input("pheomelanin_color", "color3", 0.01, 1.0, PIGMENTS, 0.25, default=0.7),
    )
}
# fmt: on

# The aspect ratio is the square root of 1 - x with x <= 0.98, so a rounding of x grows by up to 1 /
# (2 (1 - 0.98)). Errors are absolute, because the smallest alpha is 1e-8.
ALPHA = sum_in(
    Quantity.ALPHA, roundings(12), roundings(0.25 / 0.02, "(half a rounding, divided by 0.04)")
)
BLACKBODY = sum_of(
    Term(1.9e-4, "the fits of X and Z: 1.2e-4 in red, 7e-5 in a clipped luminance"),
    quantity=Quantity.OUTPUT,
)
DECIMALS = Term(3 * 5e-7, "three constants of six decimals")
REFLECTANCE = sum_in(Quantity.REFLECTANCE, DECIMALS, roundings(12, "of numbers up to 1"))
# Tolerances of values, by the spec's title or the node's category.
# fmt: off
VALUES: Mapping[str, Tolerance] = {
    **dict.fromkeys(INVERSIONS, REFLECTANCE),
    **dict.fromkeys(("roughness_anisotropy", "glossiness_anisotropy"), ALPHA),
    "roughness_dual": sum_in(Quantity.ALPHA, roundings(2)),
    "artistic_ior, ior": sum_in(Quantity.INDEX, roundings(16, "(four divided by 1 - sqrt(r), six in the other term, six in the mix)")),
    "artistic_ior, extinction": sum_in(
        Quantity.EXTINCTION, roundings(8 + 16 + 4, "(8 in the terms of k^2, 16 in n, 4 in 1 - r and the root)")),
    "blackbody": BLACKBODY,
    "chiang_hair_roughness": sum_of(roundings(24), quantity=Quantity.OUTPUT),
    "deon_hair_absorption_from_melanin": sum_of(roundings(16), quantity=Quantity.OUTPUT),
    "chiang_hair_absorption_from_color": sum_of(roundings(2 * 12, "of a square"), quantity=Quantity.OUTPUT),
}
OSL_BLACKBODY = single(
    4e-3, Quantity.OUTPUT,
    "OSL's blackbody() has its own observer (380 nm to 780 nm), table and primaries", tolerance.scaled)
OTHERS: Mapping[str, dict[str, Tolerance]] = {"blackbody": {"osl_value": OSL_BLACKBODY}}
# fmt: on
FEWER = 1 << 12  # number of arguments at which an engine's functions are measured
LEAST_LOGARITHM = 1e-4  # smallest argument at which a logarithm is measured


def _shares() -> Array:
    """Random float32 numbers in [0, 1]. The last number is 1."""
    return float32(np.append(generator().random(FEWER), 1.0))


# Errors of an engine's x^20 and x^22 for x in [0, 1], and of logarithms of numbers below 1.
_power_error = spec.POWER.error(lambda: (_shares(), np.resize([22.0, 20.0], FEWER + 1)), 0.0)
_logarithm_error = spec.LOGARITHM.error(
    lambda: [float32(LEAST_LOGARITHM ** (1.0 - _shares()))], 0.0
)
# For each node, the error of an engine's function, times the derivative of the output with respect
# to the function.
# fmt: off
ENGINE = {
    "chiang_hair_roughness": EngineError("the engine's pow(), times 2 x 3.7 / 5.24", _power_error, 1.5),
    "deon_hair_absorption_from_melanin": EngineError(
        "the engine's log(), times 9.2 of the concentration and 4.6 of the colors", _logarithm_error, 14.0),
    "chiang_hair_absorption_from_color": EngineError(
        "the engine's log(), times 2 x 6.9 / 3.4^2", _logarithm_error, 2.0),
}
# fmt: on


@dataclass(frozen=True, eq=False, kw_only=True)
class UtilitySpec(spec.RowSpec[utilities.Outputs]):
    """An output of a node of `mxeon.models.nodes.utilities`."""

    requires = spec.Ability.OUTPUT

    row: utilities.UtilityNode
    output: str

    @property
    def names(self) -> tuple[str, ...]:
        # A roughness depends only on the scale of the same lobe, such as `scale_TT`.
        suffix = self.output.removeprefix("roughness")
        names = self.row.inputs
        return tuple(x for x in names if not x.startswith("scale_") or x.endswith(suffix))

    def document(self, inputs: Values | None = None) -> str:
        kind, single = self.row.outputs[self.output], len(self.row.outputs) == 1
        node = Node(self.node, kind if single else "multioutput")
        text = nodes.network_text({NAME: node}, spec.ports(self.inputs, inputs))
        source, port = NAME, "" if single else self.output
        if kind != "color3":
            text += node_text("convert", "color3", COLOR, connection_text("in", kind, NAME, port))
            source, port = COLOR, ""
        color = connection_text("color", "color3", source, port)
        text += node_text("uniform_edf", "EDF", "lobe", color)
        surface = connection_text("edf", "EDF", "lobe")
        return document_text(text + node_text("surface", "surfaceshader", "shading", surface))

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        rng, count = generator(), counts.pairs
        drawn = (spec.draw(rng, count, self.inputs, edged) for edged in (False, True))
        return tuple(map(_batch, drawn))

    def outside(self, counts: Counts) -> Batch:
        rng, count = generator(), counts.pairs
        shapes = {each.name: (count, *spec.COMPONENTS[each.type]) for each in self.inputs}
        return _batch({x.name: rng.choice(x.beyond, shapes[x.name]) for x in self.inputs})

    def values(self, function: utilities.Outputs, batch: Batch) -> Array:
        """The output as a color, whose missing channels are 0, (N, 3)."""
        output = np.asarray(function(spec.broadcast_inputs(batch))[self.output])
        color = np.zeros((len(batch.wo), 3))
        color[:, : output.shape[-1]] = output
        return color

    def rescaled(self, compared: Compared) -> Compared:
        """Scale a metal's IOR n + ik so that roundings have a uniform effect.

        n becomes n (1 - sqrt(r))^2, because n has the divisor 1 - sqrt(r). k becomes k^2 (1 - r) /
        (n_max + 1)^2, because k^2 has the divisor 1 - r and is a difference of terms as large as
        (n_max + 1)^2.
        """
        if self.node != "artistic_ior":
            return compared
        r = np.clip(compared.batch.inputs["reflectivity"], 0.0, utilities.LARGEST_REFLECTIVITY)
        inverse = 1.0 / np.square(1.0 - np.sqrt(r))  # (n_max + 1)^2 / 4
        if self.output == "ior":
            return compared.over(inverse)
        squares = map(np.square, compared[1:])
        return Compared(compared.batch, *squares).over(4.0 * inverse / (1.0 - r))


def _batch(inputs: Mapping[str, Array]) -> Batch:
    """A batch with the given inputs. The directions have no effect."""
    count = len(next(iter(inputs.values())))
    up = np.broadcast_to([0.0, 0.0, 1.0], (count, 3))
    return Batch(up, up, inputs)


def _inversion(node: str) -> utilities.UtilityNode:
    """A row for an inversion of EON, with other inversions and the unchanged color as variants."""

    def output(name: str) -> utilities.Outputs:
        function = getattr(diffuse, name)
        return lambda inputs: {"out": function(inputs["color"], inputs["roughness"])}

    variants = [Variant("the color itself", lambda inputs: {"out": inputs["color"]})]
    others = (each for each in dir(diffuse) if each.startswith("eon_rho_from") and each != node)
    variants += [Variant(name, output(name)) for name in others]
    inputs: dict[str, float | tuple[float, ...]] = {"color": (0.18, 0.18, 0.18), "roughness": 0.0}
    return utilities.utility(node, inputs, {"out": "color3"}, output(node), tuple(variants))


def _spec(row: utilities.UtilityNode, output: str, *libraries: str) -> UtilitySpec:
    title = row.category if len(row.outputs) == 1 else f"{row.category}, {output}"

    def filled(each: Input, value: ArrayLike | None) -> ArrayLike:
        return np.full(spec.COMPONENTS[each.type], value)

    usual = partial(Input, edges=SHARES, change=0.25, default=0.5)
    types = {name: TYPES[np.shape(value)] for name, value in row.inputs.items()}
    rows = [INPUTS.get(name) or usual(name, kind) for name, kind in types.items()]
    whole = {each.name: filled(each, each.default) for each in rows}
    inputs = tuple(
        replace(each, change=filled(each, each.change), needs=whole, beyond=each.beyond or BEYOND)
        for each in rows
    )
    return UtilitySpec(
        **spec.named(row, title),
        row=row,
        inputs=inputs,
        errors={"value": VALUES.get(title) or VALUES[row.category], **OTHERS.get(title, {})},
        output=output,
        engines={"value": (ENGINE[row.category],)} if row.category in ENGINE else {},
        libraries=libraries,
        closure=False,
        counts=Counts(1 << 12, 1 << 9, 1 << 9),
        evaluated=(GRAPH, "response", 1.0),
    )


UTILITY_SPECS = tuple(_spec(row, output) for row in utilities.UTILITIES for output in row.outputs)
INVERSION_SPECS = tuple(_spec(_inversion(node), "out", "eonlib", "diffuse") for node in INVERSIONS)
