# SPDX-License-Identifier: Apache-2.0
"""Specs of nodes that emit light (EDFs), emitting surfaces, and nodes of media (VDFs)."""

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
    """Title of a row, with types if MaterialX has the category for several types."""
    if "/" not in next(iter(row.inputs)):  # a node that combines no other nodes
        return row.category
    factor = f", in2 {row.name.rpartition('_')[2]}" if row.category == "multiply" else ""
    return f"{row.category}, {kind}{factor}"


def inputs_of(row: emissions.Emission | Medium) -> tuple[Input, ...]:
    kind = row.name.rpartition("_")[2]  # type of the factor by which a node `multiply` scales
    return tuple(INPUTS.get(name) or FACTORS[name, kind] for name in row.inputs)


def chained(
    row: emissions.Emission | Medium, kind: str, source: str, name: str, text: str = ""
) -> dict[str, nodes.Node]:
    """The row's node, called `name`, which may combine nodes of category `source`.

    An input whose path contains the name of a node belongs to that node.
    """
    paths = (each.rpartition("/")[0] for each in row.inputs)
    sources = tuple(dict.fromkeys(path for path in paths if path not in ("", name)))
    combined = dict.fromkeys(sources, nodes.Node(source, kind))
    return {**combined, name: nodes.Node(row.category, kind, sources, text)}


EMITTED = nodes.connection_text("edf", "EDF", "emission")
EMITTING_TEXT = nodes.node_text("surface", "surfaceshader", "shading", EMITTED)
SURFACE_COLOR = (0.2, 0.5, 2.0)  # radiance of the emitting surface
LEAST_FALLOFF = 0.01  # smallest difference between a cone's outer and inner angle, in degrees
LEAST_CONE = 1e-3  # smallest full angle of a narrow cone, as a share of 360 degrees
EXPONENTS = (0.5, 20.0)
INNER, OUTER = "inner_angle", "outer_angle"
# Coefficients of media in 1/m. Over one meter, a medium with the smallest coefficient takes 0.1 %
# of the light, and a medium with the largest coefficient leaves 1e-7 of the light.
LEAST, LARGEST = 1e-3, 16.0
INPUTS = {
    each.name: each
    for each in (
        *(
            replace(color(name, (0.2, 0.5, 0.8), (2.0, 0.4, 0.1), edges=()), high=2.0)
            for name in ("color", emissions.BASE, emissions.FIRST)
        ),
        color(emissions.SECOND, (0.9, 0.1, 0.3), (0.1, 0.2, 0.3), edges=()),
        Input(emissions.AMOUNT, change=0.3, materials=(0.25, 0.75), default=0.5),
        color("color0", (0.1, 0.4, 0.9), (0.8, 0.5, 0.2), edges=()),
        color("color90", (0.9, 0.8, 0.6), (1.0, 1.0, 1.0), edges=()),
        Input("exponent", "float", *EXPONENTS, change=2.0, materials=(5.0, 2.0), default=5.0),
        # In pictures, a cone's falloff extends over half of the sphere, so that no edge is steep.
        Input(INNER, change=20.0, materials=(60.0, 0.0), default=60.0),
        Input(OUTER, change=150.0, materials=(140.0, 150.0), default=90.0),
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

# Smallest difference between the cosines of a view and of a cone without falloff. For a smaller
# difference, roundings decide whether the view is inside the cone.
EDGE = 1e-3
SMALL = scene.Scene("dark", size=8)
OPACITIES = (0.0, 0.25, 1.0)


# A cone's two cosines have ten roundings in all, and two differences of cosines have two more.
CONE_ROUNDINGS = 12
# Tolerances of some rows, by name. All other rows have the tolerance UNIFORM.
# fmt: off
ERRORS = {
    "conical": sum_of(
        roundings(2 * CONE_ROUNDINGS, "of colors up to 2, relative to 1 + the slope"),
        quantity=Quantity.RADIANCE_SLOPE),
    "schlick_emission": sum_of(
        roundings(2 * 8), roundings(2 * EXPONENTS[1], "of a color of 2 to the power of 20"),
        quantity=Quantity.RADIANCE),
}
# fmt: on
UNIFORM = sum_of(roundings(6, "(three per emission and its factor)"), quantity=Quantity.RADIANCE)
OPACITY = sum_of(roundings(3), quantity=Quantity.RADIANCE)


def _powers() -> tuple[Array, Array]:
    rng = generator()
    return float32(rng.random(ARGUMENTS)), float32(rng.uniform(*EXPONENTS, ARGUMENTS))


power_error = spec.POWER.error(_powers)


@dataclass(frozen=True, eq=False, kw_only=True)
class EmissionSpec(spec.RowSpec[emissions.Value]):
    """An EDF node, or a node that combines EDFs, with the equation of `row`."""

    requires = Ability.EMISSION
    coarse = 4  # radiance depends only on the view's cosine, so few pixels are enough

    row: emissions.Emission

    def document(self, inputs: Values | None = None) -> str:
        axis = connection = ""
        if "normal" in (inputs or {}):  # MaterialX ignores a normal that is not connected
            axis = nodes.vector_text("axis", (inputs or {})["normal"])
            connection = nodes.connection_text("normal", "vector3", "axis")
        network = chained(self.row, "EDF", "uniform_edf", "emission", connection)
        text = nodes.network_text(network, spec.ports(self.drawn, inputs))
        return nodes.document_text(axis + text + EMITTING_TEXT)

    def values(self, function: emissions.Value, batch: Batch) -> Array:
        """Radiance toward each view, (N, 3). Rounding may make components of a view exceed 1, so views are clipped."""
        return function(np.clip(batch.wo, -1.0, 1.0), spec.broadcast_inputs(batch))

    @property
    def others(self) -> tuple[samples.Candidate, ...]:
        return (spec.ZERO,)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views from the front, and views at the fixed cosines `samples.GRID`."""
        rng = generator()
        special = samples.directions_at(np.repeat(samples.GRID, 64), 0.0)
        return (self.views(rng, directions(rng, counts.pairs)), self.views(rng, special))

    def backs(self, counts: Counts) -> Batch:
        rng = generator()
        return self.views(rng, directions(rng, counts.few) * [1.0, 1.0, -1.0])

    def views(self, rng: samples.Rng, wo: Array) -> Batch:
        return Batch(wo, wo, self.random_inputs(rng, len(wo)))


class ConeSpec(EmissionSpec):
    """A node that emits light inside a cone around the input `normal`."""

    def random_inputs(self, rng: samples.Rng, count: int) -> dict[str, Array]:
        """Random inputs: half of the cones have a falloff, and a quarter are narrow.

        A cone without a falloff has an outer angle of at most the inner angle.
        """
        inputs, turn = super().random_inputs(rng, count), rng.random(count)
        soft = rng.random(count) < 0.5
        inner = 360.0 * np.where(rng.random(count) < 0.25, LEAST_CONE**turn, turn)
        inner = np.where(soft, inner * (1.0 - LEAST_FALLOFF / 360.0), inner)
        falloff = LEAST_FALLOFF * ((360.0 - inner) / LEAST_FALLOFF) ** rng.random(count)
        outer = np.where(soft, inner + falloff, inner * np.minimum(1.2 * rng.random(count), 1.0))
        return inputs | {INNER: float32(inner), OUTER: float32(outer)}

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views, views in the falloff or close to the edge of a cone, and rotated cones."""
        rng, count = generator(), counts.few
        inputs = self.random_inputs(rng, count)
        inputs[INNER][0] = inputs[OUTER][0] = 0.0  # a cone that contains only its axis
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
        return *super().batches(counts), _without_edges(near), _without_edges(turned)

    def rescaled(self, compared: Compared) -> Compared:
        """Divide values by 1 + s, where s is the falloff's largest slope near the view's cosine.

        Near means at a distance of at most CONE_ROUNDINGS roundings.
        """
        batch = compared.batch
        inner, outer = (batch.inputs[name] for name in (INNER, OUTER))
        width = np.where(outer > inner, cone_width(inner, outer), np.inf)
        t = (np.maximum(batch.wo[:, 2], 0.0) - cone_cosine(outer)) / width
        reach = CONE_ROUNDINGS * ROUNDING / width
        t = np.clip(np.clip(0.5, t - reach, t + reach), 0.0, 1.0)
        return compared.over((1.0 + 6.0 * t * (1.0 - t) / width)[:, np.newaxis])

    def views(self, rng: samples.Rng, wo: Array) -> Batch:
        return _without_edges(super().views(rng, wo))


def _without_edges(batch: Batch) -> Batch:
    """The batch without views that are close to the edge of a cone without falloff."""
    hard = batch.inputs[OUTER] <= batch.inputs[INNER]
    away = np.abs(np.maximum(batch.wo[:, 2], 0.0) - cone_cosine(batch.inputs[INNER]))
    return batch.where(~hard | (away >= _edge(batch.inputs[INNER])))


def _edge(angle: Array) -> Array:
    return np.minimum(EDGE, 0.5 * (1.0 - cone_cosine(angle)))


@dataclass(frozen=True, eq=False, kw_only=True)
class AbsentSpec(spec.Spec):
    """A node without a model. Only the existence of an implementation is judged."""

    requires = Ability.IMPLEMENTATION

    text: str  # XML of the node, and of the surface that uses the node

    def document(self, inputs: Values | None = None) -> str:
        return nodes.document_text(self.text)


# The check of implementations must fail for this node, which has no implementation.
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
        text = nodes.node_text("uniform_edf", "EDF", "emission", color)
        ports = EMITTED + nodes.input_text("opacity", "float", (inputs or {}).get("opacity", 1.0))
        if self.has_bsdf:
            text += nodes.node_text(nodes.OREN_NAYAR, "BSDF", "lobe")  # an unlit lobe is black
            ports += nodes.connection_text("bsdf", "BSDF", "lobe")
        return nodes.document_text(
            text + nodes.node_text("surface", "surfaceshader", "shading", ports)
        )

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


POWER = {"value": (EngineError("the engine's pow()", power_error),)}
EMISSION_SPECS = tuple(
    (ConeSpec if row.name == "conical" else EmissionSpec)(
        **spec.named(row, title_of(row, "EDF")),
        row=row,
        inputs=inputs_of(row) + ((NORMAL,) if row.name == "conical" else ()),
        errors={"value": ERRORS.get(row.name, UNIFORM)},
        closure=row.name != "conical",
        counts=Counts(1 << 12, 1 << 10),
        evaluated=("emission", "radiance", 1.0),
        optional=True,
        engines=POWER if row.name == "schlick_emission" else {},
    )
    for row in (*emissions.EMISSIONS, *emissions.COMBINED_EMISSIONS)
)


# --- media: VDF nodes between two transmitting lobes ----------------------------------------------

# A transmittance has 12 roundings, in a sum, an exponential, a product and a quotient.
TRANSMITTANCE = sum_of(roundings(12), quantity=Quantity.TRANSMITTANCE)
GLASS = nodes.Node(
    "dielectric_bsdf",
    "BSDF",
    text=nodes.input_text("weight", "float", 1.0) + nodes.input_text("scatter_mode", "string", "T"),
)
MEDIUM = nodes.connection_text("base", "VDF", "medium")
SLAB = {
    **dict.fromkeys(("top", "bottom"), GLASS),
    "filled": nodes.Node("layer", "BSDF", ("top",), MEDIUM),
    "lobe": nodes.Node("layer", "BSDF", ("filled", "bottom")),
}


@dataclass(frozen=True, eq=False, kw_only=True)
class MediumSpec(spec.RowSpec[media.Value]):
    """A VDF node, or a node that combines VDFs, with the equation of `row`."""

    requires = Ability.MEDIUM

    row: Medium

    def document(self, inputs: Values | None = None) -> str:
        network = chained(self.row, "VDF", "anisotropic_vdf", "medium")
        media = nodes.network_text(network, spec.ports(self.inputs, inputs))
        return nodes.document_text(media + nodes.network_text(SLAB) + nodes.SURFACE)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random views and inputs. No view is grazing, because refraction amplifies roundings."""
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
# The anisotropy of a medium must not affect the transmittance.
ANISOTROPY = Input("anisotropy", low=-0.9, high=0.9, default=0.5)


MEDIUM_SPECS = tuple(
    MediumSpec(
        **spec.named(row, title_of(row, "VDF")),
        row=row,
        inputs=inputs_of(row) + ((ANISOTROPY,) if row.category == "anisotropic_vdf" else ()),
        errors={"value": TRANSMITTANCE},
        counts=Counts(1 << 8),
        fixed={"top/weight": 0.0, "bottom/weight": 0.0},
        evaluated=("transmission", "throughput", 1.0),
        optional=True,
        engines={"value": ENGINE if row in media.COMBINED_MEDIA else ENGINE[:1]},
    )
    for row in (*media.MEDIA, *media.COMBINED_MEDIA)
)
