# SPDX-License-Identifier: Apache-2.0
"""Checks of single lobes (values, albedos, frames, inputs, energy), combined lobes, and hair."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import chain, product

import numpy as np

from mxeon.conformance import backends, controls, diagnosis, samples, tolerance
from mxeon.conformance.case import BRANCHES, Case, dead_inputs, edge_values, frames
from mxeon.conformance.check import Check, Specs, family
from mxeon.conformance.diagnosis import ALBEDO, THROUGHPUT, TRANSMISSION, VALUE, Comparison, defect
from mxeon.conformance.diagnosis.faults import DIRECT_FAULTS
from mxeon.conformance.results import Cause, Diagnosis, Kind, Quantity
from mxeon.conformance.samples import Array, Batch, Candidate, Values
from mxeon.conformance.spec import Ability, LobeSpec, Spec
from mxeon.conformance.specs.combinations import SINGLE, CombinedSpec
from mxeon.conformance.specs.diffuse import DiffuseModelSpec, SurfaceLobe
from mxeon.conformance.specs.emission import EmissionSpec, MediumSpec
from mxeon.conformance.specs.hair import REGION, REGIONS, HairSpec
from mxeon.conformance.specs.lobes import PbrSpec, ScatteringSpec, uncolored
from mxeon.conformance.specs.microfacets import FacetSpec, FilmSpec, TransmissionSpec, falls_below_0
from mxeon.conformance.specs.subsurface import ON_SPHERES, RINGS, SubsurfaceSpec, inner, spread
from mxeon.conformance.specs.surface_shaders import SurfaceShaderSpec
from mxeon.conformance.specs.utilities import UtilitySpec
from mxeon.conformance.tolerance import Compared, Term, roundings, single, sum_in, sum_of
from mxeon.errors import Implied
from mxeon.hosts import HOSTS, front_lit_only
from mxeon.hosts.calls import NORMAL
from mxeon.io.srgb import srgb_decoded
from mxeon.models.diffuse import fon_albedo_avg
from mxeon.models.nodes.combinations import FACTOR
from mxeon.models.nodes.lobes import FORMS, TILTED
from mxeon.shaders.methods import Methods

LEAST_LIGHT = 0.01  # smallest albedo by which light of an uneven environment is divided
# Error of a lookup direction, in radians. Engines filter textures with 8-bit weights. The diagonal
# of a texel is sqrt(2) pi / 128.
TEXEL = math.sqrt(2.0) * math.pi / samples.SKY_ROWS * 2.0**-8
# Largest error of an engine's arc sine, in radians, measured for the software rasterizer llvmpipe.
# Other engines are ten times as accurate.
ARC_SINE = 4e-4
SURROUNDINGS = sum_in(
    Quantity.IRRADIANCE,
    Term(samples.SLOPE * TEXEL, "2^-8 of a texel, times the slope of the map, 1/2"),
    Term(samples.SLOPE * ARC_SINE, "an engine's arc sine, times the slope"),
    Term(2.0**-11, "half floats"),
)
ZERO = single(0.0, Quantity.DIFFERENCE, "a product with 0 is 0 in any precision")
OPAQUE = sum_in(Quantity.THROUGHPUT, roundings(1, "of 1 - weight"))


def of_model(*names: str) -> Specs:
    """Specs whose diffuse model is among `names`, including diffuse lobes below other lobes."""
    return family(DiffuseModelSpec, lambda spec: spec.model in names)


# Sets of nodes to which checks of the table ROWS apply.
FILMS, TRANSMITTING = family(FilmSpec), family(TransmissionSpec)
CLEAR = family(TransmissionSpec, lambda spec: spec.reflects)  # nodes that transmit and reflect
DARK = TRANSMITTING - CLEAR  # nodes that transmit but do not reflect
# Nodes that have no tint, and therefore pass all light if opacity replaces refraction.
UNTINTED = DARK - family(LobeSpec, lambda spec: "tint" in colored(spec))
COMBINED, SUBSURFACE = family(CombinedSpec), family(SubsurfaceSpec)
FACETS, BELOW = family(FacetSpec), family(SurfaceLobe)
PLAIN = family(PbrSpec) - COMBINED - FILMS - TRANSMITTING  # single lobes of MaterialX's pbrlib
LAYERS = PLAIN & family(PbrSpec, lambda spec: spec.row.layerable)  # lobes that can cover a base
RECIPROCAL = PLAIN & family(PbrSpec, lambda spec: spec.row.reciprocal)
LAMBERT, BURLEY = of_model("lambert"), of_model("burley")
LOBES = PLAIN | BURLEY | of_model("burley_lambert")
EON = of_model("eon", "eon_fitted")
MODES = of_model("eon", "eon_fitted", "qon")  # modes of a rough diffuse node
ROUGH = MODES | of_model("fon")
VALUED = LOBES | FILMS | ROUGH  # single lobes of MaterialX's nodes and of renderers


def shows_exactly(spec: Spec, host: str) -> bool:
    """Whether a host evaluates exact directions, including grazing directions.

    Hosts that evaluate closures are excluded for films, because closures have no film of IOR 0.
    """
    inexact = {"rendered", "pictures"}
    if Ability.FILM in spec.requires:
        inexact.add("closures")
    return all(row.way not in inexact for row in HOSTS if row.name == host)


def finds_albedo(spec: Spec, methods: Methods) -> bool:
    """Whether the environment branch of a shader returns an albedo that can be compared.

    In a prefiltered environment, MaterialX's fit is too inaccurate for films and surface shaders.
    For microfacets, sums of 64 samples and eonlib's own lookup are too inaccurate.
    """
    if methods.environment != "prefilter":
        return methods.environment == "fis"
    sampled = methods.albedo != "analytic" or bool(methods.searched)
    return not (sampled and FACETS(spec)) and not isinstance(spec, (FilmSpec, SurfaceShaderSpec))


def has_environment(spec: Spec, host: str) -> bool:
    return not front_lit_only(host, spec.model)


def furnace(case: Case) -> Iterator[Compared]:
    for batch in case.views:
        white = batch.altered(color=samples.WHITE, weight=1.0)
        yield Compared(white, case.albedo(white), np.ones((1, 3)))


def black(case: Case) -> Iterator[Compared]:
    spec = case.of(ScatteringSpec)
    for batch in case.few:
        batch = batch.altered(**spec.black)
        yield Compared(batch, case.direct(batch), np.zeros((1, 3)))


def surroundings(case: Case) -> Compared:
    batch = case.backend.turned
    if "color" in batch.inputs:
        batch = batch.altered(color=samples.WHITE)
    uniform = case.albedo(batch)
    bright = uniform.min(axis=1) > LEAST_LIGHT
    if bright.any():  # skip dark pairs, unless all pairs are dark
        batch, uniform = batch.where(bright), uniform[bright]
    with np.errstate(divide="ignore", invalid="ignore"):
        measured = case.albedo(batch, samples.sky_map()) / uniform
    return Compared(batch, measured, case.of(ScatteringSpec).sky(batch))


def sphere(case: Case) -> Iterator[Compared]:
    def picture(batch: Batch) -> Array:
        scene = backends.scene_of(batch)
        [shader] = case.host.compile(case.spec.document(batch.inputs), library=case.library)
        return case.host.picture(shader, scene)[inner(scene.size)].astype(np.float64)

    for batch in case.backend.take(case.of(SubsurfaceSpec).spheres):
        yield Compared(batch, case.measured(picture, batch), spread(batch))


def in_srgb(case: Case) -> Iterator[Compared]:
    batch, evaluating = case.few[0].first(case.backend.counts.albedos), case.evaluating
    evaluate = partial(evaluating.evaluate, branch="direct", shader=evaluating.decoded)
    yield Compared(batch, np.pi * case.measured(evaluate, batch), decoded_values(case, batch))


def decoded_values(case: Case, batch: Batch) -> Array:
    linear = samples.float32(srgb_decoded(batch.inputs["color"]))
    return case.backend.direct(batch.altered(color=linear))


def color_candidates(case: Case) -> tuple[Candidate, ...]:
    decoded = Candidate("the color, decoded from sRGB", partial(decoded_values, case))
    return decoded, Candidate("the color, not decoded from sRGB", case.backend.direct)


COLOR_SPACE = Comparison("color_space", in_srgb, color_candidates)


# Outputs that an opaque node of weight 1 must return as 0, each with a kind of light.
ZEROS = (*product(["throughput"], BRANCHES), *product(["response"], ["transmission", "emission"]))


def opaque_values(case: Case, output: str, branch: str) -> Iterator[Compared]:
    """Outputs of an opaque node. Throughputs must be 1 - weight, and other outputs must be 0.

    Weights are clamped to [0, 1]. Hair has no input `weight` and counts as a lobe of weight 1.
    """
    for batch in case.few:
        weight = np.array(np.broadcast_to(batch.inputs.get("weight", 1.0), len(batch.wo)))
        if "weight" in batch.inputs:
            weight[0] = 2.0
            batch = batch.altered(weight=weight)
        values = case.evaluating.evaluate(case.inputs(batch), branch, output)
        passed = 1.0 - np.clip(weight, 0.0, 1.0) if output == "throughput" else 0.0 * weight
        expected = np.repeat(passed[:, np.newaxis], 3, axis=1)
        yield Compared(batch, case.throughputs(batch, values), expected)


def diagnose_opaque(case: Case) -> Diagnosis:
    """Explain outputs of an opaque node. The specification only defines weights in [0, 1]."""
    found = {each: list(opaque_values(case, *each)) for each in ZEROS}
    for compared in chain.from_iterable(found.values()):
        weight = np.broadcast_to(compared.batch.inputs.get("weight", 1.0), len(compared.batch.wo))
        wrong = OPAQUE.wrong(compared).reshape(len(weight), -1).any(axis=1)
        if np.any(wrong & (weight >= 0.0) & (weight <= 1.0)):
            return diagnosis.diagnose_throughput(found)
    return Diagnosis((Cause(Kind.FAULT, "weight_unlimited"),), permitted=True)


def reciprocity(case: Case) -> Iterator[Compared]:
    """BSDF values f(wo, wi) compared with f(wi, wo), each multiplied by both cosines."""
    for batch in case.few:
        side = -1.0 if np.all(batch.wi[:, 2] <= 0.0) else 1.0  # -1 if all light is from below
        swapped = replace(batch, wo=side * batch.wi, wi=side * batch.wo)
        with np.errstate(invalid="ignore"):  # infinity times 0 is NaN, which counts as an error
            forward = case.direct(batch) * batch.wo[:, 2:]
            backward = case.direct(swapped) * np.abs(batch.wi[:, 2:])
        yield Compared(batch, forward, backward)


# --- energy: albedo and throughput of a lobe, and their sum when a lobe covers another ------------


def layers_with(name: str) -> Specs:
    return LAYERS & family(PbrSpec, lambda spec: name in spec.row.inputs)


def dip(case: Case) -> Iterator[Compared]:
    white: Values = dict.fromkeys(("color0", "color90"), samples.WHITE)
    white = {**white, "color82": (samples.LEAST_COLOR82,) * 3, "exponent": 5.0}
    return (throughput(case, batch.altered(**white)) for batch in case.views)


def denser(case: Case) -> Iterator[Compared]:
    for batch in case.views:
        inverse = batch.altered(ior=1.0 / np.asarray(batch.inputs["ior"]), tint=samples.WHITE)
        yield throughput(case, inverse)


def throughput(case: Case, batch: Batch) -> Compared:
    """Throughput at weight 1, compared with 1 minus the directional albedo."""
    full = batch.altered(weight=1.0)
    return Compared(full, case.throughput(full, "direct"), case.expected_throughput(full))


def layer(case: Case) -> Compared:
    batch, weights = case.backend.integrated
    views, albedo = summed(case, uncolored(batch), weights)
    total = albedo + case.throughput(views, "direct")
    # Skip materials whose model values integrate to more than the model's albedo, because then the
    # sum of integral and throughput exceeds 1.
    most = case.lobe.albedo(batch.where(np.arange(len(weights)) * weights.shape[1])) + 1e-9
    sound = np.asarray((case.backend.integrals <= most).all(axis=1))
    return Compared(views, total, np.ones_like(total)).where(sound)


def integral(case: Case) -> Compared:
    views, albedo = summed(case, *case.backend.integrated)
    return Compared(views, albedo, case.backend.integrals)


def energy(case: Case) -> Compared:
    views, albedo, expected = integral(case)
    most = np.maximum(1.0, expected)
    return Compared(views, np.maximum(albedo, most), most)


def summed(case: Case, batch: Batch, weights: Array) -> tuple[Batch, Array]:
    """Views, and albedos (N, 3) of the views, computed as weighted sums over light directions."""
    count, nodes = weights.shape
    values = case.direct(batch).reshape(count, nodes, 3)
    albedo = (weights[..., np.newaxis] * values).sum(axis=1)
    return batch.where(np.arange(count) * nodes), albedo


# --- two lobes combined ------------------------------------------------------------------------


def factor(case: Case) -> Iterator[Compared]:
    for batch, (factor, clamped) in product(case.few, ((2.0, 1.0), (-1.0, 0.0))):
        beyond, nearest = (
            batch.altered(**{FACTOR: np.full_like(batch.inputs[FACTOR], number)})
            for number in (factor, clamped)
        )
        yield Compared(beyond, case.direct(beyond), case.direct(nearest))
        passed = (case.throughput(each, "direct") for each in (beyond, nearest))
        yield Compared(beyond, *passed)


# --- hair: lobes in regions where a lobe can be judged alone, such as narrow or tilted lobes ------


TURN_FIBER = controls.with_inputs(
    "the normal is turned about the fiber by 0.1", normal=(0.0, 0.1, 0.995)
)


def region_values(key: str, case: Case) -> Compared:
    return case.compared(case.of(HairSpec).region(key, case.backend.counts.few))


def in_region(key: str, case: Case) -> Compared:
    return case.valued.rescaled(region_values(key, case))


def explain_region(key: str, case: Case) -> Diagnosis:
    equal = set(FORMS) - {REGIONS[key].form, TILTED}  # variants that equal the model in this region
    candidates = [each for each in case.valued.value_candidates if each.title not in equal]
    compared = region_values(key, case)
    brightest = min(float(compared.expected.max()), 1.0)
    terms = (Term(brightest * REGION.value, "a region"),)
    error = replace(REGION, terms=terms, metric=tolerance.scaled, exact=True)
    return diagnosis.explain(case, [compared], candidates, DIRECT_FAULTS, error)


# --- inputs outside the ranges of the other checks, if hosts pass them on -------------------------

LEAST_WEIGHT = 0.3  # smallest weight and occlusion, so that errors stay visible
TOLERANCES = single(1.0, Quantity.TOLERANCES, "the tolerance of each quantity")


def quantities(case: Case, batch: Batch, clamped: Batch) -> Iterator[tuple[str, Compared]]:
    """Compare value, albedo and throughput with the model's results for clamped inputs."""
    yield "value", Compared(batch, case.direct(batch), case.expected(clamped))
    yield "albedo", Compared(batch, case.albedo(batch), case.expected_albedo(clamped))
    if LAYERS(case.spec):
        passed = case.throughput(batch, "direct")
        yield "throughput", Compared(batch, passed, case.expected_throughput(clamped))


def outside(case: Case) -> Iterator[tuple[str, str, float, Compared]]:
    """Compare a few pairs for each tested value outside the usual range of an input.

    Each comparison comes with the names of the quantity and the input, and with the input's value.
    Values are divided by the quantity's tolerance. Quantities that fail for usual inputs are
    skipped.
    """
    spec, views = case.of(PbrSpec), case.backend.views[0]
    row, visible = np.arange(len(views.wo))[:, np.newaxis], {}
    wo = np.where(row == 1, NORMAL, views.wo)
    wi = np.where(row % 2 == 1, wo * [-1.0, -1.0, spec.side], views.wi)  # mirror directions
    for name in {"weight", "occlusion"} & views.inputs.keys():
        visible[name] = np.maximum(views.inputs[name], LEAST_WEIGHT)
    views = replace(views, wo=wo, wi=wi).altered(**visible)
    plain = replace(case, outputs=lambda batch, values: values)
    wrong = {
        name
        for name, (_, measured, expected) in quantities(plain, views, views)
        if tolerance.scaled(measured, expected).max() > case.tolerance(name).value
    }
    if len(wrong) == 2 + LAYERS(spec):
        inside = f"{spec.title} already fails inside its inputs' usual ranges"
        raise Implied(f"{case.host.name}: not measured, because {inside}")
    batch = views.first(16)
    for port in spec.bounded:
        for value in port.beyond:
            beyond, clamped = (
                batch.altered(**{port.name: np.full_like(batch.inputs[port.name], number)})
                for number in (value, float(np.clip(value, *port.ends)))
            )
            # Skip negative Fresnel curves, which MaterialX's environment sum does not clamp to 0.
            known = ~np.broadcast_to(falls_below_0(clamped.inputs), len(batch.wo))
            for name, compared in quantities(case, beyond, clamped):
                if name not in wrong:
                    error = spec.outside_errors.get((name, port.name, value))
                    error = error or case.tolerance(name)
                    scale = error.value * error.scale(compared.expected)
                    yield name, port.name, value, compared.over(scale).where(known)


def diagnose_domain(case: Case) -> Diagnosis:
    wrong: dict[tuple[str, str], list[float]] = {}
    for quantity, name, value, compared in outside(case):
        if tolerance.absolute(*compared[1:]).max() > TOLERANCES.value:
            wrong.setdefault((name, quantity), []).append(value)
    causes = (
        Cause(Kind.DEFECT, f"{quantity}_outside", (name,), tuple(values))
        for (name, quantity), values in wrong.items()
    )
    return Diagnosis(tuple(causes))


# --- negative colors, as MaterialX's own shaders treat them ---------------------------------------

CLAMPED = FACETS | COMBINED | family(HairSpec)  # nodes for which negative colors count as 0


def colored(spec: LobeSpec) -> list[str]:
    """Names of color inputs that scale light: reflectances, tints, or the factor of `multiply`."""
    prefixes = (FACTOR,) if COMBINED(spec) else ("color", "tint")
    colors = (each.name for each in spec.inputs if each.type == "color3")
    return [name for name in colors if name.startswith(prefixes)]


def unsigned(batch: Batch) -> Batch:
    colors = {name: each for name, each in batch.inputs.items() if np.ndim(each) == 2}
    return batch.altered(**{name: np.abs(each) for name, each in colors.items()})


def negative(case: Case) -> Iterator[Compared]:
    """Check the light of nodes whose color has a negative red channel.

    Some nodes treat a negative red channel as 0. If rho is the red channel, EON's red light is
    a rho + b rho^2 / (1 - rho (1 - <E>)), where <E> is the average albedo of FON. The light for rho
    and for rho / 2 determines a and b. In all other nodes, a negative red channel only changes the
    sign of the red light.
    """
    quantities = [(case.backend.direct, case.direct)]
    if not family(HairSpec)(case.spec):  # MaterialX computes hair's albedo from unclamped tints
        quantities.append((case.backend.albedo, case.albedo))
    if TRANSMITTING(case.spec):
        quantities.append((case.evaluating.transmitted, case.transmitted))
    batch, red = case.few[0].first(64).altered(weight=1.0), np.array([1.0, 0.0, 0.0])
    for name in colored(case.lobe):
        rho = np.maximum(batch.inputs[name], 0.1) * red
        rest = batch.inputs[name] * (1.0 - red)
        negated, zero, half, whole = (
            batch.altered(**{name: rest + share * rho}) for share in (-1.0, 0.0, 0.5, 1.0)
        )
        for light, measure in quantities:
            if CLAMPED(case.spec):
                expected = light(zero)
            elif EON(case.spec):
                roughness = np.reshape(batch.inputs["roughness"], (-1, 1))
                lost = rho * (1.0 - fon_albedo_avg(roughness))
                least, middle, most = (1.0 / (1.0 - share * lost) for share in (-1.0, 0.5, 1.0))
                second = (light(whole) - 2.0 * light(half)) / (most - 0.5 * middle)  # b rho^2
                expected = light(whole) + red * (second * (least + most) - 2.0 * light(whole))
            else:
                expected = light(whole) * (1.0 - 2.0 * red)
            finite = np.asarray(np.isfinite(expected).all(axis=1))  # other checks report NaN
            yield Compared(negated, measure(negated), expected).where(finite)


# fmt: off
ROWS = (
    Check(key="value",
          claim="The value matches the model for every pair of directions, including back-lit and grazing pairs.",
          applies=VALUED - BELOW, measure=VALUE, control=controls.gray, open=True),
    Check(key="lobe", claim="The diffuse lobe of the surface shader matches the model.",
          applies=LAMBERT | BELOW, measure=VALUE, control=controls.gray),
    Check(key="environment", claim="The environment branch returns the directional albedo.",
          applies=VALUED | LAMBERT, measure=ALBEDO, control=controls.gray, open=True,
          hosts=has_environment, methods=finds_albedo),
    Check(key="furnace", claim="A white surface disappears in a white environment.",
          applies=of_model("eon", "eon_fitted"), measure=furnace, tolerance="albedo",
          control=controls.with_inputs("reflectance is 0.99", color=(0.99, 0.99, 0.99)),
          explain=ALBEDO.diagnose, hosts=has_environment, methods=finds_albedo),
    Check(key="black", claim="A black surface scatters nothing.",
          applies=PLAIN & family(PbrSpec, lambda spec: bool(spec.black))
          | (ROUGH | LAMBERT | BURLEY) - BELOW,
          measure=black, tolerance=ZERO, control=controls.offset, explain=VALUE.diagnose),
    Check(key="frame",
          claim="The value follows the surface's frame, with the normal turned toward the viewer.",
          applies=LOBES | MODES, measure=frames, control=controls.drop_normal,
          explain=diagnosis.diagnose_frame),
    Check(key="surroundings",
          claim="An uneven environment is looked up along the viewer-facing normal, or along its opposite for translucent nodes.",
          applies=(PLAIN - FACETS) | MODES | BURLEY, measure=surroundings, tolerance=SURROUNDINGS,
          control=controls.drop_normal, explain=lambda case: diagnosis.diagnose_surroundings(surroundings(case), SURROUNDINGS),
          requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: methods.environment != "none"),
    *(
        Check(key=key, claim=claim, applies=SUBSURFACE, measure=sphere,
              control=controls.with_inputs(
                  "the mean free path is 0.3 in every channel", radius=(0.3, 0.3, 0.3)),
              explain=lambda case: diagnosis.explain(case, list(sphere(case)), ON_SPHERES, (), RINGS),
              requires=Ability.LIGHT)
        for key, claim in (
            ("sphere_mean", "On average, a sphere reflects the fraction of light that the profile predicts."),
            ("sphere", "On a sphere, light spreads as the diffusion profile predicts from radius and anisotropy."))
    ),
    Check(key="color_space",
          claim="An sRGB color has the same value as the linear color that it encodes.",
          applies=family(ScatteringSpec, lambda spec: spec.flat), measure=COLOR_SPACE,
          control=controls.gray, requires=Ability.PAIRS),
    Check(key="throughput",
          claim="In every branch, an opaque node passes the fraction 1 - weight of the light from below.",
          applies=(PLAIN - LAYERS) | MODES,
          measure=lambda case: (each for row in ZEROS for each in opaque_values(case, *row)),
          tolerance=OPAQUE, control=controls.take_response, explain=diagnose_opaque, open=True,
          requires=Ability.PAIRS | Ability.LIGHT),
    Check(key="reciprocity", claim="Exchanging the two directions does not change the BRDF.",
          applies=(RECIPROCAL - SUBSURFACE) | ROUGH | LAMBERT | BURLEY, measure=reciprocity,
          control=controls.scale_cosine("the value has an extra factor cos(theta_o)", 1),
          explain=VALUE.diagnose),
    Check(key="lambert", claim="At roughness 0 the node is Lambert.",
          applies=MODES,
          measure=lambda case: (case.compared(each.altered(roughness=0.0)) for each in case.few),
          control=controls.with_inputs("roughness is 0.1", roughness=0.1), explain=VALUE.diagnose),
    Check(key="inputs", claim="Every input of the node changes the value.",
          applies=(LOBES | ROUGH | LAMBERT) - BELOW
          | COMBINED | family(EmissionSpec) | family(MediumSpec) | family(UtilitySpec),
          measure=lambda case: tolerance.count_named(dead_inputs(case)), tolerance=tolerance.count_of(Quantity.INPUTS),
          control=controls.drop_changes,
          explain=lambda case: defect("inputs_without_effect", *dead_inputs(case))),
    Check(key="negative",
          claim="A negative color counts as 0 or subtracts light, as in MaterialX's own code.",
          applies=(VALUED | COMBINED | TRANSMITTING) & family(LobeSpec, lambda spec: bool(colored(spec))),
          measure=negative, tolerance=sum_of(roundings(64, "of two values")),
          control=controls.with_batch("signs are dropped", unsigned),
          explain=defect("negative_color"), requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: methods.transmission != "opacity" or not UNTINTED(spec)),
    Check(key="finite", claim="Every value at the edges of the domain is finite.",
          applies=LOBES | MODES | FILMS, measure=lambda case: tolerance.count_not_finite(edge_values(case)),
          tolerance=tolerance.count_of(Quantity.VALUES),
          control=controls.scale_cosine("the value is divided by cos(theta_o)", -1),
          explain=lambda case: Diagnosis(diagnosis.not_finite([edge_values(case)])),
          requires=Ability.PAIRS, hosts=shows_exactly),
    Check(key="layering",
          claim="For every weight, a layer passes 1 - E of the light from above, where E ignores the layer's color.",
          applies=LAYERS | family(FilmSpec, lambda spec: spec.row.layerable), measure=THROUGHPUT,
          control=controls.pass_all, open=True),
    Check(key="transmission",
          claim="A layer also passes 1 - E of the light that the base transmits.",
          applies=LAYERS, measure=TRANSMISSION, control=controls.pass_all, open=True),
    Check(key="dip",
          claim="Where color82 lowers the reflectance, the layer passes all light that it does not reflect.",
          applies=layers_with("color82"), measure=dip, control=controls.pass_all,
          explain=THROUGHPUT.diagnose, requires=Ability.PAIRS | Ability.LIGHT),
    Check(key="denser",
          claim="The throughput is also 1 - E for an IOR below 1, where facets reflect totally.",
          applies=layers_with("tint"), measure=denser, control=controls.pass_all,
          explain=THROUGHPUT.diagnose, requires=Ability.PAIRS | Ability.LIGHT),
    Check(key="layer", claim="A white layer over a white base returns all light.",
          applies=LAYERS, measure=layer, tolerance="light", control=controls.pass_all,
          explain=THROUGHPUT.diagnose),
    Check(key="integral",
          claim="The integral of the values is the directional albedo of the model's equations.",
          applies=LOBES | MODES, measure=integral,
          control=controls.scale("values are 2 % too large", 1.02), explain=VALUE.diagnose, open=True),
    Check(key="energy", claim="No albedo exceeds both 1 and the albedo of the model's equations.",
          applies=LOBES, measure=energy, tolerance="integral",
          control=controls.scale("values are 100 times as large", 100.0), explain=VALUE.diagnose),
    Check(key="combination",
          claim="The value of two combined lobes matches the node's equation.",
          applies=COMBINED, measure=VALUE, control=controls.shifted, requires=Ability.PAIRS, open=True),
    Check(key="combined_albedo",
          claim="The environment branch of two combined lobes returns their albedo.",
          applies=COMBINED, measure=ALBEDO, control=controls.shifted, requires=Ability.PAIRS,
          methods=finds_albedo, open=True),
    Check(key="combined_throughput",
          claim="Two combined lobes pass the light that they do not scatter, as the layer equation requires.",
          applies=COMBINED,
          # Negative throughputs count as 0, because the node `layer` clamps throughputs to 0.
          measure=lambda case: (
              each._replace(measured=np.maximum(each.measured, 0.0)) for each in THROUGHPUT(case)),
          tolerance="throughput",
          control=controls.pass_all, explain=THROUGHPUT.diagnose, open=True),
    Check(key="factor", claim="Factors are clamped to [0, 1].",
          applies=Specs(lambda spec: spec.model in SINGLE), measure=factor,
          control=controls.with_values(
              "values are multiplied twice",
              lambda batch, values: values * np.reshape(batch.inputs[FACTOR], (len(values), -1))),
          explain=replace(defect("factor_not_clamped"), permitted=True),
          requires=Ability.PAIRS, open=True),
    *(
        Check(key=key, claim=row.claim, applies=family(HairSpec), measure=partial(in_region, key),
              control=TURN_FIBER, explain=partial(explain_region, key), requires=Ability.LIGHT, open=True)
        for key, row in REGIONS.items()
    ),
    Check(key="domain",
          claim="Value, albedo and throughput match the model also for inputs outside their usual range.",
          applies=family(PbrSpec, lambda spec: bool(spec.bounded)) - TRANSMITTING,
          measure=lambda case: (compared for *_, compared in outside(case)), tolerance=TOLERANCES,
          control=controls.scale("values are 30 % too large", 1.3), explain=diagnose_domain,
          requires=Ability.PAIRS | Ability.LIGHT),
)
# fmt: on
