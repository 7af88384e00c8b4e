# SPDX-License-Identifier: Apache-2.0
"""The EDF nodes, those that combine EDFs, and surfaces that emit: views from the front and the back; the VDF nodes."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from mxeon.conformance.samples import (
    GRID,
    Array,
    Batch,
    Candidate,
    Counts,
    Values,
    directions,
    float32,
    generator,
    rounded,
    turned_directions,
    turned_frames,
)
from mxeon.conformance.spec import (
    ARGUMENTS,
    COMPONENTS,
    EXPONENTIAL,
    POWER,
    ZERO,
    Input,
    RowSpec,
    Spec,
    ValueSpec,
    beside_rounding,
    broadcast_inputs,
    color,
    draw,
    materials,
)
from mxeon.conformance.tolerance import Term, Tolerance, roundings, sum_of
from mxeon.hosts.base import Host
from mxeon.models.media import cone_cosine, cone_width, surface_radiance
from mxeon.models.nodes.emissions import (
    AMOUNT,
    BASE,
    COMBINED_EMISSIONS,
    EMISSIONS,
    FACTOR,
    FIRST,
    SECOND,
    Emission,
    Value,
)
from mxeon.models.nodes.media import AMOUNT as MEDIUM_AMOUNT
from mxeon.models.nodes.media import COMBINED_MEDIA, MEDIA, Medium
from mxeon.models.nodes.media import FACTOR as MEDIUM_FACTOR
from mxeon.models.nodes.media import Value as Transmittance
from mxeon.shaders.nodes import (
    SURFACE,
    connection_text,
    document_text,
    input_text,
    lobe_text,
    node_text,
    vector_text,
)
from mxeon.shaders.scene import VIEW, Scene, local_directions, sphere

SOURCES = {  # names of the nodes that a node takes, by its port
    "generalized_schlick_edf": {"base": "base"},
    "mix": {"fg": "first", "bg": "second"},
    "add": {"in1": "first", "in2": "second"},
    "multiply": {"in1": "first"},
}


def network_text(
    kind: str,
    category: str,
    name: str,
    source: str,
    inputs: Iterable[Input],
    values: Values,
    more: str = "",
) -> str:
    """XML of a node, with `more` of its ports, and of the sources that it takes: a value of each input, by path."""
    sources = SOURCES.get(category, {})
    ports = dict.fromkeys((*sources.values(), name), "")
    for each in inputs:
        node, _, port = each.name.rpartition("/")
        value = np.broadcast_to(values[each.name], COMPONENTS[each.type])
        ports[node or name] += input_text(port, each.type, value)
    ports[name] += more + "".join(
        connection_text(port, kind, each) for port, each in sources.items()
    )
    texts = [node_text(source, kind, each, ports[each]) for each in sources.values()]
    return "".join(texts) + node_text(category, kind, name, ports[name])


def title_of(row: Emission | Medium, kind: str, inputs: Sequence[Input]) -> str:
    """A node that combines others has its name in common with those of other types."""
    scaled = f", in2 {inputs[-1].type}" if row.category == "multiply" else ""
    return (
        f"{row.category}, {kind}{scaled}"
        if row in (*COMBINED_EMISSIONS, *COMBINED_MEDIA)
        else row.category
    )


EMITTED = connection_text("edf", "EDF", "emission")
EMITTING_TEXT = node_text("surface", "surfaceshader", "shading", EMITTED)
SURFACE_COLOR = (0.2, 0.5, 2.0)  # radiance of a surface
BLACK_LOBE = '  <oren_nayar_diffuse_bsdf name="lobe" type="BSDF" />\n'
LEAST_FALLOFF = 1.0  # degrees of full angle between the cones
LEAST_CONE = 1e-3  # least share of a full turn
EXPONENTS = (0.5, 20.0)
BLUE, ORANGE = (0.2, 0.5, 0.8), (2.0, 0.4, 0.1)  # radiances of the materials in pictures
INNER, OUTER = "inner_angle", "outer_angle"
# In pictures the falloff takes half of the sphere, so that it is not steep.
INPUTS = {
    each.name: each
    for each in (
        *(color(name, BLUE, ORANGE, edges=()) for name in ("color", BASE, FIRST)),
        color(SECOND, (0.9, 0.1, 0.3), (0.1, 0.2, 0.3), edges=()),
        Input(AMOUNT, change=0.3, materials=(0.25, 0.75), default=0.5),
        color("color0", (0.1, 0.4, 0.9), (0.8, 0.5, 0.2), edges=()),
        color("color90", (0.9, 0.8, 0.6), (1.0, 1.0, 1.0), edges=()),
        Input("exponent", "float", *EXPONENTS, change=2.0, materials=(5.0, 2.0), default=5.0),
        Input(INNER, change=20.0, materials=(60.0, 0.0), default=60.0),
        Input(OUTER, change=150.0, materials=(140.0, 150.0), default=90.0),
        Input("normal", "vector3", change=(0.0, 0.6, 0.8)),
    )
}
FACTORS = {  # of an emission, by the last word of the row's name
    "float": Input(FACTOR, change=0.3, materials=(0.9, 0.5)),
    "color3": color(FACTOR, (0.9, 0.6, 0.3), (0.5, 0.5, 0.5), edges=()),
}

UNIT, EXITANCE = "radiance", "exitance / pi"
# Cosine from a hard edge within which the engine's own cosine decides; of narrow cones, half of 1 - cos.
EDGE = 1e-3
SMALL = Scene("dark", size=8)
OPACITIES = (0.0, 0.25, 1.0)


def _errors(radiance: Tolerance, *exitance: Term) -> dict[str, Tolerance]:
    terms = exitance or (
        radiance.term("an average of radiances"),
        Term(1e-6, "the quadrature on the equations"),
    )
    return {"value": radiance, "integral": sum_of(*terms, unit=EXITANCE)}


UNIFORM = _errors(sum_of(roundings(6, "three of each emission and its factor"), unit=UNIT))
POWER_ERRORS = _errors(
    sum_of(roundings(8), roundings(EXPONENTS[1], "to the power of 20"), unit=UNIT)
)
# Ten roundings of 1 - cos of both angles, of which a view takes 1 - mu in all, and two of differences,
# relative to 1 and the slope of the falloff; in an average ten of an angle shift the falloff at a slope 1/2.
CONE = _errors(
    sum_of(roundings(12, "relative to 1 and the slope"), unit="radiance and its slope"),
    roundings(8, "of an average of radiances"),
    roundings(5, "of a cone's cosine, ten times 1/2"),
    Term(3e-8, "the quadrature on the equations"),
)
OPACITY = sum_of(roundings(3), unit=UNIT)


@lru_cache(maxsize=16)
def power_error(host: Host) -> float:
    """Error of the engine's own power of numbers in [0, 1], beside its rounding."""
    rng = generator()
    base, exponent = float32(rng.random(ARGUMENTS)), float32(rng.uniform(*EXPONENTS, ARGUMENTS))
    return beside_rounding(POWER.errors(host, base, exponent))


@dataclass(frozen=True, eq=False, kw_only=True)
class EmissionSpec(RowSpec):
    """A row of `mxeon.models.nodes.emissions`."""

    row: Emission

    @property
    def materials(self) -> tuple[Values, ...]:
        return materials(*self.drawn)

    def document(self, inputs: Values | None = None) -> str:
        """A material of the node and of those that it takes, with a value of each input."""
        values = {each.name: each.default for each in self.drawn} | dict(inputs or {})
        axis = vector_text("axis", values.pop("normal")) if "normal" in values else ""
        turned = connection_text("normal", "vector3", "axis") if axis else ""  # a value is ignored
        typed = [each for each in self.drawn if each.name in values]
        text = network_text("EDF", self.node, "emission", "uniform_edf", typed, values, turned)
        return document_text(axis + text + EMITTING_TEXT, "look")

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return draw(rng, count, self.drawn)

    def values(self, function: Value, batch: Batch) -> Array:
        """Radiance, (N, 3), of views whose cosines do not exceed 1 by a rounding."""
        return function(np.clip(batch.wo, -1.0, 1.0), broadcast_inputs(batch))

    def exitance(self, batch: Batch) -> Array:
        return self.row.exitance(broadcast_inputs(batch))

    @property
    def others(self) -> tuple[Candidate, ...]:
        return (ZERO,)

    def engine(self, quantity: str, host: Host) -> tuple[Term, ...]:
        if self.row.name != "schlick_emission" or quantity not in ("value", "integral"):
            return ()
        return (Term(power_error(host), "the engine's pow()"),)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views from the front, and cosines from 1 to grazing."""
        rng = generator()
        mu = np.repeat(GRID, 64)
        radius = np.sqrt(1.0 - mu * mu)
        special = rounded([radius, 0.0 * mu, mu])
        return (self.views(rng, directions(rng, counts.pairs)), self.views(rng, special))

    def few(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        return (batches[0].first(counts.few),)

    def backs(self, counts: Counts) -> Batch:
        """Views from the back."""
        rng = generator()
        return self.views(rng, directions(rng, counts.few) * [1.0, 1.0, -1.0])

    def integrated(self, counts: Counts) -> tuple[Batch, Array]:
        """Emissions at the nodes of a quadrature, and weights of their radiance.

        The weighted sum over the views of a material is its exitance over pi.
        """
        rng, count = generator(), counts.materials
        inputs = self.random_inputs(rng, count)
        mu, weights = _nodes(self._stops(inputs), counts.nodes)
        azimuth = 2.0 * np.pi * rng.random(mu.shape)
        radius = np.sqrt(1.0 - mu * mu)
        wo = rounded([radius * np.cos(azimuth), radius * np.sin(azimuth), mu]).reshape(-1, 3)
        each = np.repeat(np.arange(count), mu.shape[1])
        return Batch(wo, wo, {name: value[each] for name, value in inputs.items()}), weights

    def views(self, rng: np.random.Generator, wo: Array) -> Batch:
        return Batch(wo, wo, self.random_inputs(rng, len(wo)))

    def _stops(self, inputs: dict[str, Array]) -> Array:
        """Cosines between which the radiance is smooth, (M, 1 + pieces)."""
        return np.broadcast_to([0.0, 1.0], (len(next(iter(inputs.values()))), 2))


class ConeSpec(EmissionSpec):
    """An emission inside a cone, whose axis is an input."""

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return super().random_inputs(rng, count) | random_cones(rng, count)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Those of any emission; views near both edges; and views of turned axes."""
        rng = generator()
        return (
            *super().batches(counts),
            self._at_edges(rng, counts.few),
            self._turned(rng, counts.few),
        )

    def condition(self, batch: Batch) -> Array:
        """1 and the slope of the falloff in the cosine, (N, 1)."""
        inner, outer = (batch.inputs[name] for name in (INNER, OUTER))
        width = np.where(outer > inner, cone_width(inner, outer), np.inf)
        t = np.clip((np.maximum(batch.wo[:, 2], 0.0) - cone_cosine(outer)) / width, 0.0, 1.0)
        return np.asarray(1.0 + 6.0 * t * (1.0 - t) / width)[:, np.newaxis]

    def views(self, rng: np.random.Generator, wo: Array) -> Batch:
        return _away(super().views(rng, wo))

    def _at_edges(self, rng: np.random.Generator, count: int) -> Batch:
        """Views a little inside and outside of the cones."""
        inputs = self.random_inputs(rng, count)
        angle = np.where(np.arange(count) % 2, inputs[INNER], inputs[OUTER])
        step = np.where(rng.random(count) < 0.5, -2.0, 2.0) * _edge(angle)
        mu = np.clip(cone_cosine(angle) + step, 0.0, 1.0)
        wo = rounded([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu])
        return _away(Batch(wo, wo, inputs))

    def _turned(self, rng: np.random.Generator, count: int) -> Batch:
        """Views in frames whose normals are the axes."""
        frames = turned_frames(rng, count)
        wo = turned_directions(rng, len(frames))
        inputs = self.random_inputs(rng, len(frames))
        inputs["normal"] = rounded(frames[:, :, 2].T)
        return _away(Batch(wo, wo, inputs, frame=frames))

    def _stops(self, inputs: dict[str, Array]) -> Array:
        inner, outer = (np.clip(cone_cosine(inputs[name]), 0.0, 1.0) for name in (INNER, OUTER))
        ends = np.zeros((len(inner), 2)) + [0.0, 1.0]
        return np.sort(np.column_stack([ends, inner, np.minimum(inner, outer)]), axis=1)


def _away(batch: Batch) -> Batch:
    """Views of a batch that are not at the hard edge of a cone."""
    hard = batch.inputs[OUTER] <= batch.inputs[INNER]
    away = np.abs(np.maximum(batch.wo[:, 2], 0.0) - cone_cosine(batch.inputs[INNER]))
    return batch.where(~hard | (away >= _edge(batch.inputs[INNER])))


def _edge(angle: Array) -> Array:
    return np.minimum(EDGE, 0.5 * (1.0 - cone_cosine(angle)))


def _nodes(stops: Array, count: int) -> tuple[Array, Array]:
    """Cosines and weights, (M, K), of integrals of 2 mu over the pieces between stops."""
    x, w = np.polynomial.legendre.leggauss(count)
    low, high = stops[:, :-1, np.newaxis], stops[:, 1:, np.newaxis]
    t = 0.5 * (x + 1.0)  # high - mu = t^2 (high - low): dense at the upper end, where powers root
    mu = high - t * t * (high - low)
    mu = float32(mu)
    weights = 2.0 * mu * (high - low) * w * t
    return mu.reshape(len(stops), -1), weights.reshape(len(stops), -1)


def random_cones(rng: np.random.Generator, count: int) -> dict[str, Array]:
    """Angles of cones: half of them with a falloff, of at least LEAST_FALLOFF degrees; a quarter narrow ones."""
    turn, wide = rng.random(count), rng.random(count) < 0.5
    inner = 360.0 * np.where(rng.random(count) < 0.25, LEAST_CONE**turn, turn)
    inner = np.where(wide, inner * (1.0 - LEAST_FALLOFF / 360.0), inner)
    more = LEAST_FALLOFF * ((360.0 - inner) / LEAST_FALLOFF) ** rng.random(count)
    outer = np.where(wide, inner + more, inner * rng.random(count))
    angles = rounded([inner, outer])
    return {INNER: angles[:, 0], OUTER: angles[:, 1]}


@dataclass(frozen=True, eq=False, kw_only=True)
class AbsentSpec(Spec):
    """A node that no library of ours has: only its implementation is judged."""

    text: str  # XML of a document's nodes that use it

    def document(self, inputs: Values | None = None) -> str:
        return document_text(self.text)


def _absent(title: str, node: str, text: str) -> AbsentSpec:
    return AbsentSpec(title=title, node=node, model="", text=text, libraries=("stock",))


# A node that its document defines, without an implementation: a surface that is not lit.
UNIMPLEMENTED = _absent(
    "a node without an implementation",
    "mxeon_absent",
    """  <nodedef name="ND_mxeon_absent" node="mxeon_absent">
    <output name="out" type="EDF" />
  </nodedef>
"""
    + node_text("mxeon_absent", "EDF", "emission")
    + EMITTING_TEXT,
)
ABSENT = (
    _absent(
        "measured_edf", "measured_edf", node_text("measured_edf", "EDF", "emission") + EMITTING_TEXT
    ),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class EmittingSurface(ValueSpec):
    """The node `surface` with an emission, in the dark, one picture for each of OPACITIES."""

    has_bsdf: bool

    def document(self, inputs: Values | None = None) -> str:
        emission = node_text(
            "uniform_edf", "EDF", "emission", input_text("color", "color3", SURFACE_COLOR)
        )
        lobe = connection_text("bsdf", "BSDF", "lobe") if self.has_bsdf else ""
        opacity = input_text("opacity", "float", (inputs or {}).get("opacity", 1.0))
        surface = node_text("surface", "surfaceshader", "shading", lobe + EMITTED + opacity)
        return document_text((BLACK_LOBE if self.has_bsdf else "") + emission + surface)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        points = sphere(SMALL.size)
        wo = local_directions(points.normal[points.mask], VIEW)
        return tuple(Batch(wo, wo, {"opacity": each}, SMALL) for each in OPACITIES)

    def value(self, batch: Batch) -> Array:
        radiance = surface_radiance(SURFACE_COLOR, (0.0, 0.0, 0.0), batch.inputs["opacity"])
        return np.broadcast_to(radiance, batch.wo.shape)


EMITTING_SURFACES = tuple(
    EmittingSurface(
        title=title,
        node="surface",
        model="",
        has_bsdf=has_bsdf,
        errors={"value": OPACITY},
        libraries=("stock",),
    )
    for title, has_bsdf in (("surface, an EDF alone", False), ("surface, a BSDF and an EDF", True))
)


def _spec(row: Emission) -> EmissionSpec:
    inputs = INPUTS | {FACTOR: FACTORS.get(row.name.rsplit("_", 1)[-1], FACTORS["float"])}
    drawn = tuple(inputs[name] for name in row.inputs)
    cone = row.name == "conical"
    powered = {"conical": CONE, "schlick_emission": POWER_ERRORS}
    return (ConeSpec if cone else EmissionSpec)(
        title=title_of(row, "EDF", drawn),
        node=row.category,
        model=row.name,
        row=row,
        inputs=(*drawn, INPUTS["normal"]) if cone else drawn,
        errors=powered.get(row.name, UNIFORM),
        closure=not cone,
        counts=Counts(1 << 12, 1 << 10, materials=128, nodes=16),
        asked=("emission", "radiance", 1.0),
        optional=True,
    )


EMISSION_SPECS = tuple(map(_spec, (*EMISSIONS, *COMBINED_EMISSIONS)))


# --- media: the VDF nodes, below a surface that lets light through --------------------------------

# Of the exponential of a rounded sum, of a product and of the quotient of two such values.
TRANSMITTANCE = sum_of(roundings(12), unit="transmittance")
LEAST, LARGEST = 1e-3, 16.0  # coefficients, 1/m: of 1e-3 and 1 - 1e-7 of the light
LARGEST_FACTOR = 3.0  # of a multiple
INTERFACE = lobe_text(
    "dielectric_bsdf",
    {"weight": 1.0, "scatter_mode": "T"},
    "top",
    {"weight": "float", "scatter_mode": "string"},
)
PORTS = connection_text("top", "BSDF", "top") + connection_text("base", "VDF", "medium")


@dataclass(frozen=True, eq=False, kw_only=True)
class MediumSpec(RowSpec):
    """A row of `mxeon.models.nodes.media`."""

    row: Medium

    @property
    def combined(self) -> bool:
        return self.row in COMBINED_MEDIA

    def document(self, inputs: Values | None = None) -> str:
        halves = {each.name: 0.5 for each in self.inputs}
        media = network_text("VDF", self.node, "medium", "anisotropic_vdf", self.inputs, halves)
        return document_text(
            INTERFACE + media + node_text("layer", "BSDF", "lobe", PORTS) + SURFACE
        )

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views, none at grazing where refraction may fail instead, and random inputs of the node."""
        rng, count = generator(), counts.pairs
        wo = turned_directions(rng, count)
        return (Batch(wo, wo * [1.0, 1.0, -1.0], self.random_inputs(rng, count)),)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random coefficients, an eighth of them 0, shares and factors.

        The text gives the anisotropy of a medium no part in what passes.
        """
        inputs = draw(rng, count, self.inputs)
        for each in self.inputs:
            if each.type == "vector3":
                inputs[each.name][::8] = 0.0
        if not self.combined and len(self.inputs) > 1:
            inputs |= draw(rng, count, [Input("anisotropy", low=-0.9, high=0.9)])
        return inputs

    def values(self, function: Transmittance, batch: Batch) -> Array:
        return np.asarray(function(broadcast_inputs(batch)))

    def engine(self, quantity: str, host: Host) -> tuple[Term, ...]:
        if quantity != "value":
            return ()
        error = 2.0 * exponential_error(host) + self.combined * 2.0 * power_error(host)
        return (Term(error, "the engine's exp() and pow(), twice"),)


@lru_cache(maxsize=16)
def exponential_error(host: Host) -> float:
    """Error of the engine's own exp(-x) for x in [0, 8], beside its rounding."""
    return beside_rounding(EXPONENTIAL.errors(host, float32(np.linspace(0.0, 8.0, ARGUMENTS))))


def _medium_inputs(row: Medium) -> tuple[Input, ...]:
    """The inputs that its transmittance depends on, by path."""
    factor = (
        replace(color(MEDIUM_FACTOR, edges=()), high=LARGEST_FACTOR)
        if row.name.endswith("_color3")
        else Input(MEDIUM_FACTOR, high=LARGEST_FACTOR, change=0.3)
    )
    others = {MEDIUM_AMOUNT: Input(MEDIUM_AMOUNT, change=0.3), MEDIUM_FACTOR: factor}
    # A coefficient: from one that hardly shows to one that hides nearly all.
    usual = Input("", "vector3", LEAST, LARGEST, change=(0.9, 0.1, 0.6), logarithmic=True)
    return tuple(others.get(name, replace(usual, name=name)) for name in row.inputs)


def _medium_spec(row: Medium) -> MediumSpec:
    inputs = _medium_inputs(row)
    return MediumSpec(
        title=title_of(row, "VDF", inputs),
        node=row.category,
        model=row.name,
        row=row,
        inputs=inputs,
        errors={"value": TRANSMITTANCE},
        counts=Counts(1 << 8),
        fixed={"top/weight": 0.0},
        asked=("transmission", "throughput", 1.0),
        optional=True,
    )


MEDIUM_SPECS = tuple(map(_medium_spec, (*MEDIA, *COMBINED_MEDIA)))
