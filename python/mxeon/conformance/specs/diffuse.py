# SPDX-License-Identifier: Apache-2.0
"""Specs of the rough diffuse nodes and of the diffuse lobes of surface shaders."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import LOBE_RIM, TURNED, Array, Batch, Counts, Values, directions_at
from mxeon.conformance.spec import CHANGED_COLOR, Ability, Input, color
from mxeon.conformance.specs.lobes import ScatteringSpec
from mxeon.conformance.tolerance import Term, roundings, sum_in
from mxeon.models import table as reference
from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.models.nodes.node import PbrNode, Variant
from mxeon.models.table import Model
from mxeon.shaders.nodes import EON, FLAG, OREN_NAYAR, document_text, input_text, node_text

EDGES = (0.0, 1e-6, 1e-3, 1.0)  # special colors, and special fractions of the largest roughness
PICTURE_INPUTS: tuple[Values, ...] = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5, "weight": 0.5},
)
COUNTS = Counts(nodes=16)  # a quadrature with this number of nodes has an error of 2e-8
LOSS_FIT = 2.7e-7  # relative error of the fit of H, the loss of FON (tools/fits/fon_loss.py)

VALUE = sum_in(
    Quantity.DIFFERENCE,
    roundings(28, "(14 of numbers up to 2)"),
    Term(LOSS_FIT, "two fits of H, times a multiple-scattering part of at most 1/2"),
)
# Of the 16 roundings, 12 are in the longest chain of operations, two are in the cosine, and two are
# in the fit of H.
LARGE_NUMBERS = roundings(16 * 1.02, "of numbers up to 1.02, including the fit of H")
ENVIRONMENT = sum_in(Quantity.ALBEDO, LARGE_NUMBERS)
# Oren and Nayar's model amplifies the rounding of a cosine of at least 1/4: by 4 in the ratio s /
# t, by 3 in a sine, and by 2 in the other factors. The sum is 9.
FRAME = sum_in(
    Quantity.VALUE_OR_ALBEDO,
    roundings(2 * 28, "of two values"),
    roundings(2 * 5 * (1.0 / TURNED[0] + 5.0), "(five in each of two cosines, times 9)"),
)
LAMBERT = sum_in(Quantity.DIFFERENCE, roundings(8))
ERRORS = {
    "value": VALUE,
    "albedo": ENVIRONMENT,
    "frame": FRAME,
    "integral": sum_in(Quantity.ALBEDO, VALUE.term("an average of values"), exact=True),
    "reciprocity": sum_in(Quantity.RECIPROCITY, *VALUE.terms),
    "lambert": LAMBERT,
}
LOBE_VALUE = sum_in(
    Quantity.DIFFERENCE,
    roundings(32, "in the lobe"),
    roundings(4 * 48, "in sums that other lobes make 48 times as large"),
    exact=True,
)


INPUTS = (
    Input("weight", change=0.5),
    Input("color", "color3", change=CHANGED_COLOR),
    Input("roughness", change=0.3),
    Input("normal", "vector3", change=(0.0, 0.6, 0.8)),
)


def inputs_of(*names: str) -> tuple[Input, ...]:
    return tuple(each for each in INPUTS if each.name in names)


@dataclass(frozen=True, eq=False, kw_only=True)
class DiffuseModelSpec(ScatteringSpec):
    """A rough diffuse model in a renderer's node or, in subclasses, in other nodes and lobes."""

    requires = Ability.OWN

    counts: Counts = COUNTS
    flat: bool = True

    @property
    def drawn(self) -> tuple[Input, Input]:
        """The inputs color and roughness. The largest roughness is rounded down to float32."""
        largest = reference.diffuse_model(self.model).largest
        most = np.float32(largest)
        high = float(most if most <= largest else np.nextafter(most, np.float32(0.0)))
        edges = tuple(high * each for each in EDGES)
        return color("color", edges=EDGES), Input("roughness", high=high, edges=edges)

    @property
    def materials(self) -> tuple[Values, ...]:
        names = {"color", "roughness", *self.names}
        return tuple({name: row[name] for name in row if name in names} for row in PICTURE_INPUTS)

    def random_inputs(
        self, rng: np.random.Generator, count: int, edged: bool = False
    ) -> dict[str, Array]:
        """Random inputs. Unless `edged`, the last sixteenth of the colors is gray."""
        inputs = super().random_inputs(rng, count, edged)
        if not edged:
            gray = inputs["color"][count - count // 16 :]
            gray[:] = gray[:, :1]
        return inputs

    def edges(self, counts: Counts) -> Batch:
        cosine = [0.0, 1e-30, 1e-6, 0.5, 1.0]
        rows = product(cosine, cosine, [0.0, 1.0, 2.0, math.pi], [0.0, 1e-6, 1.0], [0.0, 0.5, 1.0])
        mu_o, mu_i, azimuth, roughness, color = np.array(list(rows)).T
        wo, wi = directions_at(mu_o, 0.0), directions_at(mu_i, azimuth)
        return Batch(wo, wi, {"color": np.stack([color] * 3, axis=-1), "roughness": roughness})

    def nodes(self, wo: Array, inputs: dict[str, Array], count: int) -> tuple[Array, Array]:
        _, wi, weights = hemisphere_nodes(wo[:, 2], count)
        azimuth = np.arctan2(wo[:, 1:2], wo[:, :1]) + np.arctan2(wi[..., 1], wi[..., 0])
        return directions_at(wi[..., 2], azimuth), weights / (np.pi * wi[..., 2])


def model_row(model: str, node: str, others: tuple[Model, ...] = ()) -> PbrNode:
    """A table row with the expected model of a node, and all other known models as variants."""
    known = others + reference.KNOWN_DEFECTS + reference.DIFFUSE_MODELS
    rows = {each.name: each for each in known}
    expected = reference.diffuse_model(model)
    # Models with equal BRDFs are a single variant for values, but separate variants for albedos.
    owners = {each.brdf_of: each.name for each in (*rows.values(), expected)}
    variants = []
    for name, each in rows.items():
        value = _limited(each.value, each.largest) if owners[each.brdf_of] == name else None
        albedo = _limited(each.albedo, each.largest) if each.albedo_dir else None
        if name != model:
            variants.append(Variant(each.title, value, albedo))
    return replace(expected, category=node, variants=tuple(variants))


def _limited(function: Callable[..., Array], largest: float) -> Callable[..., Array]:
    """The function with roughness limited to `largest`. The inputs are the last argument."""

    def limited(*arguments: Any) -> Array:
        *directions, inputs = arguments
        roughness = np.minimum(inputs["roughness"], largest)
        return function(*directions, {**inputs, "roughness": roughness})

    return limited


@dataclass(frozen=True, eq=False, kw_only=True)
class DiffuseSpec(DiffuseModelSpec):
    """A rough diffuse node with one value of its input `energy_compensation`."""

    requires = Ability.DIFFUSE

    flag: bool | None  # value of `energy_compensation`; None if the node has no such input


DIFFUSE = tuple(
    DiffuseSpec(
        title=node if flag is None else f"{node}, {FLAG} {str(flag).lower()}",
        node=node,
        model=model,
        row=model_row(model, node),
        flag=flag,
        inputs=INPUTS if flag is None else (*INPUTS, Input(FLAG, "boolean", change=not flag)),
        fixed={} if flag is None else {FLAG: flag},
        errors=ERRORS,
        along=0.1 if model == "qon" else 0.0,
    )
    for node, flag, model in (
        (OREN_NAYAR, True, "eon"),
        (OREN_NAYAR, False, "qon"),
        (EON, None, "eon"),
    )
)


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfaceLobe(DiffuseModelSpec):
    """The diffuse lobe of a surface shader whose other lobes cannot be disabled.

    The other lobes depend only on the directions, so two evaluations isolate the diffuse lobe. With
    a black color, only the other lobes remain. With a white color and a roughness of 0, every
    diffuse model equals Lambert's model, so the result is the share of light that reaches the
    diffuse lobe and returns.
    """

    requires = Ability.BELOW
    coarse = 4
    rim = LOBE_RIM

    ports: Mapping[str, str]  # the lobe's inputs, each with the name of the shader's input
    set_inputs: tuple[tuple[str, str, str], ...] = ()  # name, type and value of additional inputs

    def document(self, inputs: Values | None = None) -> str:
        types, inputs = {"color": "color3", "roughness": "float"}, inputs or {}
        rows = [
            (self.ports[each], types[each], inputs[each]) for each in self.ports if each in inputs
        ]
        ports = "".join(input_text(*row) for row in (*rows, *self.set_inputs))
        return document_text(node_text(self.node, "surfaceshader", "shading", ports))


# fmt: off
# Rows: node, mode, specified model, names of the color and roughness inputs, additional inputs.
ROWS: tuple[tuple[str, str, str, tuple[str, ...], tuple[tuple[str, str, str], ...]], ...] = (
    ("open_pbr_surface", "", "eon", ("base_color", "base_diffuse_roughness"), ()),
    ("open_pbr_surface", "thin-walled", "eon", ("subsurface_color", "base_diffuse_roughness"),
     (("geometry_thin_walled", "boolean", "true"), ("subsurface_weight", "float", "1.0"))),
    ("standard_surface", "", "qon", ("base_color", "diffuse_roughness"), (("base", "float", "1.0"),)),
    ("UsdPreviewSurface", "", "lambert", ("diffuseColor",), ()),
    ("gltf_pbr", "", "lambert", ("base_color",), (("metallic", "float", "0.0"),)),
)
# fmt: on
SURFACE_LOBES = tuple(
    SurfaceLobe(
        title=f"{node}, {mode}" if mode else node,
        node=node,
        model=model,
        row=model_row(model, node),
        ports=dict(zip(("color", "roughness"), ports, strict=False)),
        set_inputs=additional,
        # Every library has MaterialX's own thin-walled lobe, so judge only one library.
        libraries=("stock",) if mode else (),
        errors={"value": LOBE_VALUE},
    )
    for node, mode, model, ports, additional in ROWS
)
