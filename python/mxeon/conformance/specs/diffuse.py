# SPDX-License-Identifier: Apache-2.0
"""Specs of the rough diffuse nodes, mode by mode, and of the diffuse lobes of surface shaders."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product

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

EDGES = (0.0, 1e-6, 1e-3, 1.0)  # special colors, and special roughness / maximum
# Colors and roughnesses of the pictures that represent a rough diffuse node.
PICTURE_INPUTS: tuple[Values, ...] = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5, "weight": 0.5},
)
COUNTS = Counts(nodes=16)  # the quadrature's error, 2e-8, is as small as roundings
LOSS_FIT = 2.7e-7  # relative error of the fit of FON's loss H: tools/fits

VALUE = sum_in(
    Quantity.DIFFERENCE,
    roundings(28, "(14, of numbers up to 2)"),
    Term(LOSS_FIT, "two fits of H, times a multiple-scattering part of at most 1/2"),
)
# The longest chain has 12 roundings, the cosine two, and the fit of H, times 0.29, two.
LARGE_NUMBERS = roundings(16 * 1.02, "of numbers up to 1.02, the fit of H among them")
ENVIRONMENT = sum_in(Quantity.ALBEDO, LARGE_NUMBERS)
# Two cosines of at least 1/4 have five roundings each, which count 4 times in s / t, 3 times in a
# sine, and twice elsewhere.
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
    """A node or lobe whose expected model is a rough diffuse model of `mxeon.models.table`."""

    requires = Ability.OWN  # library nodes override this

    counts: Counts = COUNTS
    flat: bool = True

    @property
    def drawn(self) -> tuple[Input, Input]:
        """The inputs. Rounding to float32 must not lift roughness above the model's maximum."""
        largest = reference.diffuse_model(self.model).largest
        most = np.float32(largest)
        high = float(most if most <= largest else np.nextafter(most, np.float32(0.0)))
        edges = tuple(high * each for each in EDGES)
        return color("color", edges=EDGES), Input("roughness", high=high, edges=edges)

    @property
    def materials(self) -> tuple[Values, ...]:
        names = {"color", "roughness", *self.names}
        rows = PICTURE_INPUTS
        return tuple({name: each[name] for name in each if name in names} for each in rows)

    def random_inputs(
        self, rng: np.random.Generator, count: int, edged: bool = False
    ) -> dict[str, Array]:
        """Random inputs. Unless `edged`, the last sixteenth of the colors is gray."""
        inputs = super().random_inputs(rng, count, edged)
        gray = slice(count if edged else count - count // 16, None)
        inputs["color"][gray] = inputs["color"][gray, :1]
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
    """The row of a node with its expected model. Its variants are all other known models."""
    known = others + reference.KNOWN_DEFECTS + reference.DIFFUSE_MODELS
    rows = {each.name: each for each in known}
    own = reference.diffuse_model(model)
    owners = {each.brdf_of: each.name for each in (*rows.values(), own)}
    variants = []
    for each in rows.values():
        most = each.largest
        value = _limited(each.value, most) if owners[each.brdf_of] == each.name else None
        albedo = _limited(each.albedo, most) if each.albedo_dir else None
        variants += [Variant(each.title, value, albedo)] * (each.name != model)
    return replace(own, category=node, variants=tuple(variants))


def _limited(function: Callable[..., Array], most: float) -> Callable[..., Array]:
    """A function of directions and inputs that limits the roughness to `most`."""
    return lambda *given: function(
        *given[:-1], {**given[-1], "roughness": np.minimum(given[-1]["roughness"], most)}
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class DiffuseSpec(DiffuseModelSpec):
    """A rough diffuse node with one value of its flag."""

    requires = Ability.DIFFUSE

    flag: bool | None  # energy_compensation, or None if the node has no such input


def _diffuse(node: str, flag: bool | None, model: str) -> DiffuseSpec:
    words = "" if flag is None else f", energy_compensation {str(flag).lower()}"
    return DiffuseSpec(
        title=node + words,
        node=node,
        model=model,
        row=model_row(model, node),
        flag=flag,
        inputs=INPUTS if flag is None else (*INPUTS, Input(FLAG, "boolean", change=not flag)),
        fixed={} if flag is None else {FLAG: flag},
        errors=ERRORS,
        along=0.1 if model == "qon" else 0.0,
    )


DIFFUSE = (
    _diffuse(OREN_NAYAR, True, "eon"),
    _diffuse(OREN_NAYAR, False, "qon"),
    _diffuse(EON, None, "eon"),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfaceLobe(DiffuseModelSpec):
    """The diffuse lobe of a surface shader whose other lobes cannot be disabled.

    The lobes above depend only on the directions, so two renders isolate the diffuse lobe. A black
    color shows the other lobes. White at roughness 0, Lambert in every model, shows the share of
    light that reaches the lobe and returns.
    """

    requires = Ability.BELOW
    coarse = 4  # the shaders are slow
    rim = LOBE_RIM  # position errors are divided twice

    ports: Mapping[str, str]  # rough diffuse node's input name -> shader's input name
    set_inputs: tuple[tuple[str, str, str], ...] = ()  # name, type and value of additional inputs

    def document(self, inputs: Values | None = None) -> str:
        types = {"color": "color3", "roughness": "float"}
        given = {name: port for name, port in self.ports.items() if name in (inputs or {})}
        values = [(port, types[name], (inputs or {})[name]) for name, port in given.items()]
        ports = "".join(input_text(*each) for each in (*values, *self.set_inputs))
        return document_text(node_text(self.node, "surfaceshader", "shading", ports))


# fmt: off
# Title, model, names of color and roughness, and additional inputs. OpenPBR specifies EON; Standard
# Surface, Oren-Nayar; USD Preview Surface and glTF, Lambert.
ROWS: tuple[tuple[str, str, tuple[str, ...], tuple[tuple[str, str, str], ...]], ...] = (
    ("open_pbr_surface", "eon", ("base_color", "base_diffuse_roughness"), ()),
    ("open_pbr_surface, thin-walled", "eon", ("subsurface_color", "base_diffuse_roughness"),
     (("geometry_thin_walled", "boolean", "true"), ("subsurface_weight", "float", "1.0"))),
    ("standard_surface", "qon", ("base_color", "diffuse_roughness"), (("base", "float", "1.0"),)),
    ("UsdPreviewSurface", "lambert", ("diffuseColor",), ()),
    ("gltf_pbr", "lambert", ("base_color",), (("metallic", "float", "0.0"),)),
)
# fmt: on
SURFACE_LOBES = tuple(
    SurfaceLobe(
        title=title,
        node=(node := title.split(",")[0]),
        model=model,
        row=model_row(model, node),
        ports=dict(zip(("color", "roughness"), ports, strict=False)),
        set_inputs=given,
        # Every library uses MaterialX's own thin-walled lobe, so judge it once.
        libraries=("stock",) if title != node else (),
        errors={"value": LOBE_VALUE},
    )
    for title, model, ports, given in ROWS
)
