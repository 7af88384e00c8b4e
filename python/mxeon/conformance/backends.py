# SPDX-License-Identifier: Apache-2.0
"""Classes that evaluate a MaterialX node on a rendering engine.

Some engines evaluate arbitrary pairs of directions. Other engines return closures, render one pair
of directions per pixel, or render pictures of a sphere. A backend draws the samples and adds the
engine's errors to the tolerances. All backends return values in the same form, so that each check
is written once.
"""

from __future__ import annotations

import math
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from itertools import product
from typing import TYPE_CHECKING, ClassVar, TypeAlias, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance import samples, tolerance
from mxeon.conformance.cache import EVALUATIONS, Recent, contents, parts
from mxeon.conformance.results import Quantity, grouped
from mxeon.conformance.samples import RIM, Array, Batch, Counts, Mask, Values
from mxeon.conformance.spec import POWER, Ability, LobeSpec, Spec, ValueSpec, broadcast_inputs
from mxeon.conformance.specs.diffuse import LOBE_VALUE, SurfaceLobe
from mxeon.conformance.specs.lobes import PbrSpec, ScatteringSpec
from mxeon.conformance.specs.microfacets import FacetSpec
from mxeon.conformance.tolerance import Term, Tolerance, relative, roundings, single, sum_in, sum_of
from mxeon.errors import DocumentError, NotRun
from mxeon.hosts import front_lit_only, host_row
from mxeon.hosts.base import Host, Query
from mxeon.hosts.calls import LIT
from mxeon.hosts.pairs import DISTANCE, JITTER, PIXEL, apart, visible
from mxeon.hosts.testrender_scene import EYE, NEAREST
from mxeon.models.nodes.node import Scattering, Variant
from mxeon.models.nodes.renderers import BSDL_VARIANTS, CYCLES_VARIANTS
from mxeon.models.shading_model import ALONG, UP
from mxeon.shaders import scene as scenes
from mxeon.shaders.methods import UNCHOSEN, Methods
from mxeon.shaders.scene import BACK, CLIENT, FRONT, FURNACE, SIDE, Client, Scene, sphere

if TYPE_CHECKING:
    from mxeon.hosts.osl import OslHost
    from mxeon.shaders.generation import Shader

POWERS = 1 << 12  # number of colors for which pow() is measured
Pairs: TypeAlias = tuple[Array, Array, Mask]  # wo, wi, and a mask of the pairs to judge
Errors: TypeAlias = Mapping[str, Tolerance | None]  # tolerances by quantity; None if not measured
T = TypeVar("T")


def implementation(host: Host, text: str, library: str) -> Shader | None:
    """The shader of a document, or None if the target lacks an implementation of a node."""
    try:
        return host.compile(text, library=library)[0]
    except DocumentError as error:
        if "Could not find a matching implementation" not in str(error):
            raise
        return None


class Backend(ABC):
    """A base class for evaluating one node on an engine."""

    abilities: ClassVar[Ability]  # supported kinds of nodes and checks
    # Kinds of states, such as "lights", for which the check `states` only uses the first state.
    plain: ClassVar[tuple[str, ...]] = ()
    all_samples: ClassVar[bool] = False  # whether `few` contains all samples
    fewer: ClassVar[Counts | None] = None  # numbers of samples for specs that draw more pairs
    engine_errors: ClassVar[Errors | None] = None  # replaces the errors of the spec
    methods: ClassVar[Methods] = UNCHOSEN  # lighting methods fixed by the engine

    def __init__(self, host: Host, spec: Spec, library: str) -> None:
        self.host, self.spec, self.library = host, spec, library
        counts = self.fewer or spec.counts, spec.counts
        self.counts: Counts = min(counts, key=lambda each: each.pairs).varied()
        self._evaluations = Recent[Array](EVALUATIONS)
        self._drawn: dict[str, object] = {}

    @classmethod
    def supports(cls, spec: Spec) -> bool:
        return spec.requires in cls.abilities

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        """The tolerance of each quantity, without the errors of the engine's built-in functions."""
        return spec.errors if cls.engine_errors is None else cls.engine_errors

    @property
    def prefiltered(self) -> bool:
        """Whether environment light on microfacets uses MaterialX's fitted albedo."""
        return self.host.active.environment == "prefilter" and not self.searched

    @property
    def searched(self) -> bool:
        """Whether the library has its own functions for environment lookups."""
        return bool(self.host.active.searched)

    def implemented(self, text: str) -> Shader:
        """The shader of a document. Raise NotRun if the target lacks an optional node."""
        if not self.spec.optional:
            return self.host.compile(text, library=self.library)[0]
        shader = implementation(self.host, text, self.library)
        if shader is None:
            raise NotRun(f"{self.host.target}: no implementation of {self.spec.title}")
        return shader

    def precision(self, quantity: str) -> tuple[Term, ...]:
        """Error terms due to the engine's built-in functions, measured on the host."""
        return ()

    @property
    def unset(self) -> tuple[str, ...]:
        """Inputs that the host cannot set."""
        return ()

    @property
    def claims(self) -> tuple[str, str]:
        """For a renderer's own node, titles of the claimed and the judged model; otherwise ""."""
        return "", ""

    def judged(self) -> Spec:
        """The spec to judge, which subclasses may adapt to a renderer or to the measured values."""
        return self.spec

    def take(self, draw: Callable[[Counts], T]) -> T:
        """The result of `draw`, a method of the spec. Each method is called once per backend."""
        if draw.__qualname__ not in self._drawn:
            self._drawn[draw.__qualname__] = draw(self.counts)
        return cast(T, self._drawn[draw.__qualname__])

    @property
    def lobe(self) -> LobeSpec:
        return cast(LobeSpec, self.spec)

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        batches = map(self.adapted, cast(ValueSpec, self.spec).batches(self.counts))
        return tuple(batch for batch in batches if len(batch.wo))

    def adapted(self, batch: Batch) -> Batch:
        """The batch, limited to pairs and inputs that the backend supports."""
        return batch

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """A subset of the samples, for expensive checks and negative controls."""
        spec = cast(ValueSpec, self.spec)
        return self.batches if self.all_samples else spec.few(self.batches, self.counts)

    @cached_property
    def views(self) -> tuple[Batch, ...]:
        views = self.lobe.views(self.batches, self.counts)
        return tuple(map(isotropic, views)) if self.prefiltered else views

    @cached_property
    def edges(self) -> Batch:
        return self.lobe.edges(self.counts)

    @cached_property
    def turned(self) -> Batch:
        return self.lobe.turned(self.counts)

    @cached_property
    def mirrored(self) -> tuple[Batch, Batch]:
        return cast(FacetSpec, self.spec).mirrored(self.counts)

    @cached_property
    def integrated(self) -> tuple[Batch, Array]:
        return cast(ScatteringSpec, self.spec).integrated(self.counts, self.supported)

    @cached_property
    def integrals(self) -> Array:
        """The model's integrals over light directions for materials in `integrated`, (N, 3)."""
        batch, weights = self.integrated
        views = batch.where(np.arange(len(weights)) * weights.shape[1])
        return cast(ScatteringSpec, self.spec).integral(views)

    def supported(self, inputs: Mapping[str, Array]) -> dict[str, Array]:
        return dict(inputs)

    def points(self, scene: Scene) -> Pairs:
        """Directions at the points of a picture's sphere, and a mask of the points to judge."""
        wo, wi, judged = picture_pairs(scene)
        return samples.float32(wo), samples.float32(wi), judged

    def pixels(self, scene: Scene) -> Mask:
        """A mask of the pixels that show the sphere."""
        return sphere(scene.size).mask

    def portrait(self, scene: Scene) -> tuple[Array, Array, Mask, Mask]:
        """The results of `points` and `pixels` for a picture that compares a node with a model."""
        return *self.points(scene), self.pixels(scene)

    @abstractmethod
    def direct(self, batch: Batch) -> Array:
        """Values in direct light, (N, 3): pi f cos(theta_i), a radiance, or a node's output."""

    @abstractmethod
    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """Values in an environment, (N, 3). The default environment is uniform."""


def isotropic(batch: Batch) -> Batch:
    """Replace both alphas by their geometric mean, because prefiltered light has one roughness."""
    inputs: dict[str, Array] = {}
    for name, value in batch.inputs.items():
        if name == "roughness" and np.shape(value)[-1:] == (2,):
            mean = np.sqrt(np.prod(np.asarray(value), axis=-1, keepdims=True))
            inputs[name] = np.broadcast_to(mean, np.shape(value))
        elif name.endswith("anisotropy"):
            inputs[name] = np.zeros_like(value)
    return batch.altered(**inputs)


class Evaluating(Backend):
    """An engine that runs the generated shader for arbitrary pairs of directions."""

    abilities = ~(Ability.BELOW | Ability.SURFACE | Ability.CLIENT)

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        color = roundings(2 * 16, "of a color and the resulting value, times the slope 2")
        errors: dict[str, Tolerance | None] = {**spec.errors, "color_space": sum_of(color)}
        if frame := spec.errors.get("frame"):
            terms = [frame.term("a part in another frame"), roundings(12, "in a sum of six parts")]
            if spec.along:
                slopes = f"twice the slope {spec.along:g} at the normal"
                error = 2.0 * spec.along * math.sqrt(2.0 * tolerance.ROUNDING)
                terms.append(Term(error, f"{slopes}, times the angle of a rounded cosine"))
            errors["states"] = sum_of(*terms)
        return errors

    def precision(self, quantity: str) -> tuple[Term, ...]:
        if quantity == "color_space":
            colors = samples.float32(np.linspace(0.09, 1.0, POWERS))
            power = samples.float32(np.full(POWERS, 2.4))
            error = POWER.error(lambda: (colors, power))(self.host)
            return (Term(2.0 * error, "the engine's pow(), times 2"),)
        if Ability.LIGHT not in self.abilities and self.spec.requires & Ability.SCATTERS:
            return ()
        fits = self.spec.prefiltered_fits if self.prefiltered else {}
        return *self.spec.engine(quantity, self.host), *fits.get(quantity, ())

    @cached_property
    def shader(self) -> Shader:
        shader = self.implemented(self.spec.document())
        if self.host.active.distributed and Ability.COMBINATION in self.spec.requires:
            changed = {name for row in self.spec.changes.values() for each in row for name in each}
            if renamed := sorted(changed - {each.path for each in shader.inputs}):
                raise NotRun(f"{self.host.name}: distributing layers renames {', '.join(renamed)}")
        return shader

    def direct(self, batch: Batch) -> Array:
        branch, output, factor = self.spec.evaluated
        return factor * self.evaluate(batch, branch, output)

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        return self.evaluate(batch, "environment", irradiance=irradiance)

    def throughput(self, batch: Batch, branch: str) -> Array:
        """Fraction of the light from below the node that passes through the node, (N, 3)."""
        return self.evaluate(batch, branch, "throughput")

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        """Environment light that the surface transmits, (N, 3). By default, the sky is uniform."""
        return self.evaluate(batch, "transmission", irradiance=radiance)

    @cached_property
    def two(self) -> Shader:
        """A shader with two lobes in one pixel."""
        return self.host.compile(self.lobe.two_lobes(), library=self.library)[0]

    @cached_property
    def decoded(self) -> Shader:
        """A shader whose color input is in sRGB."""
        text = self.spec.document({"color": samples.WHITE})
        for attribute, space in (('name="color"', "srgb_texture"), ('version="', "lin_rec709")):
            text = text.replace(attribute, f'colorspace="{space}" {attribute}')
        return self.host.compile(text, library=self.library)[0]

    def together(
        self, batch: Batch, irradiance: NDArray[np.float32] | None, client: Client, two: bool
    ) -> Array:
        """Values of one or two lobes under a client's lights and environment."""
        shader = self.two if two else self.shader
        if "lights" in self.plain:
            return np.pi * self.evaluate(batch, "direct", shader=shader)
        return self.evaluate(batch, LIT, irradiance=irradiance, shader=shader, client=client)

    def answer(self, query: Query) -> Array:
        pairs, (output, irradiance, client) = query[:5], query[5:]
        return self.host.evaluate(*pairs, output=output, irradiance=irradiance, client=client)

    def evaluate(
        self,
        batch: Batch,
        branch: str,
        output: str = "response",
        irradiance: NDArray[np.float32] | None = None,
        shader: Shader | None = None,
        client: Client = CLIENT,
    ) -> Array:
        def compute() -> Array:
            inputs = {**self.spec.fixed, **batch.inputs}
            pairs = batch.world(batch.wo), batch.world(batch.wi)
            light = irradiance, client
            query = Query(shader or self.shader, *pairs, inputs, branch, output, *light)
            return self.answer(query).astype(np.float64)

        shader_key = shader and (shader.element, shader.methods)
        key = *parts(batch), branch, output, shader_key, contents(irradiance), client
        return self._evaluations.value(key, compute)


class Media(Evaluating):
    """A backend for media, and for nodes that only need an implementation."""

    abilities = Ability.MEDIUM | Ability.IMPLEMENTATION | Ability.PAIRS | Ability.LIGHT


# OSL returns closures as trees of arguments and weights. The models evaluate the trees in float64.

# Few direction pairs suffice. More pairs would only test the models that evaluate the closures.
FEW_CLOSURES = Counts(1 << 11, 1 << 6, 1 << 8, albedos=16, materials=8, mirrored=1 << 8)
SOME = 1 << 8  # maximum number of special direction pairs of each kind
# The sharpest lobe (alpha 1e-4) amplifies a float64 rounding, 2^-53, by 1e8. The product is less
# than one float32 rounding, 2^-24.
ARGUMENTS = sum_of(roundings(1, "of arguments printed with nine digits"), exact=True)
# Each input has up to 16 roundings before a closure receives the value. A microfacet distribution
# amplifies a relative error by at most 4.
GRAPH = sum_of(roundings(4 * 16, "(16 from an input to an argument, times the slope 4)"))


def joined(batches: Sequence[Batch]) -> Batch:
    """One batch with the direction pairs of all batches. All batches must have the same inputs."""
    if len(batches) == 1:
        return batches[0]
    wo, wi = (np.concatenate(each) for each in ([b.wo for b in batches], [b.wi for b in batches]))
    rows = list(map(broadcast_inputs, batches))
    inputs = {name: np.concatenate([each[name] for each in rows]) for name in rows[0]}
    frames = [batch.frame for batch in batches if batch.frame is not None]
    return Batch(wo, wi, inputs, frame=np.concatenate(frames) if frames else None)


class Closures(Evaluating):
    """A host that returns closures with exact arguments and computes no lighting."""

    abilities = Evaluating.abilities & ~Ability.LIGHT
    plain = ("lights", "environment", "shape", "inputs")
    fewer = FEW_CLOSURES

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        errors = super().errors(spec)
        if not spec.requires & Ability.SCATTERS:
            return errors
        exact = GRAPH if Ability.MATERIAL in spec.requires else ARGUMENTS
        unmeasured = ["integral", "light", "reciprocity"]
        if Ability.TRANSMISSION in spec.requires:
            unmeasured.append("states")  # direct light does not reveal transmission
        if Ability.FILM in spec.requires:  # closures have no retroreflective flag and no lighting
            unmeasured += ["retroreflection", "albedo", "throughput"]
        return {
            **errors,
            **dict.fromkeys(("value", "albedo"), exact),
            **{name: exact for name in ("throughput", "lambert") if errors.get(name)},
            **dict.fromkeys(unmeasured),
        }

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        random, *others = super().batches
        return (random, *(batch.first(SOME) for batch in others))

    def adapted(self, batch: Batch) -> Batch:
        """Replace negative weights by 0, as OSL does, and set some indices of refraction to 0."""
        changes: dict[str, Array] = {}
        if "weight" in batch.inputs:
            changes["weight"] = np.maximum(batch.inputs["weight"], 0.0)
        if {"tint", "ior"} <= batch.inputs.keys():
            index = broadcast_inputs(batch)["ior"]
            changes["ior"] = np.where(np.arange(len(index)) % 7 == 3, 0.0, index)
        return batch.altered(**changes)

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """Take some samples of each kind, in few batches, because each run has a fixed cost."""
        few = (batch.first(self.counts.few) for batch in self.batches)
        groups = grouped(few, lambda batch: (*sorted(batch.inputs), batch.frame is None))
        return tuple(map(joined, groups.values()))

    @cached_property
    def turned(self) -> Batch:
        return super().turned.first(SOME)

    @cached_property
    def edges(self) -> Batch:
        edges, rng = super().edges, samples.generator()
        return edges.where(rng.permutation(len(edges.wo))[:SOME])

    def answer(self, query: Query) -> Array:
        from mxeon.conformance.reference.closures import evaluate

        assert query.irradiance is None, "closures look no environment up"
        if query.shader is self.shader and self.spec.requires & (Ability.DIFFUSE | Ability.LOBE):
            # Constant normals and tangents become node inputs, unless equal to the surface's axes.
            frame = {
                name: query.inputs[name]
                for name, axis in (("normal", UP), ("tangent", ALONG))
                if name in self.lobe.types and np.ndim(query.inputs.get(name, 0.0)) == 1
                if not np.array_equal(query.inputs[name], axis)
            }
            if frame:
                inputs = {name: each for name, each in query.inputs.items() if name not in frame}
                shader = self.implemented(self.spec.document(frame))
                query = query._replace(shader=shader, inputs=inputs)
        trees = cast("OslHost", self.host).trees(query.shader, query.wo, query.inputs)
        return evaluate(trees, query)

    @property
    def unset(self) -> tuple[str, ...]:
        """A surface shader's normals and tangents cannot be set, because its lobes share a frame."""
        names = self.spec.names if Ability.MATERIAL in self.spec.requires else ()
        return tuple(each for each in names if each.endswith(("normal", "tangent")))


class Functions(Evaluating):
    """A host that compiles functions for values and fitted albedos, but not for transmission."""

    abilities = Evaluating.abilities & ~(
        Ability.MEDIUM | Ability.IMPLEMENTATION | Ability.TRANSMISSION
    )
    plain = Closures.plain
    methods = Methods("prefilter")

    @classmethod
    def supports(cls, spec: Spec) -> bool:
        return super().supports(spec) and spec.evaluated[0] != "transmission"

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        return {**super().errors(spec), "color_space": None, "glass": None}

    @property
    def unset(self) -> tuple[str, ...]:
        return tuple(name for name in self.spec.names if name.startswith("transmission"))

    def adapted(self, batch: Batch) -> Batch:
        """Set occlusion to 1, because the renderer, not the function, applies occlusion."""
        return batch.altered(occlusion=1.0) if "occlusion" in batch.inputs else batch


# Renderers in which each pixel shows one pair of directions.

SMOOTH = ("eon", "qon", "burley")  # models without a sharp lobe at any roughness
# Smallest product of the sine and the cosine of the angle between a view and the normal.
OBLIQUE = 0.25
FEW_RENDERED = Counts(1 << 12, 1 << 10, 1 << 9, albedos=8, materials=16, nodes=32, mirrored=1 << 10)
FAST_ARC_COSINE = Term(4.6e-5, "OpenImageIO's fast arc cosine")  # number from OpenImageIO's source
POINT = 3.0 * EYE / NEAREST  # 3 roundings of coordinates up to 40, divided by a distance of 1/2
FLAT_SLOPE = 8.0  # largest slope of the diffuse models, per radian
# Largest relative slope of a microfacet lobe, per radian. The distribution contributes 2 / alpha.
# Fresnel and shadowing contribute 3.
SHARP_SLOPE = 2.0 / samples.LEAST_TURNED + 3.0
FLAT, SHARP = (
    sum_of(roundings(each * POINT, f"of a position, times the slope {each:g}"), FAST_ARC_COSINE)
    for each in (FLAT_SLOPE, SHARP_SLOPE)
)
# Error of the light's direction, in radians. A ray misses a pixel's center by up to JITTER pixels,
# so the point on a surface at the smallest cosine, RIM, moves by up to JITTER * PIXEL / RIM.
TURN = JITTER * PIXEL / (RIM * DISTANCE)
DISPLACED = "a point up to 0.007 pixels from a pixel's center, at cosine 0.05"
TRACED_FLAT, TRACED_SHARP = (
    sum_of(Term(each * TURN, f"{DISPLACED}, times {each:g}")) for each in (FLAT_SLOPE, SHARP_SLOPE)
)
BELOW = sum_of(
    roundings(4.0 * 16.0 * POINT, "of four positions, amplified 16 times by the lobes above"),
    FAST_ARC_COSINE,
)
VIEWS, PIXELS = 8, 1 << 12  # number of views per case, and number of pixels shared by all views
MEAN_OF_PATHS = "five standard errors of the mean of 512 pixels of 64 paths, rms error 0.01 each"
NOISE = sum_in(Quantity.ALBEDO, Term(5.0 * 0.01 / math.sqrt(PIXELS / VIEWS), MEAN_OF_PATHS))
PASSED = single(2e-3, Quantity.ALBEDO, "testrender's tables (1e-3 for a white dielectric)")
NODES_MOVED = Term(1.2e-3, "a quadrature of 32 x 32 nodes, moved by up to 0.08 near the view")
INTEGRAL = sum_in(Quantity.ALBEDO, SHARP.term("an average of values"), NODES_MOVED)
LIGHT = sum_in(Quantity.LIGHT, INTEGRAL.term("an integral of values"), PASSED.term("a throughput"))


def _is_renderable(batch: Batch, rim: float = RIM) -> Mask:
    least = np.minimum(batch.wo[:, 2], np.abs(batch.wi[:, 2]))
    return np.asarray(visible(batch.wo, batch.wi) & (least >= rim))


class RenderablePairs(Evaluating):
    """A backend that is limited to the pairs and inputs that renderers support.

    Both cosines are at least RIM, and no lobe is so sharp that the pixel position matters.
    Roughness is at most 1, as in OSL's stdosl.h. Weights are not negative, and occlusion is not
    applied.
    """

    fewer = FEW_RENDERED

    def adapted(self, batch: Batch) -> Batch:
        pairs = batch.where(_is_renderable(batch))
        return replace(pairs, inputs=self.supported(pairs.inputs))

    @cached_property
    def views(self) -> tuple[Batch, ...]:
        """Use few views, because all views share a fixed number of light paths."""
        return (super().views[0].first(self.counts.albedos),)

    @cached_property
    def edges(self) -> Batch:
        return self.adapted(super().edges)

    @cached_property
    def mirrored(self) -> tuple[Batch, Batch]:
        first, second = super().mirrored
        mask = _is_renderable(first) & _is_renderable(second)
        return self.adapted(first.where(mask)), self.adapted(second.where(mask))

    @cached_property
    def integrated(self) -> tuple[Batch, Array]:
        """Oblique views, for which values are smooth between neighboring quadrature nodes."""
        batch, weights = super().integrated
        nodes = weights.shape[1]
        height = batch.wo[::nodes, 2]
        oblique = height * np.sqrt(1.0 - height * height) >= OBLIQUE
        return batch.where(np.repeat(oblique, nodes)), weights[oblique]

    def supported(self, inputs: Mapping[str, Array]) -> dict[str, Array]:
        least = 0.0 if self.spec.model in SMOOTH else samples.LEAST_TURNED
        supported = {name: inputs[name] for name in inputs if name != "occlusion"}
        for name, values in supported.items():
            if name == "weight":
                supported[name] = np.maximum(values, 0.0)
            elif name.endswith("roughness"):
                supported[name] = np.clip(values, least, 1.0)
        return supported


class Rendered(RenderablePairs):
    """OSL's testrender, which computes lighting with the renderer's own closures."""

    abilities = (
        Ability.DIFFUSE | Ability.LOBE | Ability.SUBSURFACE | Ability.COMBINATION | Ability.PAIRS
    )
    variants: ClassVar[Mapping[str, tuple[Variant[Scattering], ...]]] = BSDL_VARIANTS
    flat: ClassVar[Tolerance] = FLAT
    sharp: ClassVar[Tolerance] = SHARP
    place: ClassVar[Tolerance | None] = None  # error of microfacet lobes due to the pixel position

    def judged(self) -> Spec:
        return _with_variants(type(self), self.spec)

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        errors: dict[str, Tolerance | None] = {**spec.errors}
        for name in ("retroreflection", "anisotropy"):
            if cls.place and name in spec.errors and spec.errors[name].value < cls.place.value:
                errors[name] = cls.place
        value = cls.flat if spec.flat else cls.sharp
        return {
            **errors,
            **dict.fromkeys(("value", "reciprocity"), value),
            "albedo": NOISE,
            "throughput": PASSED,
            "integral": INTEGRAL,
            "light": LIGHT,
            "lambert": cls.flat,
            "frame": None,
        }

    def direct(self, batch: Batch) -> Array:
        """Values in direct light. Pairs that cannot be rendered are moved slightly."""
        return super().direct(replace(batch, wi=apart(batch.wo, batch.wi)))


class Traced(Rendered):
    """Cycles, whose own closures render all nodes except rough diffuse nodes."""

    abilities = Ability.LOBE | Ability.COMBINATION | Ability.PAIRS
    variants = CYCLES_VARIANTS
    flat, sharp, place = TRACED_FLAT, TRACED_SHARP, TRACED_SHARP


class LobesBelow(RenderablePairs):
    """The diffuse lobe of a surface shader, covered by the other lobes; see `SurfaceLobe`."""

    abilities = Ability.BELOW | Ability.LIGHT
    all_samples = True

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs far from the horizon, with random colors and roughnesses of the lobe."""
        rng, count = samples.generator(), self.counts.few
        inputs = self.supported(self.lobe.random_inputs(rng, count))
        wo, wi = samples.directions(rng, count), samples.directions(rng, count)
        batch = Batch(wo, wi, inputs)
        return (batch.where(_is_renderable(batch, samples.LOBE_RIM)),)

    def direct(self, batch: Batch) -> Array:
        ports = cast(SurfaceLobe, self.spec).ports

        def lit(batch: Batch) -> Array:
            inputs = {port: batch.inputs[name] for name, port in ports.items()}
            return self.evaluate(replace(batch, inputs=inputs), "direct")

        return diffuse_alone(lit, batch)


class RenderedLobes(LobesBelow):
    """The diffuse lobe of a surface shader, rendered by testrender."""

    engine_errors: ClassVar[Errors] = {"value": BELOW}


def diffuse_alone(evaluate: Callable[[Batch], Array], batch: Batch) -> Array:
    """The diffuse lobe of a surface shader without the other lobes; see `SurfaceLobe`."""
    above = evaluate(batch.altered(color=samples.BLACK))
    lambert = evaluate(batch.altered(color=samples.WHITE, roughness=0.0)) - above
    with np.errstate(divide="ignore", invalid="ignore"):  # a shader that returns 0 causes 0 / 0
        return (evaluate(batch) - above) / lambert * batch.wi[:, 2:]


@lru_cache(maxsize=16)
def _with_variants(backend: type[Rendered], spec: Spec) -> Spec:
    """The spec, with a renderer's functions added to the functions that may explain values."""
    if not isinstance(spec, PbrSpec) or spec.row.name not in backend.variants:
        return spec
    variants = (*backend.variants[spec.row.name], *spec.row.variants)
    return replace(spec, row=replace(spec.row, variants=variants))


# Hosts that render pictures of a sphere. Each lit point of a sphere provides a pair of directions.

PICTURE_SIZE = 128
HALF_CUT = Term(2.0**-10, "half floats, truncated")  # llvmpipe truncates instead of rounding
# Relative error of a lobe per radian of error in a direction. A microfacet distribution contributes
# 2 / alpha, where alpha is at least 0.4. Fresnel, shadowing and the cosine contribute 3.
LOBE_SLOPE = 2.0 / 0.4 + 3.0
# Each of two cosines has five roundings. Oren and Nayar's model amplifies a cosine's error by up to
# 22, which is 1 / 0.05 = 20 in the ratio s / t, 1 in s, and 1 in the factor cos(theta_i).
TWO_COSINES = roundings(2 * 5 * (1.0 / RIM + 2.0), "(five in each of two cosines, times 22)")
EXACT = sum_in(Quantity.DIFFERENCE, roundings(28, "(14 of numbers up to 2)"), TWO_COSINES)
EXACT_ALBEDO = sum_in(Quantity.ALBEDO, roundings(21 * 1.02, "of numbers up to 1.02"))
HALF = Tolerance((HALF_CUT, *EXACT.terms), Quantity.RELATIVE, relative, exact=True)
HALF_MAPS = Term(2.0 * HALF_CUT.value, "half floats in map and picture, truncated")
HALF_ALBEDO = sum_in(Quantity.ALBEDO, HALF_MAPS, EXACT_ALBEDO.term("roundings"), exact=True)
DRAWN_LOBE = LOBE_VALUE.plus(
    roundings(16 / samples.LOBE_RIM**2, "of a pixel's position, times the largest 1 / cosine^2, 16")
)
FOUR_PICTURES = Term(
    96.0 * HALF_CUT.value, "half floats in four pictures, times 48, of which half cancels"
)
HALF_LOBE = sum_in(Quantity.DIFFERENCE, FOUR_PICTURES, *DRAWN_LOBE.terms, exact=True)

# The point in a pixel is a ray's origin plus a vector along the ray. Both vectors have lengths up
# to 2, so each of three roundings is at most 2^-23. At grazing views, the error of the point grows
# by 1 / cos(theta_o). At grazing light, the relative error of a value grows by 1 / cos(theta_i).
CYCLES_RAY = sum_of(
    roundings(3.0 * 2.0 / RIM**2, "of a pixel's position, times the largest 1 / cosine^2"),
    Term(1e-5, "a roughness that counts as 0"),
    quantity=Quantity.RELATIVE,
    metric=relative,
)
# The noise was measured at 256 samples per pixel, with seeds 0 to 15, roughness 1 and reflectance
# 1. The rms error of a pixel is 1.3e-3. The rms error of the mean of 3212 pixels is 3.1e-5, which
# is 1.34 times the error expected for independent pixels.
CYCLES_MEAN = "four standard errors of the mean of 12836 pixels, rms error 1.3e-3 each, times 1.4"
CYCLES_NOISE = sum_of(
    Term(4.0 * 1.4 * 1.3e-3 / math.sqrt(12_836), CYCLES_MEAN),
    quantity=Quantity.MEAN_ALBEDO,
    metric=tolerance.mean_error,
)


class Pictures(Backend):
    @property
    def size(self) -> int:
        return PICTURE_SIZE // self.spec.coarse

    def points(self, scene: Scene) -> Pairs:
        wo, wi, _ = picture_pairs(scene)
        mu_i = wi[:, 2] * (1.0 if scene.light is None else self.spec.side)
        return wo, wi, np.minimum(wo[:, 2], mu_i) >= self.spec.rim

    def direct(self, batch: Batch) -> Array:
        if Ability.BELOW in self.spec.requires:
            return diffuse_alone(self.picture, batch)
        return self.picture(batch)

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        return self.picture(batch)  # the batch's scene contains the environment

    def picture(self, batch: Batch) -> Array:
        scene = scene_of(batch)
        image = self.image(batch.inputs, scene)
        return image[self.pixels(scene)][self.points(scene)[2]].astype(np.float64)

    def image(self, inputs: Values, scene: Scene) -> NDArray[np.floating]:
        return self.host.picture(self.shader_of(inputs), scene)

    def shader_of(self, inputs: Values) -> Shader:
        return _compile(self.host, self.spec.document(inputs), self.library, self.host.methods)


class Spheres(Pictures):
    """One picture for each light and material. The samples are lit points far from the rim."""

    scenes: ClassVar[tuple[Scene, ...]] = (SIDE, FRONT, BACK)
    all_samples = True

    @property
    def materials(self) -> Sequence[Values]:
        return self.spec.materials

    def batch(self, scene: Scene, inputs: Values) -> Batch:
        wo, wi, mask = self.points(scene)
        return Batch(wo[mask], wi[mask], samples.arrays(inputs), scene)

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        scenes = (replace(scene, size=self.size) for scene in self.scenes)
        batches = (self.batch(*each) for each in product(scenes, self.materials))
        return tuple(batch for batch in batches if len(batch.wo))

    @cached_property
    def views(self) -> tuple[Batch, ...]:
        """Points of the sphere in a white environment, in one batch per material."""
        scene = replace(FURNACE, size=self.size)
        views = tuple(self.batch(scene, inputs) for inputs in self.materials)
        return tuple(map(isotropic, views)) if self.prefiltered else views


@lru_cache(maxsize=8)  # a check renders many pictures of few documents
def _compile(host: Host, text: str, library: str, methods: Methods) -> Shader:
    from mxeon.shaders.generation import ApproximationWarning  # this import loads MaterialX

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ApproximationWarning)
        return host.compile(text, library=library, methods=methods)[0]


def scene_of(batch: Batch) -> Scene:
    assert batch.scene is not None
    return batch.scene


@lru_cache(maxsize=8)
def picture_pairs(scene: Scene) -> Pairs:
    """Directions at the points of a picture's sphere, and a mask of the points to judge."""
    points = sphere(scene.size)
    return lit_pairs(points.normal[points.mask], scene)


def lit_pairs(normal: Array, scene: Scene) -> Pairs:
    """Directions at points of a picture with given normals, and a mask of the points to judge."""
    wo = scenes.local_directions(normal, scenes.VIEW)
    wi = wo if scene.light is None else scenes.local_directions(normal, scene.light)
    return wo, wi, (wo[:, 2] >= RIM) & (wi[:, 2] >= RIM)


class CyclesPictures(Spheres):
    """Pictures of a rough diffuse node that Cycles renders with its own closure."""

    abilities = Ability.DIFFUSE | Ability.LIGHT
    engine_errors: ClassVar[Errors] = {
        "value": CYCLES_RAY,
        "albedo": CYCLES_NOISE,
        "lambert": CYCLES_RAY,
    }

    def points(self, scene: Scene) -> Pairs:
        """Skip back-lit pairs if Cycles uses a different model for back-lit pairs."""
        wo, wi, mask = super().points(scene)
        if front_lit_only(self.host.name, self.spec.model):
            mask = mask & (np.sum(wo[:, :2] * wi[:, :2], axis=1) >= 0.0)
        return wo, wi, mask


class Drawn(Spheres):
    """Pictures of a sphere. Points and light directions are exact up to rounding."""

    abilities = Ability.LOBE | Ability.DIFFUSE | Ability.BELOW | Ability.LIGHT
    exact: ClassVar[Errors] = {"value": EXACT, "albedo": EXACT_ALBEDO, "lambert": EXACT}
    lobe_error: ClassVar[Tolerance] = DRAWN_LOBE

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        if Ability.BELOW in spec.requires:
            return {"value": cls.lobe_error}
        if Ability.DIFFUSE in spec.requires:
            return cls.exact
        albedo = spec.errors.get("picture_albedo", spec.errors["albedo"])
        return {"value": cls.drawn(spec.errors["value"]), "albedo": cls.drawn(albedo)}

    @classmethod
    def drawn(cls, error: Tolerance) -> Tolerance:
        """The tolerance of a value or an albedo in pictures, including rounding of two cosines."""
        points = roundings(LOBE_SLOPE * 2 * 5 / RIM, "(five in two cosines each, times 8 / 0.05)")
        return sum_of(error.term("a value or albedo"), points, quantity=error.quantity)


class Half(Drawn):
    """Pictures with exact points and half-float colors, as Storm renders by default."""

    exact: ClassVar[Errors] = {"value": HALF, "albedo": HALF_ALBEDO, "lambert": HALF}
    lobe_error = HALF_LOBE

    @classmethod
    def supports(cls, spec: Spec) -> bool:
        return super().supports(spec) and spec.model != "zeltner"

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        """Omit albedos of pbrlib nodes, because Storm samples environments in its own way."""
        errors = super().errors(spec)
        return {**errors, "albedo": None} if Ability.LOBE in spec.requires else errors

    @classmethod
    def drawn(cls, error: Tolerance) -> Tolerance:
        drawn = super().drawn(error)
        return replace(drawn, terms=(drawn.term("a pixel's value"), HALF_CUT), exact=True)

    unset = ("retroreflective",)  # Storm uses MaterialX 1.39.3, which lacks this input


# The error of a pixel's point is three roundings of 2^-23, divided by a cosine of at least 0.05.
PICTURE_RADIANCE = sum_of(
    roundings(5 * 6 / RIM, "of a position, divided by the smallest cosine, times the slope 5"),
    roundings(8),
    quantity=Quantity.RADIANCE,
)


class DarkPictures(Pictures):
    """One picture for each material of an emitting surface, in a scene without other light."""

    abilities = Ability.SURFACE | Ability.LIGHT


class Frames(Pictures):
    """Pictures that a shader's complete main() function draws with a client's bindings."""

    abilities = Ability.CLIENT | Ability.LIGHT


class EmissionPictures(Spheres):
    """Pictures of an EDF node on a sphere without other light."""

    abilities = Ability.EMISSION | Ability.LIGHT
    scenes = (Scene("dark"),)
    engine_errors: ClassVar[Errors] = {"value": PICTURE_RADIANCE}

    def shader_of(self, inputs: Values) -> Shader:
        return self.implemented(self.spec.document(inputs))


class UtilityOsl(Evaluating):
    """Outputs of a utility node on an OSL renderer, with the renderer's own math functions."""

    abilities = Ability.OUTPUT | Ability.LIGHT
    all_samples = True

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """All samples, joined in one batch so that the renderer runs only once."""
        return (joined(super().batches),)

    @classmethod
    def errors(cls, spec: Spec) -> Errors:
        return {**spec.errors, "value": spec.errors.get("osl_value", spec.errors["value"])}


# Backends for each way in which hosts evaluate nodes. The first backend that supports a spec is
# used. `mxeon.survey` adds backends for renderers with their own materials.
BACKENDS: dict[str, tuple[type[Backend], ...]] = {
    "pairs": (Evaluating, LobesBelow, DarkPictures, Frames),
    "closures": (Closures,),
    "functions": (Functions,),
    "rendered": (Rendered, RenderedLobes),
    "pictures": (CyclesPictures, Traced, EmissionPictures, Media, DarkPictures, UtilityOsl),
    "drawn pictures": (Drawn,),
    "half pictures": (Half,),
}


def ways_of(host: str) -> tuple[type[Backend], ...]:
    """The backends of a host, or () if only the source code of the host's shaders is checked."""
    own_nodes(host)  # imports the backends of a renderer
    return BACKENDS.get(host_row(host).way, ())


def own_nodes(host: str) -> tuple[Spec, ...]:
    """The judged nodes that a renderer defines. The call also imports the renderer's backends."""
    nodes = host_row(host).nodes
    return tuple(nodes(host)) if nodes else ()


def backend_of(host: str, spec: Spec) -> type[Backend] | None:
    """The backend that evaluates a node on a host, or None if no backend supports the node."""
    return next((way for way in ways_of(host) if way.supports(spec)), None)
