# SPDX-License-Identifier: Apache-2.0
"""Checks of a lobe: its values and albedos, its frame, its inputs, its edges, and its energy; of two; and of hair."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TypeGuard

import numpy as np

from mxeon.conformance import diagnosis
from mxeon.conformance.backends import WHITE, scene_of
from mxeon.conformance.case import BRANCHES, Case, dead_inputs, edge_values, frames
from mxeon.conformance.check import (
    check,
    drop_changes,
    gray,
    of_family,
    offset,
    pass_all,
    scale,
    scale_cosine,
    shifted,
    take_response,
    with_inputs,
    with_values,
)
from mxeon.conformance.diagnosis import (
    ALBEDO,
    THROUGHPUT,
    TRANSMISSION,
    VALUE,
    Comparison,
    defect,
    explain,
)
from mxeon.conformance.diagnosis.faults import DIRECT_FAULTS
from mxeon.conformance.results import Cause, Diagnosis, Kind
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import (
    LEAST_COLOR82,
    SKY_ROWS,
    SLOPE,
    Array,
    Batch,
    Candidate,
    Values,
    float32,
    sky_map,
)
from mxeon.conformance.spec import Spec
from mxeon.conformance.specs.combinations import SINGLE, CombinedSpec
from mxeon.conformance.specs.diffuse import DiffuseModelSpec, SurfaceLobe
from mxeon.conformance.specs.emission import EmissionSpec, MediumSpec
from mxeon.conformance.specs.hair import REGION, REGIONS, HairSpec
from mxeon.conformance.specs.lobes import PbrSpec, ScatteringSpec
from mxeon.conformance.specs.microfacets import FacetSpec, FilmSpec, TransmissionSpec
from mxeon.conformance.specs.subsurface import ON_SPHERES, RINGS, SubsurfaceSpec, inner, spread
from mxeon.conformance.specs.surface_shaders import SurfaceShaderSpec
from mxeon.conformance.specs.utilities import UtilitySpec
from mxeon.conformance.tolerance import (
    Compared,
    Measurement,
    Term,
    absolute,
    count_named,
    count_not_finite,
    count_of,
    given,
    roundings,
    scaled,
    sum_in,
)
from mxeon.errors import Implied
from mxeon.hosts import HOSTS, front_lit_only
from mxeon.hosts.calls import NORMAL
from mxeon.io.srgb import srgb_decoded
from mxeon.models.nodes.combinations import FACTOR
from mxeon.models.nodes.lobes import FORMS, TILTED
from mxeon.shaders.methods import Methods

LEAST_LIGHT = 0.01  # of a uniform environment, where the place of an uneven one is asked
# Texels are pi / 128 high and wide, their middles are read, and engines keep filters' weights in eight bits.
TEXEL = math.sqrt(2.0) * math.pi / SKY_ROWS * 2.0**-8
ARC_SINE = 4e-4  # largest error of an engine's arc sine: llvmpipe's, ten times that of others
SURROUNDINGS = sum_in(
    Quantity.IRRADIANCE,
    Term(SLOPE * TEXEL, "2^-8 of a texel, times the slope of the map, 1/2"),
    Term(SLOPE * ARC_SINE, "an engine's arc sine, times the slope"),
    Term(2.0**-11, "half floats"),
)
ZERO = given(0.0, Quantity.DIFFERENCE, "a product with 0 is 0 in any precision")
OPAQUE = sum_in(Quantity.THROUGHPUT, roundings(1, "of 1 - weight"))


ROUGH = ("eon", "eon_fitted", "qon", "fon")
MODES = ("eon", "eon_fitted", "qon")  # of which a node is one
EON = ("eon", "eon_fitted")
BURLEY = ("burley", "burley_lambert")


def is_model(spec: Spec, *names: str) -> TypeGuard[DiffuseModelSpec]:
    return isinstance(spec, DiffuseModelSpec) and spec.model in names


def is_plain(spec: Spec) -> TypeGuard[PbrSpec]:
    """Whether a spec is one lobe of pbrlib by itself, without a film, that transmits to no environment."""
    others = (CombinedSpec, FilmSpec, TransmissionSpec)
    return isinstance(spec, PbrSpec) and not isinstance(spec, others)


def is_lobe(spec: Spec) -> bool:
    return is_plain(spec) or is_model(spec, *BURLEY)


def is_judged(spec: Spec) -> bool:
    """Whether a spec is one lobe of a node or of a renderer, also under a film."""
    return is_lobe(spec) or isinstance(spec, FilmSpec) or is_model(spec, *ROUGH)


def is_node(spec: Spec) -> bool:
    """Whether a spec is a node, and not the lobe of a surface shader."""
    return not isinstance(spec, SurfaceLobe)


def is_reciprocal(spec: Spec) -> bool:
    own = is_plain(spec) and spec.row.reciprocal and not isinstance(spec, SubsurfaceSpec)
    return own or is_model(spec, *ROUGH, "lambert", "burley")


def is_opaque(spec: Spec) -> bool:
    """Whether a node lets no light through to what lies below."""
    return (is_plain(spec) and not spec.row.layerable) or is_model(spec, *MODES)


def shows_exactly(spec: Spec, host: str) -> bool:
    """Whether a host has directions to the last bit, those on the horizon too; closures have no film of index 0."""
    others = ("rendered", "pictures", *["closures"] * isinstance(spec, FilmSpec))
    return all(row.way not in others for row in HOSTS if row.name == host)


def finds_albedo(spec: Spec, methods: Methods) -> bool:
    """Whether the environment branch returns an albedo that is known.

    With a prefiltered environment films and surface shaders carry the errors of MaterialX's fit.
    """
    fitted = isinstance(spec, (FilmSpec, SurfaceShaderSpec))
    return methods.environment == "fis" or (methods.environment == "prefilter" and not fitted)


def has_environment(spec: Spec, host: str) -> bool:
    """Whether a host has the spec's model for all pairs, as an environment needs."""
    return not front_lit_only(host, spec.model)


@check(lambda spec: is_node(spec) and is_judged(spec), gray, VALUE, open=True)
def value() -> None:
    """The value matches the model for every pair of directions, including back-lit and grazing ones."""


@check(lambda spec: is_model(spec, "lambert") or not is_node(spec), gray, VALUE)
def lobe() -> None:
    """The diffuse lobe of the surface shader matches the model."""


@check(
    lambda spec: is_judged(spec) or is_model(spec, "lambert"),
    gray,
    ALBEDO,
    open=True,
    hosts=has_environment,
    methods=finds_albedo,
)
def environment() -> None:
    """The environment branch returns the directional albedo."""


@check(
    lambda spec: is_model(spec, *EON),
    with_inputs("reflectance is 0.99", color=(0.99, 0.99, 0.99)),
    ALBEDO,
    hosts=has_environment,
    methods=finds_albedo,
)
def furnace(case: Case) -> Iterator[Compared]:
    """A white surface disappears in a white environment."""
    for batch in case.views:
        white = batch.altered(color=WHITE, weight=1.0)
        yield Compared(white, case.albedo(white), np.ones((1, 3)))


@check(
    lambda spec: (
        (is_plain(spec) and bool(spec.black))
        or (is_model(spec, *ROUGH, "lambert", "burley") and is_node(spec))
    ),
    offset,
    tolerance=ZERO,
)
def black(case: Case) -> Iterator[Compared]:
    """A black surface scatters nothing."""
    spec = case.of(ScatteringSpec)  # type: ignore[type-abstract]
    for batch in case.few:
        batch = batch.altered(**spec.black)
        yield Compared(batch, case.direct(batch), np.zeros((1, 3)))


@check(
    lambda spec: (is_lobe(spec) and not isinstance(spec, SubsurfaceSpec)) or is_model(spec, *MODES),
    with_inputs("the node's normal is dropped", normal=(0.0, 0.0, 1.0)),
    diagnose=diagnosis.diagnose_frame,
)
def frame(case: Case) -> Iterator[Compared]:
    """The value follows the surface's frame, with the normal turned toward the viewer."""
    return frames(case)


def diagnose_surroundings(case: Case) -> Diagnosis:
    return diagnosis.diagnose_surroundings(surroundings(case), SURROUNDINGS)


@check(
    lambda spec: (
        (is_plain(spec) and not isinstance(spec, FacetSpec)) or is_model(spec, *MODES, "burley")
    ),
    with_inputs("the node's normal is dropped", normal=(0.0, 0.0, 1.0)),
    tolerance=SURROUNDINGS,
    pairs=True,
    lit=True,
    diagnose=diagnose_surroundings,
    methods=lambda spec, methods: methods.environment != "none",
)
def surroundings(case: Case) -> Compared:
    """An uneven environment is looked up along the viewer-facing normal, or along its opposite for translucent nodes."""
    batch = case.samples.turned
    if "color" in batch.inputs:
        batch = batch.altered(color=WHITE)
    level = case.albedo(batch)
    bright = level.min(axis=1) > LEAST_LIGHT
    if bright.any():  # or what is dark is wrong
        batch, level = batch.where(bright), level[bright]
    with np.errstate(divide="ignore", invalid="ignore"):
        measured = case.albedo(batch, sky_map()) / level
    spec = case.of(ScatteringSpec)  # type: ignore[type-abstract]
    return Compared(batch, measured, spec.sky(batch))


def diagnose_sphere(case: Case) -> Diagnosis:
    return explain(case, list(sphere(case)), ON_SPHERES, (), RINGS)


ON_SPHERE = with_inputs("the mean free path is 0.3 in every channel", radius=(0.3, 0.3, 0.3))


@check(of_family(SubsurfaceSpec), ON_SPHERE, lit=True, diagnose=diagnose_sphere)
def sphere_mean(case: Case) -> Iterator[Compared]:
    """On average, a sphere reflects the share of light that the profile predicts."""
    return sphere(case)


@check(of_family(SubsurfaceSpec), ON_SPHERE, lit=True, diagnose=diagnose_sphere)
def sphere(case: Case) -> Iterator[Compared]:
    """On a sphere, light spreads as the diffusion profile predicts from radius and anisotropy."""

    def picture(batch: Batch) -> Array:
        scene = scene_of(batch)
        [shader] = case.host.compile(case.spec.document(batch.inputs), library=case.library)
        return case.host.picture(shader, scene)[inner(scene.size)].astype(np.float64)

    for batch in case.samples.take(case.of(SubsurfaceSpec).spheres):
        yield Compared(batch, case.measured(picture, batch), spread(batch))


def in_srgb(case: Case) -> Iterator[Compared]:
    """Values of colors in sRGB, against the engine's own of what they stand for."""
    batch, evaluating = case.few[0].first(case.samples.counts.albedos), case.evaluating
    ask = partial(evaluating.evaluate, branch="direct", shader=evaluating.decoded)
    yield Compared(batch, np.pi * case.measured(ask, batch), of_decoded(case, batch))


def of_decoded(case: Case, batch: Batch) -> Array:
    linear = float32(srgb_decoded(batch.inputs["color"]))
    return case.backend.direct(batch.altered(color=linear))


COLOR_SPACE = Comparison(
    "color_space",
    in_srgb,
    lambda case: (
        Candidate("the color, decoded from sRGB", partial(of_decoded, case)),
        Candidate("the color, not decoded from sRGB", case.backend.direct),
    ),
)


@check(lambda spec: isinstance(spec, ScatteringSpec) and spec.flat, gray, COLOR_SPACE, pairs=True)
def color_space() -> None:
    """A color in sRGB has the value of the linear color that it stands for."""


# Outputs that an opaque node of weight 1 has none of, and their branches.
NOTHING = (*product(["throughput"], BRANCHES), *product(["response"], ["transmission", "emission"]))


def opaque_values(case: Case, output: str, branch: str) -> Iterator[Compared]:
    """An output of an opaque node, whose throughput is 1 - weight; hair has no weight."""
    for batch in case.few:
        weight = np.array(np.broadcast_to(batch.inputs.get("weight", 1.0), len(batch.wo)))
        if "weight" in batch.inputs:
            weight[0] = 2.0  # above 1 a lobe is opaque, and no more
            batch = batch.altered(weight=weight)
        values = case.evaluating.evaluate(case.inputs(batch), branch, output)
        left = 1.0 - np.clip(weight, 0.0, 1.0) if output == "throughput" else 0.0 * weight
        expected = np.repeat(left[:, np.newaxis], 3, axis=1)
        yield Compared(batch, case.throughputs(batch, values), expected)


@check(
    is_opaque,
    take_response,
    tolerance=OPAQUE,
    pairs=True,
    lit=True,
    diagnose=lambda case: diagnosis.diagnose_throughput(
        {each: list(opaque_values(case, *each)) for each in NOTHING}
    ),
)
def throughput(case: Case) -> Iterator[Compared]:
    """An opaque node passes 1 - weight of the light from below in every branch, and no other light."""
    return (each for row in NOTHING for each in opaque_values(case, *row))


@check(is_reciprocal, scale_cosine("the value has an extra factor cos(theta_o)", 1))
def reciprocity(case: Case) -> Iterator[Compared]:
    """Exchanging the two directions does not change the BRDF.

    f(wo, wi) against f(wi, wo), both times both cosines.
    """
    for batch in case.few:
        side = -1.0 if np.all(batch.wi[:, 2] <= 0.0) else 1.0  # light through the surface
        swapped = replace(batch, wo=side * batch.wi, wi=side * batch.wo)
        with np.errstate(invalid="ignore"):  # inf x 0 is NaN, which `absolute` notices
            forward = case.direct(batch) * batch.wo[:, 2:]
            backward = case.direct(swapped) * np.abs(batch.wi[:, 2:])
        yield Compared(batch, forward, backward)


@check(lambda spec: is_model(spec, *MODES), with_inputs("roughness is 0.1", roughness=0.1))
def lambert(case: Case) -> Iterator[Compared]:
    """At roughness 0 the node is Lambert."""
    for batch in case.few:
        batch = batch.altered(roughness=0.0)
        yield Compared(batch, case.direct(batch), case.expected(batch))


@check(
    lambda spec: (
        (is_node(spec) and (is_lobe(spec) or is_model(spec, *ROUGH, "lambert")))
        or isinstance(spec, (CombinedSpec, EmissionSpec, MediumSpec, UtilitySpec))
    ),
    drop_changes,
    tolerance=count_of(Quantity.INPUTS),
    diagnose=diagnosis.diagnose_inputs,
)
def inputs(case: Case) -> Measurement:
    """Every input of the node changes the value."""
    return count_named(dead_inputs(case))


@check(
    lambda spec: is_lobe(spec) or is_model(spec, *MODES) or isinstance(spec, FilmSpec),
    scale_cosine("the value is divided by cos(theta_o)", -1),
    tolerance=count_of(Quantity.VALUES),
    pairs=True,
    hosts=shows_exactly,
    diagnose=diagnosis.diagnose_finite,
)
def finite(case: Case) -> Measurement:
    """Every value at the edges of the domain is finite."""
    return count_not_finite(edge_values(case))


# --- energy: what a lobe scatters in all, what it lets through, and both of two lobes together ----

ROUNDED = 1e-9  # difference of two albedos that are the same


def is_layer(spec: Spec) -> TypeGuard[PbrSpec]:
    """Whether a node lets 1 - E through to what lies below."""
    return is_plain(spec) and spec.row.layerable


def reads(name: str) -> Callable[[Spec], bool]:
    """Whether a layer is one of an input of a name."""
    return lambda spec: is_layer(spec) and name in spec.row.inputs


@check(
    lambda spec: is_layer(spec) or (isinstance(spec, FilmSpec) and spec.row.layerable),
    pass_all,
    THROUGHPUT,
)
def layering() -> None:
    """The throughput of a layer of albedo E is 1 - E for light from above, for every weight."""


@check(is_layer, pass_all, TRANSMISSION)
def transmission() -> None:
    """The throughput of a layer is 1 - E for light that comes through the base, too."""


@check(reads("color82"), pass_all, pairs=True, lit=True, diagnose=THROUGHPUT.diagnose)
def dip(case: Case) -> Iterator[Compared]:
    """Where color82 lowers the reflectance, the layer passes on what it does not reflect."""
    dipped = (LEAST_COLOR82,) * 3
    white: Values = {"color0": WHITE, "color90": WHITE, "color82": dipped, "exponent": 5.0}
    return (_passed(case, batch.altered(**white)) for batch in case.views)


@check(reads("tint"), pass_all, pairs=True, lit=True, diagnose=THROUGHPUT.diagnose)
def denser(case: Case) -> Iterator[Compared]:
    """For indices below 1, where facets reflect totally, the throughput is 1 - E, too."""
    for batch in case.views:
        inverse = batch.altered(ior=1.0 / np.asarray(batch.inputs["ior"]), tint=WHITE)
        yield _passed(case, inverse)


def _passed(case: Case, batch: Batch) -> Compared:
    """Throughput at full weight against 1 - E."""
    full = batch.altered(weight=1.0)
    passed = np.maximum(1.0 - case.expected_albedo(full), 0.0)
    return Compared(full, case.throughput(full, "direct"), passed)


@check(is_layer, pass_all, "light", diagnose=THROUGHPUT.diagnose)
def layer(case: Case) -> Compared:
    """A layer over a white base returns all light."""
    views, albedo = integrals(case)
    total = albedo + case.throughput(views, "direct")
    # Where the equations gain energy by themselves, no throughput makes up for it.
    own = case.lobe.albedo(views)
    sound = np.asarray((case.samples.integrals <= own + ROUNDED).all(axis=1))
    return Compared(views, total, np.ones_like(total)).where(sound)


@check(
    lambda spec: is_lobe(spec) or is_model(spec, *MODES),
    scale("values are 2 % too large", 1.02),
    open=True,
)
def integral(case: Case) -> Compared:
    """Values integrate to the directional albedo that the equations give."""
    views, albedo = integrals(case)
    return Compared(views, albedo, case.samples.integrals)


@check(is_lobe, scale("values are 100 times as large", 100.0), "integral")
def energy(case: Case) -> Compared:
    """No albedo exceeds 1 or what the equations give."""
    views, albedo = integrals(case)
    allowed = np.maximum(1.0, case.samples.integrals)
    return Compared(views, np.maximum(albedo, allowed), allowed)


def integrals(case: Case) -> tuple[Batch, Array]:
    """Views of the integrated materials, and their albedos from the host's values, (N, 3)."""
    return summed(case, *case.samples.integrated)


def summed(case: Case, batch: Batch, weights: Array) -> tuple[Batch, Array]:
    """Views of materials in many directions of light, and their albedos, (N, 3)."""
    count, nodes = weights.shape
    values = case.direct(batch).reshape(count, nodes, 3)
    albedo = (weights[..., np.newaxis] * values).sum(axis=1)
    return batch.where(np.arange(count) * nodes), albedo


# --- two lobes combined ------------------------------------------------------------------------

is_combined = of_family(CombinedSpec)


@check(is_combined, shifted, VALUE, pairs=True)
def combination() -> None:
    """Two combined lobes have the value that the node's equation gives."""


@check(is_combined, shifted, ALBEDO, pairs=True, methods=finds_albedo)
def combined_albedo() -> None:
    """The environment branch of two combined lobes returns their albedo."""


@check(is_combined, pass_all, THROUGHPUT, open=True)
def combined_throughput(case: Case) -> Iterator[Compared]:
    """Two combined lobes pass on what they do not scatter, as the layer equation requires.

    A negative throughput counts as 0, as `layer` takes it.
    """
    for compared in THROUGHPUT(case):
        yield compared._replace(measured=np.maximum(compared.measured, 0.0))


@check(
    lambda spec: spec.model in SINGLE,
    with_values(
        "values are multiplied twice",
        lambda batch, values: values * np.reshape(batch.inputs[FACTOR], (len(values), -1)),
    ),
    pairs=True,
    open=True,
    diagnose=replace(defect("factor_not_clamped"), permitted=True),
)
def factor(case: Case) -> Iterator[Compared]:
    """Factors are clamped to [0, 1]."""
    for batch, (factor, end) in product(case.few, ((2.0, 1.0), (-1.0, 0.0))):
        beyond, nearest = (
            batch.altered(**{FACTOR: np.full_like(batch.inputs[FACTOR], number)})
            for number in (factor, end)
        )
        yield Compared(beyond, case.direct(beyond), case.direct(nearest))
        passed = (case.throughput(each, "direct") for each in (beyond, nearest))
        yield Compared(beyond, *passed)


# --- hair: its lobes apart, where they are wide, narrow, or seen straight --------------------------

TURN_FIBER = with_inputs(
    "the normal is turned about the fiber by a tenth", normal=(0.0, 0.1, 0.995)
)


def _in_region(key: str, case: Case) -> Compared:
    """Values of a region, and the expected ones."""
    batch = case.of(HairSpec).region(key, case.samples.counts.few)
    return Compared(batch, case.direct(batch), case.expected(batch))


def _explained(key: str, case: Case) -> Diagnosis:
    """The explanation of the values of a region."""
    others = set(FORMS) - {REGIONS[key].form, TILTED}  # which may be the same there
    candidates = [each for each in case.valued.value_candidates if each.title not in others]
    compared = _in_region(key, case)
    brightest = min(float(compared.expected.max()), 1.0)
    terms = (Term(brightest * REGION.value, "a region"),)
    tolerance = replace(REGION, terms=terms, metric=scaled, exact=True)
    return explain(case, [compared], candidates, DIRECT_FAULTS, tolerance)


for _key, _row in REGIONS.items():
    check(
        of_family(HairSpec),
        TURN_FIBER,
        key=_key,
        claim=_row.claim,
        lit=True,
        open=True,
        diagnose=partial(_explained, _key),
    )(lambda case, key=_key: case.valued.alike(_in_region(key, case)))

# --- inputs outside the ranges that the other checks draw from, as far as hosts pass them ---------

PAIRS = 16  # of each value
LEAST_WEIGHT = 0.3  # of weights and occlusions, so that each pair shows it
TOLERANCES = given(1.0, Quantity.TOLERANCES, "the tolerance of each quantity")


def quantities(case: Case, batch: Batch, right: Batch) -> Iterator[tuple[str, Compared]]:
    """Values, albedos and throughputs, each by its name, against those that are expected of other inputs."""
    albedo = case.expected_albedo(right)
    yield "value", Compared(batch, case.direct(batch), case.expected(right))
    yield "albedo", Compared(batch, case.albedo(batch), albedo)
    if is_layer(case.spec):
        passed = case.throughput(batch, "direct")
        yield "throughput", Compared(batch, passed, np.maximum(1.0 - albedo, 0.0))


def outside(case: Case) -> Iterator[tuple[str, str, float, Compared]]:
    """Each quantity of a few pairs for each input and value, but for what is wrong inside the ranges already.

    Values are divided by the largest error that passes.
    """
    spec, views = case.of(PbrSpec), case.samples.views[0]
    row, names = np.arange(len(views.wo))[:, np.newaxis], {"weight", "occlusion"}
    wo = np.where(row == 1, NORMAL, views.wo)
    wi = np.where(row % 2 == 1, wo * [-1.0, -1.0, spec.side], views.wi)  # microfacets reflect most
    seen = {
        name: np.maximum(views.inputs[name], LEAST_WEIGHT) for name in names & views.inputs.keys()
    }
    views = replace(views, wo=wo, wi=wi).altered(**seen)
    plain = replace(case, outputs=lambda batch, values: values)
    wrong = {
        name
        for name, (_, measured, expected) in quantities(plain, views, views)
        if scaled(measured, expected).max() > case.tolerance(name).value
    }
    if len(wrong) == 2 + is_layer(spec):
        inside = f"{spec.title} already fails inside its inputs' usual ranges"
        raise Implied(f"{case.host.name}: not measured, since {inside}")
    batch = views.first(PAIRS)
    for each in spec.bounded:
        for value in each.beyond:
            lit, right = (
                batch.altered(**{each.name: np.full_like(batch.inputs[each.name], number)})
                for number in (value, float(np.clip(value, *each.ends)))
            )
            for name, compared in quantities(case, lit, right):
                if name not in wrong:
                    tolerance = case.tolerance(f"{name} with {each.name} {value:g}", name)
                    scale = tolerance.value * tolerance.scale(compared.expected)
                    yield name, each.name, value, compared.over(scale)


def diagnose_domain(case: Case) -> Diagnosis:
    """The inputs, and the values of each, with which a quantity is wrong."""
    wrong: dict[tuple[str, str], list[float]] = {}
    for quantity, name, value, compared in outside(case):
        if absolute(*compared[1:]).max() > TOLERANCES.value:
            wrong.setdefault((name, quantity), []).append(value)
    return Diagnosis(
        tuple(
            Cause(Kind.DEFECT, f"{quantity}_outside", (name,), tuple(values))
            for (name, quantity), values in wrong.items()
        )
    )


@check(
    lambda spec: (
        isinstance(spec, PbrSpec) and not isinstance(spec, TransmissionSpec) and bool(spec.bounded)
    ),
    scale("values are 30 % too large", 1.3),
    tolerance=TOLERANCES,
    pairs=True,
    lit=True,
    diagnose=diagnose_domain,
)
def domain(case: Case) -> Iterator[Compared]:
    """Inputs outside their usual range have the value, the albedo and the throughput of the model, too."""
    return (compared for *_, compared in outside(case))
