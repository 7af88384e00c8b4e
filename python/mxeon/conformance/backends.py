# SPDX-License-Identifier: Apache-2.0
"""The ways of asking an engine for values of a node: what each supports, takes, and adds to an error.

An engine evaluates any pairs of directions, returns closures, lights a point by a camera and a light, or
renders pictures of a sphere. Each returns its values in the same form, so that a check is written once.
"""

from __future__ import annotations

import math
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.cache import EVALUATIONS, Recent, contents, parts
from mxeon.conformance.results import Claims
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import (
    LEAST_TURNED,
    LOBE_RIM,
    RIM,
    Array,
    Batch,
    Counts,
    Mask,
    Values,
    directions,
    float32,
    generator,
    rounded,
)
from mxeon.conformance.spec import POWER, LobeSpec, Spec, broadcast_inputs
from mxeon.conformance.specs.combinations import CombinedSpec
from mxeon.conformance.specs.diffuse import LOBE_VALUE, DiffuseModelSpec, DiffuseSpec, SurfaceLobe
from mxeon.conformance.specs.emission import AbsentSpec, EmissionSpec, EmittingSurface, MediumSpec
from mxeon.conformance.specs.hair import HairSpec
from mxeon.conformance.specs.lobes import PbrSpec, ScatteringSpec
from mxeon.conformance.specs.microfacets import LEAST_FIT, FilmSpec, TransmissionSpec
from mxeon.conformance.specs.subsurface import SubsurfaceSpec
from mxeon.conformance.specs.surface_shaders import SurfaceShaderSpec
from mxeon.conformance.specs.utilities import UtilitySpec
from mxeon.conformance.tolerance import (
    ROUNDING,
    Term,
    Tolerance,
    given,
    largest,
    mean_error,
    relative,
    roundings,
    sum_in,
    sum_of,
)
from mxeon.errors import DocumentError, NotRun
from mxeon.hosts import front_lit_only, host_row
from mxeon.hosts.base import Host
from mxeon.hosts.calls import LIT
from mxeon.hosts.pairs import DISTANCE, JITTER, PIXEL, apart, visible
from mxeon.hosts.testrender_scene import EYE, NEAREST
from mxeon.models.nodes.node import Scattering, Variant
from mxeon.models.nodes.renderers import BSDL_VARIANTS, CYCLES_VARIANTS
from mxeon.models.shading_model import ALONG, UP
from mxeon.shaders.scene import BACK, FRONT, FURNACE, SIDE, VIEW, Scene, local_directions, sphere

if TYPE_CHECKING:
    from mxeon.shaders.generation import Shader

WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
LINEAR, SRGB_COLOR = 'colorspace="lin_rec709" version="', 'name="color" colorspace="srgb_texture"'
POWERS = 1 << 12  # colors whose powers are measured
NO_IMPLEMENTATION = "Could not find a matching implementation"
Pairs: TypeAlias = tuple[Array, Array, Mask]  # wo, wi, and which of them are judged
Families: TypeAlias = tuple[type[Spec], ...]
Asked: TypeAlias = "tuple[Shader, Array, Array, Values, str]"  # for pairs, in a branch
T = TypeVar("T")


def implementation(host: Host, text: str, library: str) -> Shader | None:
    """Shader of a document; None where the target has no implementation of one of its nodes."""
    try:
        return host.compile(text, library=library)[0]
    except DocumentError as error:
        if NO_IMPLEMENTATION not in str(error):
            raise
        return None


class Samples:
    """The samples of a spec that a backend takes, each drawn once."""

    whole: ClassVar[bool] = False  # whether controls and what takes long get all of them

    def __init__(self, backend: Backend) -> None:
        self.backend: Any = backend
        self.spec: Any = backend.spec  # of a family that has what is taken of it
        counts = backend.fewer or self.spec.counts, self.spec.counts
        self.counts: Counts = min(counts, key=lambda each: each.pairs).varied()
        self._drawn: dict[str, object] = {}

    def take(self, draw: Callable[[Counts], T]) -> T:
        """What a method of the spec draws."""
        if draw.__qualname__ not in self._drawn:
            self._drawn[draw.__qualname__] = draw(self.counts)
        return cast(T, self._drawn[draw.__qualname__])

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        batches: tuple[Batch, ...] = self.spec.batches(self.counts)
        return batches

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """Some of them, for what takes long and for controls."""
        if self.whole:
            return self.batches
        few: tuple[Batch, ...] = self.spec.few(self.batches, self.counts)
        return few

    @cached_property
    def views(self) -> tuple[Batch, ...]:
        views: tuple[Batch, ...] = self.spec.views(self.batches, self.counts)
        if self.backend.prefiltered:
            return tuple(map(isotropic, views))
        return views

    @cached_property
    def edges(self) -> Batch:
        return cast(Batch, self.spec.edges(self.counts))

    @cached_property
    def turned(self) -> Batch:
        return cast(Batch, self.spec.turned(self.counts))

    @cached_property
    def mirrored(self) -> tuple[Batch, Batch]:
        return cast(tuple[Batch, Batch], self.spec.mirrored(self.counts))

    @cached_property
    def integrated(self) -> tuple[Batch, Array]:
        return cast(tuple[Batch, Array], self.spec.integrated(self.counts, self.taken))

    @cached_property
    def integrals(self) -> Array:
        """Integrals of the values of the integrated materials, by the equations, (N, 3)."""
        batch, weights = self.integrated
        views = batch.where(np.arange(len(weights)) * weights.shape[1])
        return cast(Array, self.spec.integral(views))

    def taken(self, inputs: Mapping[str, Array]) -> dict[str, Array]:
        """Inputs that the backend takes."""
        return dict(inputs)


def isotropic(batch: Batch) -> Batch:
    """The same with the mean alpha in all directions: a prefiltered environment has one roughness."""
    inputs: dict[str, Array] = {}
    for name, value in batch.inputs.items():
        if name == "roughness" and np.shape(value)[-1:] == (2,):
            mean = np.sqrt(np.prod(np.asarray(value), axis=-1, keepdims=True))
            inputs[name] = np.broadcast_to(mean, np.shape(value))
        elif name.endswith("anisotropy"):
            inputs[name] = np.zeros_like(value)
    return batch.altered(**inputs)


class Backend(ABC):
    """A way of asking an engine about one node: its shader, and values of it."""

    families: ClassVar[Families] = ()  # of nodes of which it has values
    others: ClassVar[Families] = ()  # of these, families of which it has none
    # Axes of `checks.states` of which it has the first state alone.
    plain: ClassVar[tuple[str, ...]] = ()
    any_pairs: ClassVar[bool] = True  # those at the edges of the domain, too
    # Families of nodes of which the host itself finds no light and lets none pass.
    unlit: ClassVar[Families] = ()
    sampled: ClassVar[type[Samples]] = Samples
    fewer: ClassVar[Counts | None] = None  # counts of samples where a spec has more

    def __init__(self, host: Host, spec: Spec, library: str) -> None:
        self.host, self.spec, self.library = host, spec, library
        self._evaluations = Recent[Array](EVALUATIONS)

    @classmethod
    def supports(cls, spec: Spec) -> bool:
        """Whether an engine that is asked in this way has values of a node."""
        return isinstance(spec, cls.families) and not isinstance(spec, cls.others)

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        """The largest error of a quantity, engine functions apart; None where it is not asked."""
        return spec.errors.get(quantity)

    @property
    def prefiltered(self) -> bool:
        return self.host.active.environment == "prefilter"

    def implemented(self, text: str) -> Shader:
        """Shader of a document; NotRun where the target has no implementation of an optional node."""
        if not self.spec.optional:
            return self.host.compile(text, library=self.library)[0]
        shader = implementation(self.host, text, self.library)
        if shader is None:
            raise NotRun(f"{self.host.target}: no implementation of {self.spec.node}")
        return shader

    def precision(self, quantity: str) -> tuple[Term, ...]:
        """What the engine's own functions, measured on the host, add to the error of a quantity."""
        return ()

    @property
    def unset(self) -> tuple[str, ...]:
        """Inputs that the host cannot set."""
        return ()

    @property
    def claims(self) -> Claims:
        """What a result says of a renderer's own node beside its verdict."""
        return {}

    def judged(self) -> Spec:
        """The spec with what the engine may have instead of its model, or in the form nearest to what is measured."""
        return self.spec

    def portrait(self, scene: Scene) -> tuple[Array, Array, Mask, Mask]:
        """Pairs at the points of a picture, which are judged, and the pixels of the points."""
        wo, wi, judged = picture_pairs(scene)
        return rounded(wo.T), rounded(wi.T), judged, sphere(scene.size).mask

    @abstractmethod
    def direct(self, batch: Batch) -> Array:
        """Values in direct light, (N, 3): pi f cos(theta_i), a radiance, or an output."""

    @abstractmethod
    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """Values of the environment branch, (N, 3); the environment is uniform unless given."""


# Hosts that evaluate any pairs of directions.


class Evaluating(Backend):
    """An engine that runs the generated shader for any pairs."""

    families: ClassVar[Families] = (Spec,)
    others: ClassVar[Families] = (SurfaceLobe, EmittingSurface)

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        if quantity == "color_space":
            return sum_of(roundings(2 * 16, "of a color and the value it has, times the slope 2"))
        if quantity == "states" and "frame" in spec.errors:
            angle = 2.0 * spec.along * math.sqrt(2.0 * ROUNDING)
            words = f"two slopes {spec.along:g} at the normal, times the angle of a rounded cosine"
            return sum_of(
                spec.errors["frame"].term("a part in another frame"),
                roundings(12, "of six parts"),
                *((Term(angle, words),) if angle else ()),
            )
        return super().error(spec, quantity)

    def precision(self, quantity: str) -> tuple[Term, ...]:
        if quantity == "color_space":
            colors, power = float32(np.linspace(0.09, 1.0, POWERS)), float32(np.full(POWERS, 2.4))
            error = POWER.error(lambda: (colors, power))(self.host)
            return (Term(2.0 * error, "pow() as measured there, times 2"),)
        if isinstance(self.spec, self.unlit):
            return ()
        terms = self.spec.engine(quantity, self.host)
        if quantity == "value" and self.prefiltered and isinstance(self.spec, TransmissionSpec):
            terms += (Term(LEAST_FIT, "MaterialX's fit of prefiltered light"),)
        return terms

    @cached_property
    def shader(self) -> Shader:
        return self.implemented(self.spec.document())

    def direct(self, batch: Batch) -> Array:
        branch, output, factor = self.spec.asked
        return factor * self.evaluate(batch, branch, output)

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        return self.evaluate(batch, "environment", irradiance=irradiance)

    def throughput(self, batch: Batch, branch: str) -> Array:
        """The share of the light from below that passes the node, in a branch, (N, 3)."""
        return self.evaluate(batch, branch, "throughput")

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        """Light of an environment through the surface, (N, 3); it is uniform unless given."""
        return self.evaluate(batch, "transmission", irradiance=radiance)

    @cached_property
    def two(self) -> Shader:
        """A shader of two lobes in one pixel."""
        text = cast(LobeSpec, self.spec).two_lobes()
        return self.host.compile(text, library=self.library)[0]

    @cached_property
    def decoded(self) -> Shader:
        """The shader of a color in sRGB."""
        text = self.spec.document({"color": WHITE}).replace('name="color"', SRGB_COLOR)
        return self.host.compile(text.replace('version="', LINEAR), library=self.library)[0]

    def together(self, batch: Batch, irradiance: NDArray[np.float32] | None, two: bool) -> Array:
        """Light of several lights and of an environment in one pixel, from one lobe or from two."""
        shader = self.two if two else self.shader
        return self.evaluate(batch, LIT, irradiance=irradiance, shader=shader)

    def asked(self, asked: Asked, output: str, irradiance: NDArray[np.float32] | None) -> Array:
        """The host's values for a shader, directions, inputs and a branch."""
        return self.host.evaluate(*asked, output=output, irradiance=irradiance)

    def evaluate(
        self,
        batch: Batch,
        branch: str,
        output: str = "response",
        irradiance: NDArray[np.float32] | None = None,
        shader: Shader | None = None,
    ) -> Array:
        def evaluated() -> Array:
            inputs = {**self.spec.fixed, **batch.inputs}
            wo, wi = batch.world(batch.wo), batch.world(batch.wi)
            asked = shader or self.shader, wo, wi, inputs, branch
            return self.asked(asked, output, irradiance).astype(np.float64)

        which = shader and (shader.element, shader.methods)
        rest = branch, output, which, contents(irradiance)
        return self._evaluations.value((*parts(batch), *rest), evaluated)


class InTheDark(Evaluating):
    """The same of media, and of nodes whose implementation alone is judged, on a renderer."""

    families = (MediumSpec, AbsentSpec)


# OSL: closures are trees of arguments and weights, which the models evaluate in float64.

# The closures are few, and their values are those of the models: more pairs would tell the models apart.
FEW_CLOSURES = Counts(1 << 11, 1 << 6, 1 << 8, albedos=16, materials=8, mirrored=1 << 8)
SOME = 1 << 8  # pairs of every kind but the random ones
# The models round in float64, 2^-53, and the sharpest lobe, of alpha 1e-4, takes that 1e8 times.
ARGUMENTS = Tolerance(
    (roundings(1, "of arguments with nine digits, evaluated in float64"),), exact=True
)
GRAPH = sum_of(
    roundings(
        4 * 16, "from an input to an argument, 16 times 4: a distribution's log grows 4 times"
    )
)


class ClosureSamples(Samples):
    """Fewer samples, with weights of at least 0: OSL multiplies a closure by any number.

    Some dielectrics have the index 0, for which a shader may make another closure.
    """

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        random, *others = map(_altered, super().batches)
        return (random, *(batch.first(SOME) for batch in others))

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """Few of each, together where possible: a run takes its time however few they are."""
        groups: dict[tuple[str, ...], list[Batch]] = {}
        for batch in self.batches:
            few, names = batch.first(self.counts.few), tuple(sorted(batch.inputs))
            groups.setdefault((*names, str(batch.frame is None)), []).append(few)
        return tuple(map(joined, groups.values()))

    @cached_property
    def turned(self) -> Batch:
        return super().turned.first(SOME)

    @cached_property
    def edges(self) -> Batch:
        edges = super().edges
        return edges.where(generator().permutation(len(edges.wo))[:SOME])


def joined(batches: Sequence[Batch]) -> Batch:
    """One batch of all pairs, whose inputs have the same names."""
    if len(batches) == 1:
        return batches[0]
    wo, wi = (np.concatenate(each) for each in ([b.wo for b in batches], [b.wi for b in batches]))
    rows = list(map(broadcast_inputs, batches))
    inputs = {name: np.concatenate([each[name] for each in rows]) for name in rows[0]}
    frames = [batch.frame for batch in batches if batch.frame is not None]
    return Batch(wo, wi, inputs, frame=np.concatenate(frames) if frames else None)


def _altered(batch: Batch) -> Batch:
    changes: dict[str, Array] = {}
    if "weight" in batch.inputs:
        changes["weight"] = np.maximum(batch.inputs["weight"], 0.0)
    if {"tint", "ior"} <= batch.inputs.keys():
        index = broadcast_inputs(batch)["ior"]
        changes["ior"] = np.where(np.arange(len(index)) % 7 == 3, 0.0, index)
    return batch.altered(**changes)


class Closures(Evaluating):
    """A host that returns closures; arguments have no errors, and no closure finds light."""

    plain = ("lights", "environment", "shape", "inputs")
    sampled, fewer, unlit = ClosureSamples, FEW_CLOSURES, (LobeSpec,)

    def asked(self, asked: Asked, output: str, irradiance: NDArray[np.float32] | None) -> Array:
        from mxeon.conformance.reference.closures import evaluate

        assert irradiance is None, "closures look no environment up"
        shader, wo, wi, inputs, branch = asked
        if shader is self.shader and isinstance(self.spec, (DiffuseSpec, PbrSpec)):
            # A constant that is not the surface's own frame is the node's input, of its document.
            frame = {
                name: inputs[name]
                for name, axis in (("normal", UP), ("tangent", ALONG))
                if name in self.spec.types and np.ndim(inputs.get(name, 0.0)) == 1
                if not np.array_equal(inputs[name], axis)
            }
            shader = self.implemented(self.spec.document(frame)) if frame else shader
            inputs = {name: value for name, value in inputs.items() if name not in frame}
        return evaluate(self.host, shader, wo, wi, inputs, branch, output)

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        own = super().error(spec, quantity)
        if quantity == "states" and isinstance(spec, TransmissionSpec):
            return None  # a light shows nothing of what it transmits
        if isinstance(spec, FilmSpec) and quantity in ("retroreflection", "albedo", "throughput"):
            return None  # no closure has the flag, and none finds light
        if not isinstance(spec, LobeSpec):
            return own
        exact = GRAPH if isinstance(spec, SurfaceShaderSpec) else ARGUMENTS
        told: dict[str, Tolerance | None] = {
            **dict.fromkeys(("value", "albedo"), exact),
            **dict.fromkeys(("throughput", "lambert"), own and exact),
            **dict.fromkeys(("integral", "light", "reciprocity"), None),
        }
        return told.get(quantity, own)

    def together(self, batch: Batch, irradiance: NDArray[np.float32] | None, two: bool) -> Array:
        return np.pi * self.evaluate(batch, "direct", shader=self.two if two else self.shader)

    @property
    def unset(self) -> tuple[str, ...]:
        """Frames of a surface shader's lobes: its text takes them from the surface, and has no input."""
        names = self.spec.names if isinstance(self.spec, SurfaceShaderSpec) else ()
        return tuple(each for each in names if each.endswith(("normal", "tangent")))


# Renderers whose camera and light show one pair for each pixel.

SMOOTH = ("eon", "qon", "burley")  # models whose roughness sharpens no lobe
# Sine times cosine of a view whose mirror direction is far from it and from its opposite.
OBLIQUE = 0.25
FEW_RENDERED = Counts(1 << 12, 1 << 10, 1 << 9, albedos=8, materials=16, nodes=32, mirrored=1 << 10)
FAST_ARC_COSINE = Term(4.6e-5, "OpenImageIO's fast arc cosine")  # by its source
POINT = 3.0 * EYE / NEAREST  # roundings of a point at the distance 40, seen from a light 1/2 away
FLAT_SLOPE = 8.0  # largest of the diffuse models
SHARP_SLOPE = (
    2.0 / LEAST_TURNED + 3.0
)  # twice over the least alpha, and 3 for Fresnel and shadowing
FLAT, SHARP = (
    sum_of(roundings(each * POINT, f"of a point, times the slope {each:g}"), FAST_ARC_COSINE)
    for each in (FLAT_SLOPE, SHARP_SLOPE)
)
# A light seen from a point of a triangle that is steep.
TURN = JITTER * PIXEL / (RIM * DISTANCE)
BESIDE = "a point up to 0.007 pixels beside the middle, at cosine 0.05"
TRACED_FLAT, TRACED_SHARP = (
    sum_of(Term(each * TURN, f"{BESIDE}, times {each:g}")) for each in (FLAT_SLOPE, SHARP_SLOPE)
)
BELOW = sum_of(
    roundings(4.0 * 16.0 * POINT, "of a point, times 16 by the lobes above, in four values"),
    FAST_ARC_COSINE,
)
VIEWS, PIXELS = 8, 1 << 12  # of a case, and of a picture of them
NOISE = sum_in(
    Quantity.ALBEDO,
    Term(
        5.0 * 0.01 / math.sqrt(PIXELS / VIEWS),
        "five standard errors of the mean of 512 pixels of 64 paths, each off by 0.01 rms",
    ),
)
PASSED = given(
    2e-3, Quantity.ALBEDO, "testrender's tables of albedos, off by 1e-3 for a white dielectric"
)
INTEGRAL = sum_in(
    Quantity.ALBEDO,
    SHARP.term("an average of values"),
    Term(1.2e-3, "32 x 32 nodes, those next to the view moved by up to 0.08"),
)
LIGHT = sum_in(Quantity.LIGHT, INTEGRAL.term("an integral of values"), PASSED.term("a throughput"))


class RenderedSamples(Samples):
    """Pairs that a renderer shows, and inputs that it takes.

    Both cosines are at least RIM, and no lobe is so sharp that the place of a pixel counts. A roughness is at
    most 1, as OSL's stdosl.h has it, a weight is not negative, and there is no occlusion.
    """

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        shown = (self._plain(batch.where(_is_shown(batch))) for batch in super().batches)
        return tuple(batch for batch in shown if len(batch.wo))

    @cached_property
    def views(self) -> tuple[Batch, ...]:
        """Few views of the random pairs: each has its share of the paths."""
        return (super().views[0].first(self.counts.albedos),)

    @cached_property
    def edges(self) -> Batch:
        edges = super().edges
        return self._plain(edges.where(_is_shown(edges)))

    @cached_property
    def mirrored(self) -> tuple[Batch, Batch]:
        first, second = super().mirrored
        shown = _is_shown(first) & _is_shown(second)
        return self._plain(first.where(shown)), self._plain(second.where(shown))

    @cached_property
    def integrated(self) -> tuple[Batch, Array]:
        """Views of which the nodes next to them are smooth."""
        batch, weights = super().integrated
        nodes = weights.shape[1]
        height = batch.wo[::nodes, 2]
        oblique = height * np.sqrt(1.0 - height * height) >= OBLIQUE
        return batch.where(np.repeat(oblique, nodes)), weights[oblique]

    def taken(self, inputs: Mapping[str, Array]) -> dict[str, Array]:
        taken = {**inputs}
        taken.pop("occlusion", None)
        if "weight" in taken:
            taken["weight"] = np.maximum(taken["weight"], 0.0)
        least = 0.0 if self.spec.model in SMOOTH else LEAST_TURNED
        rough = [name for name in taken if name.endswith("roughness")]
        return taken | {name: np.clip(taken[name], least, 1.0) for name in rough}

    def _plain(self, batch: Batch) -> Batch:
        return replace(batch, inputs=self.taken(batch.inputs))


class LobeSamples(RenderedSamples):
    """Random pairs far from the rim, with colors and roughnesses of a lobe below others."""

    whole = True

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        rng, count = generator(), self.counts.few
        inputs = self.taken(self.spec.random_inputs(rng, count))
        batch = Batch(directions(rng, count), directions(rng, count), inputs)
        return (batch.where(_is_shown(batch, LOBE_RIM)),)


# Nodes of pbrlib without a closure of their own in renderers.
WITHOUT_CLOSURE = (HairSpec, SubsurfaceSpec, FilmSpec, TransmissionSpec)


class Rendered(Evaluating):
    """OSL's testrender, whose own closures light a point."""

    families: ClassVar[Families] = (DiffuseSpec, PbrSpec)
    others: ClassVar[Families] = (HairSpec, FilmSpec, TransmissionSpec)
    sampled, fewer, unlit = RenderedSamples, FEW_RENDERED, (Spec,)
    variants: ClassVar[Mapping[str, tuple[Variant[Scattering], ...]]] = BSDL_VARIANTS
    flat: ClassVar[Tolerance] = FLAT
    sharp: ClassVar[Tolerance] = SHARP

    def judged(self) -> Spec:
        return _with_variants(type(self), self.spec)

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        flat = isinstance(spec, ScatteringSpec) and spec.flat
        value = cls.flat if flat else cls.sharp
        if quantity in ("retroreflection", "anisotropy"):
            return largest(spec.errors[quantity], cls.place) if cls.place else spec.errors[quantity]
        own = {
            "value": value,
            "reciprocity": value,
            "albedo": NOISE,
            "throughput": PASSED,
            "integral": INTEGRAL,
            "light": LIGHT,
            "lambert": cls.flat,
            "frame": None,
        }
        return own.get(quantity, spec.errors.get(quantity))

    place: ClassVar[Tolerance | None] = None  # error of values of microfacets by a pixel's place

    def direct(self, batch: Batch) -> Array:
        """Values, where need be of a pair that is shown next to the one that is not."""
        return super().direct(replace(batch, wi=apart(batch.wo, batch.wi)))


class Traced(Rendered):
    """Cycles, whose closures of pbrlib's nodes light a point; pictures show the diffuse ones."""

    families, others = (PbrSpec,), WITHOUT_CLOSURE
    variants = CYCLES_VARIANTS
    flat, sharp, place = TRACED_FLAT, TRACED_SHARP, TRACED_SHARP


class LobesBelow(Evaluating):
    """The diffuse lobe of a surface shader, told apart from what lies over it; see SurfaceLobe."""

    families, others = (SurfaceLobe,), ()
    sampled, fewer, any_pairs = LobeSamples, FEW_RENDERED, False

    def direct(self, batch: Batch) -> Array:
        assert isinstance(self.spec, SurfaceLobe)
        ports = {name: port for name, port in self.spec.ports.items() if port}

        def lit(batch: Batch) -> Array:
            inputs = {port: batch.inputs[name] for name, port in ports.items()}
            return self.evaluate(replace(batch, inputs=inputs), "direct")

        return diffuse_alone(lit, batch)


class RenderedLobes(LobesBelow):
    """The same on testrender."""

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        return BELOW if quantity == "value" else None


def diffuse_alone(show: Callable[[Batch], Array], batch: Batch) -> Array:
    """Values of the diffuse lobe of what is shown, without those over it; see SurfaceLobe."""
    others = show(batch.altered(color=BLACK))
    lambert = show(batch.altered(color=WHITE, roughness=0.0)) - others
    with np.errstate(divide="ignore", invalid="ignore"):  # a shader that stays black has no value
        return (show(batch) - others) / lambert * batch.wi[:, 2:]


@lru_cache(maxsize=16)
def _with_variants(backend: type[Rendered], spec: Spec) -> Spec:
    """A spec with the functions of a renderer among those that may explain its values."""
    if not isinstance(spec, PbrSpec) or spec.row.name not in backend.variants:
        return spec
    variants = (*backend.variants[spec.row.name], *spec.row.variants)
    return replace(spec, row=replace(spec.row, variants=variants))


def _is_shown(batch: Batch, rim: float = RIM) -> Mask:
    """Which pairs of a batch a renderer shows."""
    least = np.minimum(batch.wo[:, 2], np.abs(batch.wi[:, 2]))
    return np.asarray(visible(batch.wo, batch.wi) & (least >= rim))


# Hosts that render pictures: the lit points of a sphere are the pairs.

# Colors and roughnesses of the pictures that stand for a rough diffuse node.
PICTURE_INPUTS: tuple[Values, ...] = (
    {"color": (0.2, 0.5, 0.8), "roughness": 1.0},
    {"color": (0.8, 0.4, 0.1), "roughness": 0.5, "weight": 0.5},
)
PICTURE_SIZE = 128
HALF_CUT = Term(2.0**-10, "half floats, cut off")  # as llvmpipe does
# A ray's point is off by an angle, by which the logarithm of a lobe changes at most so many times as fast:
# twice 1 / alpha of a distribution, whose alpha is at least 0.4, and 3 for Fresnel, shadowing and the cosine.
LOBE_SLOPE = 2.0 / 0.4 + 3.0
# In each of two cosines of at least 0.05 five roundings, times 20 by s / t, and times 2 by s and the cosine.
EXACT = sum_in(
    Quantity.DIFFERENCE,
    roundings(28, "(14, of numbers up to 2)"),
    roundings(2 * 5 * (1.0 / RIM + 2.0), "(five in each of two cosines, times 22)"),
)
EXACT_ALBEDO = sum_in(Quantity.ALBEDO, roundings(21 * 1.02, "of numbers up to 1.02"))
HALF = Tolerance((HALF_CUT, *EXACT.terms), "relative", relative, exact=True)
HALF_ALBEDO = sum_in(
    Quantity.ALBEDO,
    Term(2.0 * HALF_CUT.value, "half floats of map and picture, cut off"),
    EXACT_ALBEDO.term("roundings"),
    exact=True,
)
DRAWN_LOBE = LOBE_VALUE.plus(
    roundings(16 / LOBE_RIM**2, "of a pixel's point, over the square of the least cosine, 1/4")
)
HALF_FOUR = "half floats in four pictures, 48 times as large, half of them alike"
HALF_LOBE = sum_in(
    Quantity.DIFFERENCE, Term(96.0 * HALF_CUT.value, HALF_FOUR), *DRAWN_LOBE.terms, exact=True
)


# A point is a ray's origin plus its length, both at most 2: three roundings of 2^-23 together. A ray that
# grazes divides them by its cosine, and cos(theta_i), relative to itself, by the other.
CYCLES_RAY = sum_of(
    roundings(3.0 * 2.0 / RIM**2, "of a pixel's point, over the least cosine squared"),
    Term(1e-5, "a roughness that counts as 0"),
    quantity=Quantity.RELATIVE,
    metric=relative,
)
# Of 256 samples each. Measured over seeds 0 to 15 at roughness 1 and reflectance 1: a pixel is off by 1.3e-3
# rms, and the mean of 3212 has a standard deviation of 3.1e-5, 1.34 times that of independent ones.
CYCLES_NOISE = sum_of(
    Term(
        4.0 * 1.4 * 1.3e-3 / math.sqrt(12_836),
        "four standard errors of the mean of 12836 pixels, each off by 1.3e-3, times 1.4",
    ),
    quantity=Quantity.MEAN_ALBEDO,
    metric=mean_error,
)


class PictureSamples(Samples):
    """The lit points of a sphere away from rim and terminator, for each light and material."""

    whole = True

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        pictures = self.backend
        batches = (
            pictures.batch(replace(scene, size=pictures.size), inputs)
            for scene in pictures.scenes
            for inputs in pictures.materials
        )
        return tuple(batch for batch in batches if len(batch.wo))

    @cached_property
    def views(self) -> tuple[Batch, ...]:
        """The points in a white environment."""
        scene = replace(FURNACE, size=self.backend.size)
        return tuple(self.backend.batch(scene, inputs) for inputs in self.backend.materials)


def errors_of(value: Tolerance, albedo: Tolerance) -> Mapping[str, Tolerance]:
    """Errors of pictures of a rough diffuse node."""
    return {
        "value": value,
        "albedo": albedo,
        "lambert": value,
    }


class Pictures(Backend):
    """A host that renders pictures of a sphere."""

    errors: ClassVar[Mapping[str, Tolerance]] = {}  # instead of those of the spec, if there are any
    scenes: ClassVar[tuple[Scene, ...]] = (SIDE, FRONT, BACK)
    sampled: ClassVar[type[Samples]] = PictureSamples
    any_pairs = False

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        return (cls.errors or spec.errors).get(quantity)

    @property
    def size(self) -> int:
        if isinstance(self.spec, (SurfaceLobe, EmissionSpec)):
            return PICTURE_SIZE // 4  # the shaders are long, or every pixel of one view is alike
        return PICTURE_SIZE // 2 if isinstance(self.spec, PbrSpec) else PICTURE_SIZE

    @property
    def materials(self) -> Sequence[Values]:
        if isinstance(self.spec, (PbrSpec, EmissionSpec)):
            return self.spec.materials
        names = {"color", "roughness", *self.spec.names}
        return [
            {name: value for name, value in inputs.items() if name in names}
            for inputs in PICTURE_INPUTS
        ]

    def batch(self, scene: Scene, inputs: Values) -> Batch:
        wo, wi, mask = self.points(scene)
        return Batch(wo[mask], wi[mask], inputs, scene)

    def points(self, scene: Scene) -> Pairs:
        """Directions at the points of a picture, and the mask of the points to judge."""
        wo, wi, mask = picture_pairs(scene)
        if isinstance(self.spec, LobeSpec) and self.spec.side < 0.0 and scene.light is not None:
            mask = (wo[:, 2] >= RIM) & (wi[:, 2] <= -RIM)
        if isinstance(self.spec, SurfaceLobe):  # an error in position is divided twice
            mask = mask & (np.minimum(wo[:, 2], wi[:, 2]) >= LOBE_RIM)
        return wo, wi, mask

    def portrait(self, scene: Scene) -> tuple[Array, Array, Mask, Mask]:
        return *self.points(scene), sphere(scene.size).mask

    def direct(self, batch: Batch) -> Array:
        alone = isinstance(self.spec, SurfaceLobe)
        return diffuse_alone(self.picture, batch) if alone else self.picture(batch)

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """Values in the batch's own environment."""
        return self.picture(batch)

    def picture(self, batch: Batch) -> Array:
        scene = scene_of(batch)
        values = self.host.picture(self.shader_of(batch.inputs), scene)[sphere(scene.size).mask]
        return values[self.points(scene)[2]].astype(np.float64)

    def shader_of(self, inputs: Values) -> Shader:
        return _compile(self.host, self.spec.document(inputs), self.library)


@lru_cache(maxsize=8)  # a check makes many pictures of a few documents
def _compile(host: Host, text: str, library: str) -> Shader:
    from mxeon.shaders.generation import ApproximationWarning  # which loads MaterialX

    with warnings.catch_warnings():  # approximations are not judged: see CyclesPictures.points
        warnings.simplefilter("ignore", ApproximationWarning)
        return host.compile(text, library=library)[0]


def scene_of(batch: Batch) -> Scene:
    assert batch.scene is not None
    return batch.scene


@lru_cache(maxsize=8)
def picture_pairs(scene: Scene) -> Pairs:
    """Directions at the points of the sphere, and the mask of the points to judge."""
    points = sphere(scene.size)
    return lit_pairs(points.normal[points.mask], scene)


def lit_pairs(normal: Array, scene: Scene) -> Pairs:
    """Directions at points with normals in a picture, and the mask of the points to judge."""
    wo = local_directions(normal, VIEW)
    wi = wo if scene.light is None else local_directions(normal, scene.light)
    return wo, wi, (wo[:, 2] >= RIM) & (wi[:, 2] >= RIM)


class CyclesPictures(Pictures):
    """Cycles's pictures of a rough diffuse node, whose closure is its own."""

    errors = errors_of(CYCLES_RAY, CYCLES_NOISE)
    families = (DiffuseSpec,)

    def points(self, scene: Scene) -> Pairs:
        """The points for which the host has a closure that can be the model."""
        wo, wi, mask = super().points(scene)
        if front_lit_only(self.host.name, self.spec.model):
            mask = mask & (wo[:, 0] * wi[:, 0] + wo[:, 1] * wi[:, 1] >= 0.0)
        return wo, wi, mask


class Drawn(Pictures):
    """Pictures of a sphere whose points and light have no error but rounding."""

    families = (PbrSpec, DiffuseSpec, SurfaceLobe)
    others = (*WITHOUT_CLOSURE, CombinedSpec)
    errors = errors_of(EXACT, EXACT_ALBEDO)
    lobe: ClassVar[Tolerance] = DRAWN_LOBE

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        if isinstance(spec, DiffuseModelSpec):
            own = {"value": cls.lobe} if isinstance(spec, SurfaceLobe) else cls.errors
            return own.get(quantity)
        if quantity not in ("value", "albedo"):
            return None
        return cls.drawn(spec.errors.get(f"picture {quantity}", spec.errors[quantity]))

    @classmethod
    def drawn(cls, error: Tolerance) -> Tolerance:
        """Error of a node's picture with exact points, of its value or albedo."""
        points = roundings(LOBE_SLOPE * 2 * 5 / RIM, "of two cosines of at least 0.05, times 8")
        return sum_of(error.term("a number"), points, quantity=error.quantity)


class Half(Drawn):
    """The same on a host that keeps colors as half floats: Storm, whose modes are the default ones."""

    errors = errors_of(HALF, HALF_ALBEDO)
    lobe: ClassVar[Tolerance] = HALF_LOBE

    @classmethod
    def supports(cls, spec: Spec) -> bool:
        return super().supports(spec) and spec.model != "zeltner"

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        if quantity == "albedo" and isinstance(spec, PbrSpec):
            return None  # its furnace has another sum of directions
        return super().error(spec, quantity)

    @classmethod
    def drawn(cls, error: Tolerance) -> Tolerance:
        drawn = super().drawn(error)
        return replace(drawn, terms=(drawn.term("a drawn number"), HALF_CUT), exact=True)

    @property
    def unset(self) -> tuple[str, ...]:
        """Inputs later than MaterialX 1.39.3, which Storm has."""
        return ("retroreflective",)


# A pixel's point is off by three roundings of 2^-23, over a cosine of 0.05.
PICTURE_RADIANCE = sum_of(
    roundings(5 * 6 / RIM, "of a pixel's point, over the least cosine, times the slope 5"),
    roundings(8),
    quantity=Quantity.RADIANCE,
)


class DarkPictures(Pictures):
    """An emitting surface in the dark, one picture for each material of its samples."""

    families, sampled = (EmittingSurface,), Samples


class EmissionPictures(Pictures):
    """An EDF node on a sphere in the dark."""

    scenes, families = (Scene("dark"),), (EmissionSpec,)
    errors: ClassVar[Mapping[str, Tolerance]] = {"value": PICTURE_RADIANCE}

    def shader_of(self, inputs: Values) -> Shader:
        return self.implemented(self.spec.document(inputs))


class UtilitySamples(Samples):
    """All samples in one batch, which takes a renderer one run."""

    whole = True

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        return (joined(super().batches),)


class UtilityOsl(Evaluating):
    """Outputs of a utility node on a renderer with OSL, which has mathematics of its own."""

    families, sampled, any_pairs = (UtilitySpec,), UtilitySamples, False

    @classmethod
    def error(cls, spec: Spec, quantity: str) -> Tolerance | None:
        return spec.errors.get(f"{quantity} in OSL", spec.errors.get(quantity))


# By the word of a host's row for how it is asked; the first that supports a spec asks for it. `mxeon.survey`
# adds those of renderers with materials of their own.
BACKENDS: dict[str, tuple[type[Backend], ...]] = {
    "pairs": (Evaluating, LobesBelow, DarkPictures),
    "closures": (Closures,),
    "rendered": (Rendered, RenderedLobes),
    "pictures": (CyclesPictures, Traced, EmissionPictures, InTheDark, DarkPictures, UtilityOsl),
    "drawn pictures": (Drawn,),
    "half pictures": (Half,),
}


def ways_of(host: str) -> tuple[type[Backend], ...]:
    """How a host is asked; () where only the text of its target is checked."""
    own_nodes(host)  # adds a renderer's backends
    return BACKENDS.get(host_row(host).way, ())


def own_nodes(host: str) -> tuple[Spec, ...]:
    """Nodes of a host's own that are judged; none for a host of generated shaders."""
    nodes = host_row(host).nodes
    return tuple(nodes(host)) if nodes else ()


def backend_of(host: str, spec: Spec) -> type[Backend] | None:
    """How a host is asked about a node; None if it is not."""
    return next((way for way in ways_of(host) if way.supports(spec)), None)
