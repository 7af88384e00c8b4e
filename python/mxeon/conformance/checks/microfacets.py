# SPDX-License-Identifier: Apache-2.0
"""Checks specific to microfacet lobes: reflection, transmitted light, and thin films."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance import backends, controls, diagnosis, samples
from mxeon.conformance.case import SCATTERING, Case, dead_inputs, model_values
from mxeon.conformance.check import Check, family
from mxeon.conformance.checks import lobes, states
from mxeon.conformance.checks.lobes import CLEAR, FILMS, TRANSMITTING
from mxeon.conformance.diagnosis import ALBEDO, NEAR, UNKNOWN, UNMASKED, VALUE, defect, not_finite
from mxeon.conformance.results import Cause, Diagnosis, Kind, Quantity
from mxeon.conformance.samples import Array, Batch, Mask, Values, directions_at, float32, rounded
from mxeon.conformance.spec import Ability, Spec
from mxeon.conformance.specs import microfacets
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.microfacets import FacetSpec, FilmSpec, TransmissionSpec, film_views
from mxeon.conformance.tolerance import Compared, count_named, count_not_finite, count_of, roundings
from mxeon.errors import Implied
from mxeon.models import sampling, transmission
from mxeon.models.microfacet.defects import UNCOMPENSATED, schlick_average
from mxeon.models.microfacet.ggx import ggx_albedo_dir, smith_g1, smith_lambda
from mxeon.shaders.methods import GENERATED, TABLE_SIZE, UNTABLED, Methods
from mxeon.shaders.scene import Client

if TYPE_CHECKING:  # the import loads MaterialX
    from mxeon.shaders.generation import Shader

PAIRS = 1 << 12  # pairs near the mirror direction
LEAST_DIVIDED = 1.2  # least index of dielectrics whose values are divided
SKIES = 8  # lobes whose mean of an uneven sky is measured
# In this lobe, some facets reflect and others have a negative printed curve; the sum is -0.035.
DIP: Values = {"color0": (0.06,) * 3, "color82": (0.0,) * 3, "color90": (1.0,) * 3}
DIP = {**DIP, "weight": 1.0, "exponent": 5.0, "roughness": (0.2, 0.2)}
LEAST_VALUE = 1e-3  # least pi f cos of values that are divided
FACETS = lobes.PLAIN & lobes.FACETS  # uncombined microfacet lobes
isotropic = controls.with_batch(
    "the roughness is the same in both directions",
    lambda batch: batch.altered(roughness=np.repeat(batch.inputs["roughness"][:, :1], 2, axis=1)),
)


def lossless(case: Case) -> Compared:
    batch, weights = case.backend.integrated
    mirror = batch.altered(**case.of(PbrSpec).row.mirror)
    views, albedo = lobes.summed(case, mirror, weights)
    return Compared(views, albedo, np.ones_like(albedo))


def shape(case: Case) -> Compared:
    """Ratios of values for two lights, compared with single scattering: compensation cancels."""
    batch, other = (_clear(each.first(PAIRS)) for each in case.backend.mirrored)
    first, second = (case.of(FacetSpec).single(each) for each in (batch, other))
    lit = np.asarray((np.minimum(first, second) > LEAST_VALUE).any(axis=1))
    least = np.minimum(batch.wo[:, 2], np.minimum(batch.wi[:, 2], other.wi[:, 2]))
    lit &= least >= microfacets.LEAST_TANGENT_COSINE
    scale = (first * second).max(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        measured = case.direct(batch) * second / scale
        expected = case.direct(other) * first / scale
    return Compared(batch, measured, expected).where(lit)


def dark(case: Case) -> Compared:
    batch = case.few[-1].altered(color0=(0.0, 0.0, 0.0), color82=(0.0, 0.0, 0.0), color90=ONE[0])
    batch = batch.where(microfacets.is_below_0(batch))
    return Compared(batch, case.direct(batch), np.zeros((1, 3)))


def _clear(
    batch: Batch, index: float = LEAST_DIVIDED, least_82: float = samples.LEAST_COLOR82
) -> Batch:
    """A batch without curves that are inaccurate in float32 because their terms cancel.

    These are dielectrics with an index near 1, and deep dips at 82 degrees, which make F negative.
    """
    changes: dict[str, ArrayLike] = {}
    if np.ndim(batch.inputs.get("ior", 0.0)) == 1:
        changes["ior"] = np.maximum(batch.inputs["ior"], index)
    if "color82" in batch.inputs:
        changes["color82"] = np.maximum(batch.inputs["color82"], least_82)
    return batch.altered(**changes)


def retroreflection(case: Case) -> Iterator[Compared]:
    for batch in case.few:
        mirrored = replace(batch, wo=batch.wo * [-1.0, -1.0, 1.0])
        measured = case.direct(batch.altered(retroreflective=True))
        yield Compared(batch, measured, case.direct(mirrored.altered(retroreflective=False)))


def anisotropy(case: Case) -> Compared:
    batch = microfacets.denser(case.backend.mirrored[0].first(PAIRS))
    height = np.minimum(batch.wo[:, 2], batch.wi[:, 2])
    batch = batch.where(height >= microfacets.LEAST_TANGENT_COSINE)
    alpha = np.maximum(batch.inputs["roughness"], microfacets.LEAST_TANGENT_ALPHA)
    batch = batch.altered(roughness=alpha)
    angle = np.linspace(0.0, 2.0 * np.pi, len(batch.wo))
    x, y, zero = np.cos(angle), np.sin(angle), np.zeros(len(angle))
    axes = np.array([[x, -y, zero], [y, x, zero], [zero, zero, zero + 1.0]]).transpose(2, 0, 1)
    turned = replace(batch.altered(tangent=float32(axes[:, :, 0])), frame=axes)
    local = batch.altered(tangent=(1.0, 0.0, 0.0))
    return Compared(turned, case.direct(turned), case.direct(local))


def reflected_sky(case: Case) -> Iterator[Compared]:
    """Means of the sky weighted by each lobe; a retroreflective lobe must give the mean of the mirrored view.

    Each mean is a quotient of two albedos, so factors of the lobe cancel.
    """
    views = case.backend.take(case.of(FacetSpec).stretched)[0].first(SKIES)
    part, weights = case.of(FacetSpec).lit(views, case.backend.counts.nodes)
    shape = (*weights.shape, 3)
    value = case.of(FacetSpec).single if case.backend.searched else case.of(FacetSpec).summed
    values = value(part).reshape(shape) * weights[:, :, np.newaxis]
    albedo = values.sum(axis=1)
    bright = albedo.min(axis=1) > LEAST_VALUE
    seen = (values * samples.sky(part.wi).reshape(shape)).sum(axis=1)
    views, mean = views.where(bright), seen[bright] / albedo[bright]
    mirrored = replace(views, wo=views.wo * [-1.0, -1.0, 1.0])
    for each in (views, mirrored.altered(retroreflective=True)):
        yield Compared(each, case.albedo(each, samples.sky_map()) / case.albedo(each), mean)


def diagnose_sky(case: Case) -> Diagnosis:
    """Whether the mirror lobe is wrong, or only the retroreflective one."""
    if case.tolerance("sky").wrong(next(reflected_sky(case))).any():
        return defect("other_directions")
    return defect("retroreflective_environment")


def anisotropic_albedo(case: Case) -> Iterator[Compared]:
    """Albedos with the host's methods, and with the library's own environment lookups, if any."""
    yield from albedos(case, case.host.active)
    for methods in searching(case, Methods("fis"), Methods("prefilter")):
        yield from albedos(case, methods, generated(case, methods))


def albedos(case: Case, methods: Methods, shader: "Shader | None" = None) -> Iterator[Compared]:
    """Albedos with a client's methods. The library's own sum also clamps curves below 0.

    For prefiltered environments, the library fits curves, coarsely for metals; mirrors need no fit.
    """
    spec = case.of(FacetSpec)
    batch, expected = exact = case.backend.take(spec.stretched)
    rows = [exact if methods.searched else case.backend.take(spec.stretched_sums)]
    if methods.environment == "prefilter":
        rows = [(batch.altered(**spec.row.mirror), batch.strength * ONE)]
        rows += [(each, case.expected_albedo(each)) for each in case.views[: spec.row.layerable]]
    elif methods.searched and "color82" in batch.inputs:
        dark = replace(batch.first(1), wo=directions_at([0.05], 0.5)).altered(**DIP)
        rows.append((dark, spec.integral(dark)))
    for batch, expected in rows:
        found = case.evaluating.evaluate(case.inputs(batch), "environment", shader=shader)
        yield Compared(batch, case.outputs(batch, found), expected)


def searching(case: Case, *methods: Methods) -> Iterator[Methods]:
    """Methods with the library's own environment lookups, if it has any and no methods are chosen."""
    from mxeon.shaders.library import environment_folders

    if case.host.active == GENERATED and not case.control and environment_folders(case.library):
        yield from (replace(each, searched=True) for each in methods)


def generated(case: Case, methods: Methods) -> "Shader":
    [shader] = case.host.compile(case.spec.document(), library=case.library, methods=methods)
    return shader


STRETCHED = diagnosis.Comparison(
    "anisotropic_value",
    lambda case: map(
        case.compared, case.chosen or (case.backend.take(case.of(FacetSpec).anisotropic),)
    ),
    lambda case: case.of(FacetSpec).all_candidates,
)


def anisotropic_throughput(case: Case) -> Iterator[Compared]:
    batch = case.backend.take(case.of(FacetSpec).stretched)[0]
    for branch in SCATTERING:
        yield Compared(batch, case.throughput(batch, branch), case.expected_throughput(batch))


# --- light that is transmitted, in the branch that looks up an environment ------------------------

SEEN = 64  # views in a turned environment
SUMMED = 1e-3  # rms error of an engine's sum over the normals
SMOOTH_VIEWS = 1 << 9  # views of smooth surfaces
CHANGED_VIEWS = 1 << 6  # views for changed inputs
LEAST_SEEN = 0.05  # least cosine of views
CRITICAL = 0.05  # distance from the critical cosine, where F has an infinite slope
ROUGH_VIEWS, FACETS_SEEN = 1 << 6, 32  # facets along each axis of the random numbers
ROUGH = 0.1  # least alpha of rough glass
LEAST_PASSED = 0.01  # least light whose direction is measured
# The slope of a refracted ray is index^2 / cosine. Above this slope, errors are relative to it.
BENT = 1000.0
REFRACTED = lobes.SURROUNDINGS.plus(roundings(4 * BENT, "four of a cosine, times a slope of 1000"))
NORMAL = (0.0, 0.0, 1.0)
UPWARD = np.array(NORMAL)
ONE = np.ones((1, 3))


def with_directions(spec: Spec, methods: Methods) -> bool:
    """Whether the environment is summed over directions; prefiltered maps need one lookup."""
    return methods.environment == "fis"


def diagnose_transmitted(case: Case) -> Diagnosis:
    """Test whether light is the mean of 1 - F, or this mean over G_1 (MaterialX); find NaN."""
    compared, spec = list(transmitted(case)), case.of(TransmissionSpec)

    def distance(found: Callable[[Compared], Array]) -> float:
        errors = [(each.measured - found(each))[np.isfinite(each.measured)] for each in compared]
        return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))

    distances = {
        "seen_over_masking": distance(lambda c: _seen(spec, c.batch, True)),
        "seen": distance(lambda c: _seen(spec, c.batch)),
    }
    key = min(distances, key=lambda name: distances[name])
    known = distances[key] < max(NEAR * distance(lambda c: c.expected), SUMMED)
    causes = defect(key).causes if known else ()
    return Diagnosis((*causes, *not_finite(compared)) or (UNKNOWN,))


def _seen(spec: TransmissionSpec, batch: Batch, masked: bool = False) -> Array:
    """Mean of 1 - F over the visible normals, (N, 3); if `masked`, divided by G_1 of the view."""
    value: Array = batch.strength * spec.functions.passed(batch.wo, batch.inputs, False)
    return value / smith_g1(batch.wo, batch.inputs["roughness"])[:, np.newaxis] if masked else value


def transmitted(case: Case) -> Iterator[Compared]:
    """Light of a uniform environment through the surface, compared with the nearest value within two limits.

    One limit is the light passed by the BTDF, without compensation; the other is all light that is
    not reflected, with tint and weight. The first is larger for some colors of Schlick's curve,
    which the text overcompensates. With transmission as opacity, a lobe that only transmits passes
    its tint, and a layer above it subtracts its own reflection.
    """
    spec = case.of(TransmissionSpec)
    for batch in case.views:
        yield limited(spec, batch, case.transmitted(batch), case.opaque)


def limited(spec: TransmissionSpec, batch: Batch, measured: Array, opaque: bool) -> Compared:
    if opaque and not spec.reflects:
        return Compared(batch, measured, batch.strength * spec.functions.tint(batch.inputs))
    least, most = batch.strength * np.sort(model_values(spec, "ends")(batch), axis=0)
    return Compared(batch, measured, np.clip(measured, least, most))


def clear(case: Case) -> Iterator[Compared]:
    for batch in case.views:
        white = batch.altered(tint=(1.0, 1.0, 1.0), weight=1.0)
        yield Compared(white, case.albedo(white) + case.transmitted(white), ONE)


# Methods of clients: Storm's, and MaterialXView's prefiltered environment with refraction; mirrors
# use sampled and tabulated albedos. BOUND is dim, turned, and two-sided in refraction.
OTHERS = (Methods("prefilter", "opacity"), Methods("prefilter", "refraction"))
SAMPLED = Methods("prefilter", "refraction", "monteCarlo")
BOUND = Client(turn=states.TURNING, intensity=0.5, two_sided=True)
SIDES = np.floor, np.ceil  # texels on both sides of a place
MIRROR = family(FacetSpec, lambda spec: spec.model == "schlick")


def others(case: Case) -> Iterator[Methods]:
    if not TRANSMITTING(case.spec):
        yield SAMPLED
        if case.host.target not in UNTABLED:
            yield replace(SAMPLED, albedo="table")
        return
    yield from OTHERS
    if CLEAR(case.spec):  # their shaders also contain the code of mode T
        yield from searching(case, Methods("fis"), Methods("prefilter"))


def with_methods(case: Case) -> Iterator[tuple[Methods, Compared]]:
    """Light with each client's methods, compared with the node's method-independent values."""
    transmits = TRANSMITTING(case.spec)
    for methods in others(case):
        ask = partial(case.evaluating.evaluate, shader=generated(case, methods))
        found = (shares if transmits else mirrored)(case, ask, methods)
        yield from ((methods, each) for each in found)


def shares(case: Case, ask: Callable[..., Array], methods: Methods) -> Iterator[Compared]:
    opaque = methods.transmission == "opacity"
    for batch in case.views:
        found = case.outputs(batch, ask(case.inputs(batch), "transmission", client=BOUND))
        if not opaque:
            found = found / BOUND.intensity
        tinted = batch
        if "tint" in batch.inputs and not opaque:
            tinted = batch.altered(tint=np.square(batch.inputs["tint"]))
        yield limited(case.of(TransmissionSpec), tinted, found, opaque)


def mirrored(case: Case, ask: Callable[..., Array], methods: Methods) -> Iterator[Compared]:
    """Throughput, reflection of a white mirror, and reflection of a turned environment.

    A white mirror reflects everything; with a table, the ratio of tabulated and exact albedo.
    """
    white = {name: np.ones(3) for name in ("color0", "color82", "color90")}
    for batch in case.views:
        views = case.inputs(batch)
        passed = case.throughputs(batch, ask(views, "direct", "throughput"))
        yield Compared(batch, passed, case.throughput(batch, "direct"))
        plain, seen = (backends.isotropic(each).altered(**white) for each in (batch, views))
        found = case.outputs(plain, ask(seen, "environment", client=BOUND)) / BOUND.intensity
        ends = np.ones((1, len(found)))
        if methods.albedo == "table":
            ends = np.append(ends, tabulated(plain.wo[:, 2], plain.rough), axis=0)
        low, high = (plain.strength * end(axis=0)[:, np.newaxis] for end in (ends.min, ends.max))
        yield Compared(plain, found, np.clip(found, low, high))
        seen, uneven = (
            seen.first(SEEN),
            partial(ask, branch="environment", irradiance=samples.sky_map()),
        )
        turned = uneven(states.in_turn(seen, BOUND))
        yield Compared(seen, uneven(seen, client=BOUND) / BOUND.intensity, turned)


def tabulated(mu: Array, alpha: Array) -> Array:
    """E_ss at the four texels of MaterialX's table nearest to (mu, alpha), over E_ss there, (4, N).

    In the first rows and columns, the table does not resolve the dip of E_ss to 0.89 near mu = alpha.
    """
    x, y = (TABLE_SIZE * each - 0.5 for each in (mu, alpha))
    corners = ((round_x(x), round_y(y)) for round_x in SIDES for round_y in SIDES)
    texels = (np.clip(corner, 0, TABLE_SIZE - 1) + 0.5 for corner in corners)
    found = np.stack([ggx_albedo_dir(*each / TABLE_SIZE) for each in texels])
    return np.asarray(found / ggx_albedo_dir(mu, alpha))


def diagnose_methods(case: Case) -> Diagnosis:
    tolerance = case.tolerance("methods")
    found = (str(each) for each, compared in with_methods(case) if tolerance.wrong(compared).any())
    wrong = dict.fromkeys(found)
    return defect("wrong_with_methods", *wrong) if wrong else Diagnosis((UNKNOWN,))


def modes(case: Case) -> Iterator[tuple[Cause, Compared]]:
    """Modes T and RT, compared with mode R or with 0, and the cause that a difference shows."""
    spec = case.of(TransmissionSpec)
    only = case.another(spec.reflection) if spec.reflects else None
    none, unlike = 0.0 * ONE, "_unlike_R" * bool(only)

    def cause(key: str, branch: str = "") -> Cause:
        return Cause(Kind.DEFECT, key, branch=branch)

    for batch in case.views:
        reflected = only.direct(batch) if only else none
        yield cause(f"reflects_light{unlike}"), Compared(batch, case.direct(batch), reflected)
        reflected = only.albedo(batch) if only else none
        yield cause(f"reflects_environment{unlike}"), Compared(batch, case.albedo(batch), reflected)
        for branch in SCATTERING if only else SCATTERING[:2]:
            expected = only.throughput(batch, branch) if only else ONE
            compared = Compared(batch, case.throughput(batch, branch), expected)
            yield cause("passes_other_light", branch), compared
        if only:
            yield cause("mode_R_transmits"), Compared(batch, only.transmitted(batch), none)


DENSER = controls.with_inputs("the index is different", ior=2.5, color0=(0.5, 0.5, 0.5))


def critical(case: Case) -> Compared:
    batch = _smooth(case)
    functions = case.of(TransmissionSpec).functions
    index, mu = functions.ior(batch.inputs), np.minimum(batch.wo[:, 2], 1.0)
    away = np.abs(mu - np.sqrt(np.maximum(1.0 - index * index, 0.0))) > CRITICAL
    away &= ~microfacets.falls_below_0(batch.inputs)
    batch, mu = batch.where(away), mu[away]
    passed = functions.tint(batch.inputs) * (1.0 - functions.fresnel(mu, batch.inputs))
    return Compared(batch, case.transmitted(batch), batch.strength * passed)


# Indices, alphas and cosines of views from the denser side.
DENSE, VIEWED = ((1.5, 0.4), (2.0, 1.0)), np.array([0.05, 0.2, 0.5, 0.75, 1.0])


def inside(case: Case) -> Iterator[Compared]:
    """Light that leaves a denser medium, compared with light that enters by reversed paths."""
    spec, views = case.of(TransmissionSpec), directions_at(VIEWED, 0.5)
    for index, alpha in DENSE:
        rows = case.views[0].first(len(VIEWED))
        batch = replace(rows, wo=views, wi=views).altered(
            ior=1.0 / index, roughness=(alpha, alpha), tint=(1.0, 1.0, 1.0), weight=1.0
        )
        outside = {"ior": np.array([index]), "tint": ONE}
        expected = spec.reversed(VIEWED, alpha, index, outside)[:, np.newaxis] * ONE
        passed = case.transmitted(batch)
        yield Compared(batch, passed, expected)
        if spec.reflects:
            yield Compared(batch, case.albedo(batch) + passed, ONE)


def refraction(case: Case) -> Compared:
    index = case.of(TransmissionSpec).functions.ior
    batch = _smooth(case)
    # Choose frames in which a solid sphere refracts the views to the middles of sky texels.
    out = through_sphere(batch.wo, index(batch.inputs))
    place = samples.texel_middles(out)
    frames = samples.aimed(np.broadcast_to(np.eye(3), (len(out), 3, 3)), out, place)
    axes = {"tangent": float32(frames[:, :, 0]), "normal": float32(frames[:, :, 2])}
    batch = replace(batch.altered(**axes), frame=frames)
    slope = (index(batch.inputs) ** 2 / batch.wo[:, 2])[:, np.newaxis]
    condition = np.maximum(1.0, slope / BENT)  # amplification of a cosine's error
    measured, bright = seen_sky(case, batch)
    return Compared(batch, measured / condition, samples.sky(place) / condition).where(bright)


def seen_sky(case: Case, batch: Batch) -> tuple[Array, Mask]:
    """Mean of the sky seen through the surface, and which pairs pass enough light to measure it."""
    level = case.transmitted(batch)
    bright = np.asarray(level.min(axis=1) > LEAST_PASSED)
    seen = case.transmitted(batch, samples.sky_map())
    return seen / np.where(bright[:, np.newaxis], level, 1.0), bright


def rough_refraction(case: Case) -> Compared:
    """Light through lobes of two alphas, uneven over uniform sky, compared with a mean of it.

    Each visible facet passes the same share, along the ray that a solid sphere refracts.
    """
    functions, rng = case.of(TransmissionSpec).functions, samples.generator()
    batch = case.few[0].first(ROUGH_VIEWS)
    count = len(batch.wo)
    wo, alpha = samples.turned_directions(rng, count), rounded(ROUGH ** rng.random((2, count)))
    if "color0" in batch.inputs:
        color = 0.2 * batch.inputs["color0"]  # F is constant, so all facets have the same weight
        batch = batch.altered(color0=color, color82=(1.0, 1.0, 1.0), color90=color)
    else:
        batch = batch.altered(ior=1.2 + 0.8 * rng.random(count))
    turn = 2.0 * np.pi * rng.random(count)
    tangent = rounded([np.cos(turn), np.sin(turn), 0.0 * turn])
    batch = replace(batch.altered(weight=1.0, roughness=alpha, tangent=tangent), wo=wo)
    measured, bright = seen_sky(case, batch)
    axes = np.stack([tangent, np.cross(NORMAL, tangent), 0.0 * wo + NORMAL], axis=1)
    middles = (np.arange(FACETS_SEEN) + 0.5) / FACETS_SEEN
    u = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    view, index, alpha = (
        np.repeat(each, len(u), axis=0)
        for each in ((axes @ wo[:, :, np.newaxis])[:, :, 0], functions.ior(batch.inputs), alpha)
    )
    facets = sampling.ggx_sample(view, np.tile(u, (count, 1)), alpha)[0] + view
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    out = through_sphere(view, index, facets).reshape(count, len(u), 3).mean(axis=1)
    return Compared(batch, measured, samples.sky((out[:, np.newaxis] @ axes)[:, 0])).where(bright)


def through_sphere(wo: Array, index: Array, facet: Array = UPWARD) -> Array:
    """Direction of a view after a solid sphere refracts it twice, (N, 3), at its normal or at a facet.

    The ray meets the far surface at the same angle, so both refractions turn it by the same amount: together they
    are half a turn of the incoming ray about the ray inside.
    """
    inner = transmission.refraction_direction(wo, facet, index)
    return np.asarray(wo - 2.0 * np.sum(wo * inner, axis=1, keepdims=True) * inner)


def _smooth(case: Case) -> Batch:
    """Views of smooth surfaces for all indices, with the node's colors."""
    batch = case.few[0].first(SMOOTH_VIEWS)
    if "color0" in batch.inputs:  # clearest possible curve, with the highest index
        batch = batch.with_row(0, samples.directions_at(0.1, 0.5), weight=1.0, color0=0.99)
    batch = batch.where(batch.wo[:, 2] >= LEAST_SEEN)
    return batch.altered(roughness=(0.0, 0.0))


def _edges(case: Case) -> Compared:
    """Light at the edges of the domain, for every fifth pair: each needs a sum over directions."""
    batch = case.backend.edges
    batch = batch.where(np.arange(len(batch.wo)) % 5 == 0)
    return Compared(batch, case.transmitted(batch), np.zeros((1, 3)))


def wrong_inputs(case: Case) -> list[str]:
    """Inputs that should change the light through the surface but do not, or the reverse.

    `retroreflective` only affects reflection. With transmission as opacity, only weight and tint
    affect a lobe that only transmits; otherwise, the tangent affects the albedo of two alphas.
    """
    batch = case.few[0].first(CHANGED_VIEWS)
    dead = dead_inputs(case, batch, lambda each: case.transmitted(each, samples.sky_map()))
    unread = {"retroreflective"}
    if case.opaque and not CLEAR(case.spec):
        unread |= case.changes.keys() - {"weight", "tint"}
    return [each for each in case.changes if (each in dead) != (each in unread)]


# --- thin films -----------------------------------------------------------------------------------

Function = Callable[[Batch], Array]
MIRRORED = (-1.0, -1.0, 1.0)
ROUGHNESSES = (1.0, 0.3)  # alphas with much and little compensation
SMOOTH = (0.04, 0.005)  # alphas that need almost no compensation; shaders may sum fewer cosines
LEAST_F = 0.01  # films with a smaller F are not compared
THIN_LIMIT = 1e-3  # thickness in nm of a film without effect
SLANT = 2.0 / 3.0  # mean cosine of a hemisphere, weighted by the cosine
RARE = 0.5  # index of a film that MaterialX treats as vacuum

dropped = controls.with_inputs("the film is dropped", thinfilm_thickness=0.0)


def curves(films: microfacets.Films, case: Case) -> Compared:
    """Curves F of films: values in the mirror direction, divided by the values of a mirror.

    The lobes are so smooth that their compensation is 1 for any average.
    """
    batch = film_views(case.of(FilmSpec), films)
    mirror = _mirror(case, batch)
    expected = case.expected(batch) / case.expected(mirror)
    return Compared(batch, case.direct(batch) / case.direct(mirror), expected)


def film_limit(case: Case) -> list[Compared]:
    """Values under a film of index 1, and under a film of thickness THIN_LIMIT, compared with no film.

    A film with an index below 1 must equal one with index 1, right or wrong. Under a thin film, the
    five-digit sensitivities do not add up to 1; the deviation of the equations is accepted.
    """
    # Remove the dip of Schlick's curve, which films ignore: where it is negative, films count as 0.
    # Compare near the mirror direction, with one alpha: masking of two alphas is another issue.
    batch = backends.isotropic(case.backend.mirrored[0].first(case.backend.counts.few))
    batch = _clear(batch, microfacets.LEAST_INDEX, 1.0).altered(thinfilm_thickness=300.0)
    without = batch.altered(thinfilm_thickness=0.0)
    bare = case.direct(without)
    empty, rare = (case.direct(batch.altered(thinfilm_ior=index)) for index in (1.0, RARE))
    cases = [Compared(batch, empty, bare), Compared(batch, rare, empty)]
    if "color0" not in batch.inputs:  # Schlick's curve uses another angle under a film
        thin = batch.altered(thinfilm_thickness=THIN_LIMIT)
        sensed = case.expected(thin) - case.expected(without)
        cases.append(Compared(batch, case.direct(thin), bare + sensed))
    return cases


def film_energy(case: Case) -> Iterator[Compared]:
    for batch in case.few[::2]:  # skip exact directions; other checks cover index 0
        most = case.direct(_mirror(case, batch))
        yield Compared(batch, np.maximum(case.direct(batch), most), most)


def diagnose_average(case: Case) -> Diagnosis:
    """Test whether F at one cosine or a mean of its ends replaces the average, or k is missing."""
    batch, measured, expected = film_average(case)
    rough = batch.altered(roughness=(max(ROUGHNESSES),) * 2)
    lost, most = (_parts(case, each, rough)[1].max() for each in (case.direct, case.expected))
    if lost < NEAR * most:
        return Diagnosis((Cause(Kind.MODEL, UNCOMPENSATED),))
    view = np.broadcast_to([np.sqrt(1.0 - SLANT * SLANT), 0.0, SLANT], batch.wo.shape)
    slanted = replace(batch, wo=view, wi=view * MIRRORED)
    normal = np.broadcast_to([0.0, 0.0, 1.0], batch.wo.shape)
    upright = replace(batch, wo=normal, wi=normal)
    others = {
        "average_at_half_vector": _averages(case, case.direct, batch)[0],
        "average_at_two_thirds": _averages(case, case.expected, slanted)[0],
        "average_by_ends": schlick_average(_averages(case, case.direct, upright)[0], 1.0),
    }
    errors = {key: np.sqrt(np.mean((measured - each) ** 2)) for key, each in others.items()}
    key = min(errors, key=errors.__getitem__)
    if not errors[key] < NEAR * np.sqrt(np.mean((measured - expected) ** 2)):
        return Diagnosis((diagnosis.OTHER_AVERAGE,))
    return replace(defect(key), permitted=key != "average_at_two_thirds")


def film_average(case: Case) -> Compared:
    """F_ss of films, for pairs whose curve F is not near 0."""
    batch = film_views(case.of(FilmSpec), microfacets.FRINGED)
    _, measured = _averages(case, case.direct, batch)
    F, expected = _averages(case, case.expected, batch)
    return Compared(batch, measured, expected).where(F.min(axis=1) > LEAST_F)


def film_smooth(case: Case) -> Compared:
    """Values F (1 + F_ss k) of lobes with small losses, compared with smoother lobes. F and k are the host's,
    and F_ss comes from the equations.
    """
    batch = film_views(case.of(FilmSpec), microfacets.FRINGED)
    F, F_ss = _averages(case, case.expected, batch)
    (first, k), (second, other_k) = (
        _parts(case, case.direct, batch.altered(roughness=(alpha, alpha))) for alpha in SMOOTH
    )
    expected = second * (1.0 + F_ss * k) / (1.0 + F_ss * other_k)
    return Compared(batch, first, expected).where(F.min(axis=1) > LEAST_F)


def diagnose_visible(case: Case) -> Diagnosis:
    explained = ALBEDO.diagnose(case)
    return explained if diagnosis.SINGLY_RIGHT not in explained.causes else Diagnosis((UNMASKED,))


def visible(films: microfacets.Films, case: Case) -> Compared:
    """Means F_o of F over visible facets, from albedos E_ss F_o (1 + F_ss k); F near 0 is skipped.

    Albedos are divided by the mirror's albedo, E_ss (1 + k) = 1.
    """
    batch = film_views(case.of(FilmSpec), films)

    def mean(direct: Function, albedo: Array) -> tuple[Array, Array]:
        F, F_ss = _averages(case, direct, batch)
        _, k = _parts(case, direct, batch)
        return F, np.asarray(albedo * (1.0 + k) / (1.0 + F_ss * k))

    _, measured = mean(case.direct, case.albedo(batch) / case.albedo(_mirror(case, batch)))
    F, expected = mean(case.expected, case.expected_albedo(batch))
    return Compared(batch, measured, expected).where(F.min(axis=1) > LEAST_F)


def film_brushed(case: Case) -> Compared:
    """Albedos of lobes with two alphas, divided by the mirror's albedo, if film_visible passes.

    Alternatives that the specification permits for films would fail here; film_visible judges them.
    """
    error = case.tolerance("film_visible")
    if not case.control and error.wrong(visible(microfacets.STEEP, case)).any():
        raise Implied(f"{case.host.name}: not measured, since film_visible already differs")
    batch, expected = case.backend.take(case.of(FilmSpec).stretched)
    return Compared(batch, case.albedo(batch) / case.albedo(_mirror(case, batch)), expected)


def _averages(case: Case, direct: Function, batch: Batch) -> tuple[Array, Array]:
    """F at the half vector of mirrored lights, and F_ss, (N, 3) each, from values at two roughnesses.

    A value divided by the value of perfectly reflecting facets is F (1 + F_ss k), with
    k = (1 - E_ss) / E_ss; a perfectly reflecting lobe has F = F_ss = 1.
    """
    (first, k), (second, other_k) = (
        _parts(case, direct, batch.altered(roughness=(alpha, alpha))) for alpha in ROUGHNESSES
    )
    F = (second * k - first * other_k) / (k - other_k)
    return F, (first - second) / (k - other_k) / np.maximum(F, 0.5 * LEAST_F)


def _parts(case: Case, direct: Function, batch: Batch) -> tuple[Array, Array]:
    """F (1 + F_ss k) and k of films in mirrored lights, (N, 3) each, by single scattering."""
    alpha, mu = np.broadcast_to(batch.inputs["roughness"], (len(batch.wo), 2))[:, 0], batch.wo[:, 2]
    facets = 0.25 / (alpha * alpha * smith_lambda(mu, alpha))[:, np.newaxis]
    return direct(batch) / facets, direct(_mirror(case, batch)) / facets - 1.0


def _mirror(case: Case, batch: Batch) -> Batch:
    return batch.altered(thinfilm_thickness=0.0, **case.of(FilmSpec).row.mirror)


# fmt: off
ROWS = (
    Check(key="lossless", claim="A lossless lobe returns all light at every roughness.",
          applies=FACETS, measure=lossless, tolerance="integral",
          control=controls.scale("values are 2 % too large", 1.02), explain=VALUE.diagnose),
    Check(key="dark",
          claim="Where the printed curve of dark colors is below 0, nothing is reflected.",
          applies=FACETS & family(FacetSpec, lambda spec: "color82" in spec.row.inputs), measure=dark,
          tolerance="value", control=controls.with_inputs("color82 is 1", color82=(1.0, 1.0, 1.0)),
          explain=replace(defect("curve_below_0"), permitted=True), requires=Ability.PAIRS,
          open=True),
    Check(key="shape",
          claim="For one view, the values for two lights have the same ratio as the products D F G2.",
          applies=FACETS, measure=shape, tolerance="shape",
          control=controls.with_batch(
              "the roughness is 10 % larger",
              lambda batch: batch.altered(roughness=np.minimum(1.1 * batch.inputs["roughness"], 1.0))),
          explain=STRETCHED.diagnose,
          requires=Ability.PAIRS, open=True, hosts=lobes.shows_exactly),
    Check(key="retroreflection",
          claim="The retroreflective lobe equals the mirror lobe for the mirrored view.",
          applies=FACETS | FILMS, measure=retroreflection, tolerance="retroreflection",
          control=controls.with_inputs("the flag is dropped", retroreflective=False),
          explain=diagnosis.ignored("retroreflective"), requires=Ability.PAIRS),
    Check(key="anisotropy", claim="The lobe turns with the tangent.",
          applies=FACETS, measure=anisotropy, tolerance="anisotropy",
          control=controls.with_inputs("the tangent is dropped", tangent=(1.0, 0.0, 0.0)),
          explain=diagnosis.ignored("tangent"), requires=Ability.PAIRS),
    Check(key="sky",
          claim="The reflection of an uneven environment is the integral of the values over it, also for retroreflection.",
          applies=FACETS, measure=reflected_sky, tolerance="sky",
          control=controls.with_inputs("the flag is dropped", retroreflective=False),
          explain=diagnose_sky, requires=Ability.PAIRS | Ability.LIGHT, methods=with_directions),
    Check(key="anisotropic_albedo",
          claim="The environment branch of an anisotropic lobe returns MaterialX's sum of its values, masked by the mean alpha; with the library's own sum, all that the lobe reflects.",
          applies=FACETS, measure=anisotropic_albedo, tolerance="anisotropic_albedo",
          control=isotropic, explain=Diagnosis((UNKNOWN,)),
          requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: with_directions(spec, methods) or bool(methods.searched)),
    Check(key="anisotropic_value", claim="The value of a lobe with two alphas matches the model.",
          applies=FACETS | FILMS, measure=STRETCHED, tolerance="anisotropic_value", control=isotropic,
          explain=STRETCHED.diagnose, requires=Ability.PAIRS, open=True),
    Check(key="anisotropic_throughput",
          claim="A lobe with two alphas passes to its base what it does not reflect.",
          applies=family(FacetSpec, lambda spec: spec.row.layerable),
          measure=anisotropic_throughput, tolerance="anisotropic_throughput", control=controls.pass_all,
          explain=Diagnosis((UNKNOWN,)), requires=Ability.PAIRS | Ability.LIGHT),
    Check(key="transmitted",
          claim="In a uniform environment, the light that passes lies between the BTDF's share and all that is not reflected.",
          applies=TRANSMITTING, measure=transmitted, tolerance="value",
          control=controls.scale("values are twice as large", 2.0), explain=diagnose_transmitted),
    Check(key="clear",
          claim="A white lobe that reflects and transmits returns all light of a uniform environment.",
          applies=CLEAR, measure=clear,
          tolerance="light", control=controls.scale("values are 5 % too large", 1.05),
          explain=diagnose_transmitted, methods=with_directions),
    Check(key="methods",
          claim="With a prefiltered environment, and as opacity, the same light passes, and a mirror reflects it.",
          applies=TRANSMITTING | MIRROR & lobes.PLAIN,
          measure=lambda case: (each for _, each in with_methods(case)),
          tolerance="methods", control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnose_methods, requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: methods == GENERATED),
    Check(key="kept",
          claim="Modes R and RT reflect, and pass to their base, the same light; mode T reflects nothing; mode R transmits nothing.",
          applies=TRANSMITTING, measure=lambda case: (compared for _, compared in modes(case)),
          tolerance="kept", control=controls.offset,
          explain=lambda case: diagnosis.causes_of(modes(case), case.tolerance("kept"))),
    Check(key="critical",
          claim="A smooth surface transmits 1 - F, and nothing beyond the critical angle.",
          applies=TRANSMITTING, measure=critical, tolerance="critical", control=DENSER,
          explain=diagnose_transmitted,
          methods=lambda spec, methods: methods.transmission == "refraction" or CLEAR(spec)),
    Check(key="inside",
          claim="From a denser medium passes what enters by the same paths; all other light is reflected.",
          applies=family(TransmissionSpec, lambda spec: "ior" in spec.row.inputs), measure=inside,
          tolerance="inside",
          control=controls.with_inputs("the index is that of the denser side", ior=1.5),
          explain=diagnose_transmitted, methods=lambda spec, methods: methods == GENERATED),
    Check(key="refraction",
          claim="An uneven environment is looked up along the ray that a solid sphere refracts.",
          applies=TRANSMITTING, measure=refraction, tolerance=REFRACTED, control=DENSER,
          explain=Diagnosis((UNKNOWN,)), requires=Ability.LIGHT,
          methods=lambda spec, methods: methods.transmission == "refraction"),
    Check(key="rough_refraction",
          claim="Rough glass of two alphas looks an uneven environment up where its visible facets refract to.",
          applies=TRANSMITTING, measure=rough_refraction, tolerance="rough_refraction", control=isotropic,
          explain=defect("other_refraction"), requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: methods == GENERATED),
    Check(key="transmitted_finite",
          claim="All light through the surface is finite at the edges of the domain.",
          applies=TRANSMITTING, measure=lambda case: count_not_finite(_edges(case)),
          tolerance=count_of(Quantity.VALUES), control=controls.no_number,
          explain=lambda case: Diagnosis(not_finite([_edges(case)]))),
    Check(key="transmitted_inputs",
          claim="Every input except retroreflective changes the light through the surface.",
          applies=TRANSMITTING, measure=lambda case: count_named(wrong_inputs(case)),
          tolerance=count_of(Quantity.INPUTS), control=controls.drop_changes,
          explain=lambda case: defect("wrong_effect", *wrong_inputs(case)), requires=Ability.LIGHT),
    Check(key="film_curve",
          claim="Under a film, a smooth lobe reflects the Airy reflectance at the cosine of the view.",
          applies=FILMS, measure=partial(curves, microfacets.SHARP), tolerance="film_curve", control=dropped,
          explain=VALUE.diagnose, requires=Ability.LIGHT, open=True),
    Check(key="film_orders", claim="At grazing angles, a thin film reflects the sum of all orders.",
          applies=FILMS, measure=partial(curves, microfacets.ORDERED), tolerance="film_orders", control=dropped,
          explain=VALUE.diagnose, open=True),
    Check(key="film_limit",
          claim="A film with an index of 1 or less, or with almost no thickness, leaves the lobe unchanged.",
          applies=FILMS, measure=film_limit, tolerance="film_limit",
          control=controls.with_inputs("every film has an index of 1.5", thinfilm_ior=1.5),
          explain=VALUE.diagnose, requires=Ability.LIGHT, open=True),
    Check(key="film_energy", claim="No film reflects more than a lobe that reflects everything.",
          applies=FILMS, measure=film_energy, tolerance="film_energy",
          control=controls.with_values(
              "values under a film are 100 times as large",
              lambda batch, values: values * (100.0 if np.any(batch.inputs["thinfilm_thickness"]) else 1.0)),
          explain=VALUE.diagnose, requires=Ability.LIGHT),
    Check(key="film_average",
          claim="The compensation uses the film's reflectance averaged over the hemisphere.",
          applies=FILMS, measure=film_average, tolerance="film_average", control=dropped,
          explain=diagnose_average, requires=Ability.LIGHT, open=True),
    Check(key="film_smooth",
          claim="On smooth lobes, too, the compensation uses the film's average.",
          applies=FILMS, measure=film_smooth, tolerance="film_smooth", control=dropped,
          explain=diagnose_average, requires=Ability.LIGHT, open=True),
    Check(key="film_visible",
          claim="The albedo averages the film's reflectance over the visible, lit facets.",
          applies=FILMS, measure=partial(visible, microfacets.STEEP), tolerance="film_visible", control=dropped,
          explain=diagnose_visible, requires=Ability.LIGHT, open=True, methods=with_directions),
    Check(key="film_brushed",
          claim="In an environment, a lobe of two alphas under a film reflects the film's share of what a mirror does.",
          applies=FILMS, measure=film_brushed, tolerance="anisotropic_throughput", control=dropped,
          explain=Diagnosis((UNKNOWN,)), requires=Ability.PAIRS | Ability.LIGHT, methods=with_directions),
    Check(key="film_glossy",
          claim="On glossy lobes, too, the albedo averages the film's reflectance over the visible facets.",
          applies=FILMS, measure=partial(visible, microfacets.GLOSSY), tolerance="film_glossy", control=dropped,
          explain=diagnose_visible, requires=Ability.LIGHT, open=True, methods=with_directions),
)
# fmt: on
