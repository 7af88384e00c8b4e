# SPDX-License-Identifier: Apache-2.0
"""Specs of EDF nodes, nodes that combine EDFs, emitting surfaces, and VDF nodes."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from mxeon.conformance import samples, spec
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, Counts, Values, directions, float32, generator
from mxeon.conformance.spec import ARGUMENTS, Ability, EngineError, Input, color
from mxeon.conformance.tolerance import ROUNDING, Compared, roundings, sum_of
from mxeon.models.media import cone_cosine, cone_width, surface_radiance
from mxeon.models.nodes import emissions, media
from mxeon.models.nodes.media import Medium
from mxeon.shaders import nodes, scene


def title_of(row: emissions.Emission | Medium, kind: str) -> str:
    """Title of a row. It includes the type if nodes for several types share a name."""
    factor = f", in2 {row.name.rpartition('_')[2]}" if row.category == "multiply" else ""
    return f"{row.category}, {kind}{factor}" if "/" in next(iter(row.inputs)) else row.category


def inputs_of(row: emissions.Emission | Medium) -> tuple[Input, ...]:
    """The inputs of a row. The last word of the row's name is the type of its factor."""
    kind = row.name.rpartition("_")[2]
    return tuple(INPUTS.get(name) or FACTORS[name, kind] for name in row.inputs)


def chained(
    row: emissions.Emission | Medium, kind: str, source: str, name: str, text: str = ""
) -> dict[str, nodes.Node]:
    """A node, and the source nodes that are named in the paths of its inputs."""
    paths = (each.rpartition("/")[0] for each in row.inputs)
    sources = tuple(dict.fromkeys(path for path in paths if path not in ("", name)))
    own = {name: nodes.Node(row.category, kind, sources, text)}
    return dict.fromkeys(sources, nodes.Node(source, kind)) | own


EMITTED = nodes.connection_text("edf", "EDF", "emission")
EMITTING_TEXT = nodes.node_text("surface", "surfaceshader", "shading", EMITTED)
SURFACE_COLOR = (0.2, 0.5, 2.0)  # radiance that the surface emits
BLACK_LOBE = '  <oren_nayar_diffuse_bsdf name="lobe" type="BSDF" />\n'
LEAST_FALLOFF = 0.01  # least difference of the full angles, in degrees
LEAST_CONE = 1e-3  # least full angle of narrow cones, as a share of a turn
EXPONENTS = (0.5, 20.0)
BLUE, ORANGE = (0.2, 0.5, 0.8), (2.0, 0.4, 0.1)  # radiances of the materials in pictures
INNER, OUTER = "inner_angle", "outer_angle"
LEAST, LARGEST = 1e-3, 16.0  # coefficients in 1/m that remove 1e-3 and 1 - 1e-7 of the light
# For pictures, choose a falloff over half of the sphere, so that it is not steep.
INPUTS = {
    each.name: each
    for each in (
        *(
            replace(color(name, BLUE, ORANGE, edges=()), high=2.0)
            for name in ("color", emissions.BASE, emissions.FIRST)
        ),
        color(emissions.SECOND, (0.9, 0.1, 0.3), (0.1, 0.2, 0.3), edges=()),
        Input(emissions.AMOUNT, change=0.3, materials=(0.25, 0.75), default=0.5),
        color("color0", (0.1, 0.4, 0.9), (0.8, 0.5, 0.2), edges=()),
        color("color90", (0.9, 0.8, 0.6), (1.0, 1.0, 1.0), edges=()),
        Input("exponent", "float", *EXPONENTS, change=2.0, materials=(5.0, 2.0), default=5.0),
        Input(INNER, change=20.0, materials=(60.0, 0.0), default=60.0),
        Input(OUTER, change=150.0, materials=(140.0, 150.0), default=90.0),
        # Media from barely visible to nearly opaque.
        *(
            Input(name, "vector3", LEAST, LARGEST, change=spec.CHANGED_COLOR, logarithmic=True)
            for name in ("absorption", "scattering", media.FIRST, media.SECOND)
        ),
        Input(media.AMOUNT, change=0.3, default=0.5),
    )
}
NORMAL = Input("normal", "vector3", change=(0.0, 0.6, 0.8))
FACTORS = {
    (emissions.FACTOR, "float"): Input(emissions.FACTOR, change=0.3, materials=(0.9, 0.5)),
    (emissions.FACTOR, "color3"): color(emissions.FACTOR, (0.9, 0.6, 0.3), (0.5,) * 3, edges=()),
    (media.FACTOR, "float"): Input(media.FACTOR, high=3.0, change=0.3),
    (media.FACTOR, "color3"): replace(color(media.FACTOR, edges=()), high=3.0),
}

# Skip views whose cosine is closer to a hard edge, because an engine's rounding decides there.
EDGE = 1e-3
SMALL = scene.Scene("dark", size=8)
OPACITIES = (0.0, 0.25, 1.0)


# 1 - cos of both angles has ten roundings in all, and differences have two.
CONE_ROUNDINGS = 12
# Keys are names of rows.
# fmt: off
ERRORS = {
    "conical": sum_of(
        roundings(2 * CONE_ROUNDINGS, "relative to 1 and the slope, of colors up to 2"),
        quantity=Quantity.RADIANCE_SLOPE),
    "schlick_emission": sum_of(
        roundings(2 * 8), roundings(2 * EXPONENTS[1], "of a color of 2 to the power of 20"),
        quantity=Quantity.RADIANCE),
}
# fmt: on
UNIFORM = sum_of(roundings(6, "three of each emission and its factor"), quantity=Quantity.RADIANCE)
OPACITY = sum_of(roundings(3), quantity=Quantity.RADIANCE)


def _powers() -> tuple[Array, Array]:
    rng = generator()
    return float32(rng.random(ARGUMENTS)), float32(rng.uniform(*EXPONENTS, ARGUMENTS))


power_error = spec.POWER.error(_powers)


@dataclass(frozen=True, eq=False, kw_only=True)
class EmissionSpec(spec.RowSpec[emissions.Value]):
    """An EDF node, or a combination of EDFs: a row of `mxeon.models.nodes.emissions`."""

    requires = Ability.EMISSION
    coarse = 4  # all pixels of a view are equivalent

    row: emissions.Emission

    def document(self, inputs: Values | None = None) -> str:
        axis = turned = ""
        if "normal" in (inputs or {}):  # a normal must be connected: values are ignored
            axis = nodes.vector_text("axis", (inputs or {})["normal"])
            turned = nodes.connection_text("normal", "vector3", "axis")
        network = chained(self.row, "EDF", "uniform_edf", "emission", turned)
        text = axis + nodes.network_text(network, spec.ports(self.drawn, inputs)) + EMITTING_TEXT
        return nodes.document_text(text, "look")

    def values(self, function: emissions.Value, batch: Batch) -> Array:
        """Radiance, (N, 3); components of views are clipped to [-1, 1]."""
        return function(np.clip(batch.wo, -1.0, 1.0), spec.broadcast_inputs(batch))

    @property
    def others(self) -> tuple[samples.Candidate, ...]:
        return (spec.ZERO,)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views from the front, and a grid of cosines from 1 to grazing."""
        rng = generator()
        special = samples.directions_at(np.repeat(samples.GRID, 64), 0.0)
        return (self.views(rng, directions(rng, counts.pairs)), self.views(rng, special))

    def backs(self, counts: Counts) -> Batch:
        rng = generator()
        return self.views(rng, directions(rng, counts.few) * [1.0, 1.0, -1.0])

    def views(self, rng: samples.Rng, wo: Array) -> Batch:
        return Batch(wo, wo, self.random_inputs(rng, len(wo)))


class ConeSpec(EmissionSpec):
    """An emission inside a cone around an input axis."""

    def random_inputs(self, rng: samples.Rng, count: int) -> dict[str, Array]:
        """Half of the cones have a falloff of at least LEAST_FALLOFF degrees; a quarter are narrow.

        Some cones without a falloff have two equal angles.
        """
        inputs, turn = super().random_inputs(rng, count), rng.random(count)
        wide = rng.random(count) < 0.5
        inner = 360.0 * np.where(rng.random(count) < 0.25, LEAST_CONE**turn, turn)
        inner = np.where(wide, inner * (1.0 - LEAST_FALLOFF / 360.0), inner)
        more = LEAST_FALLOFF * ((360.0 - inner) / LEAST_FALLOFF) ** rng.random(count)
        outer = np.where(wide, inner + more, inner * np.minimum(1.2 * rng.random(count), 1.0))
        return inputs | {INNER: float32(inner), OUTER: float32(outer)}

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views, views in falloffs or close to edges of cones, and turned cones."""
        rng, count = generator(), counts.few
        inputs = self.random_inputs(rng, count)
        inputs[INNER][0] = inputs[OUTER][0] = 0.0  # this cone has one direction, the view
        angle = np.where(np.arange(count) % 2, inputs[INNER], inputs[OUTER])
        step = np.where(rng.random(count) < 0.5, -2.0, 2.0) * _edge(angle)
        mu, low = cone_cosine(angle) + step, cone_cosine(inputs[OUTER])
        falloff = low + rng.random(count) * (cone_cosine(inputs[INNER]) - low)
        soft = (inputs[OUTER] > inputs[INNER]) & (rng.random(count) < 0.5)
        wo = samples.directions_at(np.clip(np.where(soft, falloff, mu), 0.0, 1.0), 0.0)
        frames = samples.turned_frames(rng, count)
        view = samples.turned_directions(rng, len(frames))
        axes = self.random_inputs(rng, len(frames)) | {"normal": samples.float32(frames[:, :, 2])}
        near, turned = Batch(wo, wo, inputs), Batch(view, view, axes, frame=frames)
        return *super().batches(counts), _away(near), _away(turned)

    def alike(self, compared: Compared) -> Compared:
        """Divide errors by 1 + the falloff's largest slope within a rounding of the view."""
        batch = compared.batch
        inner, outer = (batch.inputs[name] for name in (INNER, OUTER))
        width = np.where(outer > inner, cone_width(inner, outer), np.inf)
        t = (np.maximum(batch.wo[:, 2], 0.0) - cone_cosine(outer)) / width
        reach = CONE_ROUNDINGS * ROUNDING / width
        t = np.clip(np.clip(0.5, t - reach, t + reach), 0.0, 1.0)
        return compared.over((1.0 + 6.0 * t * (1.0 - t) / width)[:, np.newaxis])

    def views(self, rng: samples.Rng, wo: Array) -> Batch:
        return _away(super().views(rng, wo))


def _away(batch: Batch) -> Batch:
    """Drop views that are close to the hard edge of a cone."""
    hard = batch.inputs[OUTER] <= batch.inputs[INNER]
    away = np.abs(np.maximum(batch.wo[:, 2], 0.0) - cone_cosine(batch.inputs[INNER]))
    return batch.where(~hard | (away >= _edge(batch.inputs[INNER])))


def _edge(angle: Array) -> Array:
    return np.minimum(EDGE, 0.5 * (1.0 - cone_cosine(angle)))


@dataclass(frozen=True, eq=False, kw_only=True)
class AbsentSpec(spec.Spec):
    """A node of which only the existence of an implementation is judged."""

    requires = Ability.IMPLEMENTATION

    text: str  # XML nodes of a document that uses it

    def document(self, inputs: Values | None = None) -> str:
        return nodes.document_text(self.text)


# A definition without any implementation, for a control.
UNIMPLEMENTED = AbsentSpec(
    title="a node without an implementation",
    node="mxeon_absent",
    text="""  <nodedef name="ND_mxeon_absent" node="mxeon_absent">
    <output name="out" type="EDF" />
  </nodedef>
"""
    + nodes.node_text("mxeon_absent", "EDF", "emission")
    + EMITTING_TEXT,
)
MEASURED = nodes.node_text("measured_edf", "EDF", "emission") + EMITTING_TEXT
ABSENT = (
    AbsentSpec(title="measured_edf", node="measured_edf", text=MEASURED, libraries=("stock",)),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class EmittingSurface(spec.ValueSpec):
    """The node `surface` with an emission and no light, in a picture for each of OPACITIES."""

    requires = Ability.SURFACE

    has_bsdf: bool

    def document(self, inputs: Values | None = None) -> str:
        color = nodes.input_text("color", "color3", SURFACE_COLOR)
        emission = nodes.node_text("uniform_edf", "EDF", "emission", color)
        lobe = nodes.connection_text("bsdf", "BSDF", "lobe") if self.has_bsdf else ""
        opacity = nodes.input_text("opacity", "float", (inputs or {}).get("opacity", 1.0))
        surface = nodes.node_text("surface", "surfaceshader", "shading", lobe + EMITTED + opacity)
        return nodes.document_text((BLACK_LOBE if self.has_bsdf else "") + emission + surface)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        points = scene.sphere(SMALL.size)
        wo = scene.local_directions(points.normal[points.mask], scene.VIEW)
        return tuple(Batch(wo, wo, {"opacity": np.array(each)}, SMALL) for each in OPACITIES)

    def value(self, batch: Batch) -> Array:
        radiance = surface_radiance(SURFACE_COLOR, (0.0, 0.0, 0.0), batch.inputs["opacity"])
        return np.broadcast_to(radiance, batch.wo.shape)


_emitting = partial(
    EmittingSurface, node="surface", errors={"value": OPACITY}, libraries=("stock",)
)
EMITTING_SURFACES = (
    _emitting(title="surface, an EDF alone", has_bsdf=False),
    _emitting(title="surface, a BSDF and an EDF", has_bsdf=True),
)


def _spec(row: emissions.Emission) -> EmissionSpec:
    drawn, cone = inputs_of(row), row.name == "conical"
    power = (EngineError("the engine's pow()", power_error),)
    return (ConeSpec if cone else EmissionSpec)(
        **spec.named(row, title_of(row, "EDF")),
        row=row,
        inputs=(*drawn, NORMAL) if cone else drawn,
        errors={"value": ERRORS.get(row.name, UNIFORM)},
        closure=not cone,
        counts=Counts(1 << 12, 1 << 10),
        evaluated=("emission", "radiance", 1.0),
        optional=True,
        engines={"value": power} if row.name == "schlick_emission" else {},
    )


EMISSION_SPECS = tuple(map(_spec, (*emissions.EMISSIONS, *emissions.COMBINED_EMISSIONS)))


# --- media: VDF nodes between two transmitting lobes ----------------------------------------------

# An exponential of a sum, a product, and a quotient of two such values have 12 roundings.
TRANSMITTANCE = sum_of(roundings(12), quantity=Quantity.TRANSMITTANCE)
TYPES = {"weight": "float", "scatter_mode": "string"}
TOP, BOTTOM = (
    nodes.lobe_text("dielectric_bsdf", {"weight": 1.0, "scatter_mode": "T"}, name, TYPES)
    for name in ("top", "bottom")
)


def layer_text(name: str, top: str, kind: str, base: str) -> str:
    ports = nodes.connection_text("top", "BSDF", top) + nodes.connection_text("base", kind, base)
    return nodes.node_text("layer", "BSDF", name, ports)


LAYERS = layer_text("filled", "top", "VDF", "medium") + layer_text(
    "lobe", "filled", "BSDF", "bottom"
)


@dataclass(frozen=True, eq=False, kw_only=True)
class MediumSpec(spec.RowSpec[media.Value]):
    """A VDF node, or a combination of VDFs: a row of `mxeon.models.nodes.media`."""

    requires = Ability.MEDIUM

    row: Medium

    def document(self, inputs: Values | None = None) -> str:
        network = chained(self.row, "VDF", "anisotropic_vdf", "medium")
        media = nodes.network_text(network, spec.ports(self.inputs, inputs))
        return nodes.document_text(TOP + media + BOTTOM + LAYERS + nodes.SURFACE)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views and inputs, without grazing views, for which refraction may fail."""
        rng, count = generator(), counts.pairs
        wo = samples.turned_directions(rng, count)
        return (Batch(wo, wo * [1.0, 1.0, -1.0], self.random_inputs(rng, count)),)

    def random_inputs(self, rng: samples.Rng, count: int) -> dict[str, Array]:
        inputs = spec.draw(rng, count, self.inputs)
        for each in self.inputs:
            if each.type == "vector3":
                inputs[each.name][::8] = 0.0
        return inputs

    def values(self, function: media.Value, batch: Batch) -> Array:
        return np.asarray(function(spec.broadcast_inputs(batch)))


exponential_error = spec.EXPONENTIAL.error(lambda: [float32(np.linspace(0.0, 8.0, ARGUMENTS))])
ENGINE = (
    EngineError("the engine's exp(), twice", exponential_error, 2.0),
    EngineError("the engine's pow(), twice", power_error, 2.0),
)
# A medium's anisotropy must not affect the transmittance.
ANISOTROPY = Input("anisotropy", low=-0.9, high=0.9, default=0.5)


def _medium_spec(row: Medium) -> MediumSpec:
    inputs, combined = inputs_of(row), row in media.COMBINED_MEDIA
    return MediumSpec(
        **spec.named(row, title_of(row, "VDF")),
        row=row,
        inputs=(*inputs, ANISOTROPY) if row.category == "anisotropic_vdf" else inputs,
        errors={"value": TRANSMITTANCE},
        counts=Counts(1 << 8),
        fixed={"top/weight": 0.0, "bottom/weight": 0.0},
        evaluated=("transmission", "throughput", 1.0),
        optional=True,
        engines={"value": ENGINE if combined else ENGINE[:1]},
    )


MEDIUM_SPECS = tuple(map(_medium_spec, (*media.MEDIA, *media.COMBINED_MEDIA)))
