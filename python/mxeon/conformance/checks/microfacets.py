# SPDX-License-Identifier: Apache-2.0
"""Checks specific to microfacet lobes: reflection, transmitted light, and thin films.

F is the Fresnel reflectance. E_ss is the albedo of single scattering by facets that reflect all
light. F_ss is the average of F over the hemisphere. A lobe with compensation has the value of
single scattering times 1 + F_ss k, with k = (1 - E_ss) / E_ss.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance import backends, controls, diagnosis, samples
from mxeon.conformance.case import LIGHT, SCATTERING, Case, dead_inputs, model_values, throughputs
from mxeon.conformance.check import Check, family
from mxeon.conformance.checks import lobes, states
from mxeon.conformance.checks.lobes import CLEAR, FILMS, TRANSMITTING
from mxeon.conformance.diagnosis import (
    ALBEDO,
    NEAR,
    UNEXPLAINED,
    UNKNOWN,
    UNMASKED,
    VALUE,
    defect,
    not_finite,
)
from mxeon.conformance.results import Cause, Diagnosis, Kind, Quantity
from mxeon.conformance.samples import Array, Batch, Mask, Values, directions_at, float32, rounded
from mxeon.conformance.spec import NO_ABILITY, Ability, Spec
from mxeon.conformance.specs import microfacets
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

PAIRS = 1 << 12  # number of pairs near the mirror direction
RATIO_INDEX = 1.2  # smallest IOR of dielectrics in the check `shape`
# A lobe whose published Schlick curve is negative for some facets. Without a clamp, the albedo of
# the lobe is -0.035.
DIP: Values = {"color0": (0.06,) * 3, "color82": samples.BLACK, "color90": samples.WHITE}
DIP = {**DIP, "weight": 1.0, "exponent": 5.0, "roughness": (0.2, 0.2)}
LEAST_VALUE = 1e-3  # values and albedos up to 0.001 are not used as divisors
FACETS = lobes.PLAIN & lobes.FACETS  # microfacet lobes without film, transmission or combination
isotropic = controls.with_batch(
    "the roughness is the same in both directions",
    lambda batch: batch.altered(roughness=np.repeat(batch.inputs["roughness"][:, :1], 2, axis=1)),
)


def lossless(case: Case) -> Compared:
    batch, weights = case.backend.integrated
    mirror = batch.altered(**case.of(FacetSpec).row.mirror)
    views, albedo = lobes.summed(case, mirror, weights)
    return Compared(views, albedo, np.ones_like(albedo))


def shape(case: Case) -> Compared:
    """Ratios of values for two lights, compared with ratios for single scattering.

    The factor that compensates for multiple scattering cancels in a ratio.
    """
    batch, other = (
        raised(each.first(PAIRS), RATIO_INDEX, samples.LEAST_COLOR82)
        for each in case.backend.mirrored
    )
    first, second = (case.of(FacetSpec).single(each) for each in (batch, other))
    judged = np.asarray((np.minimum(first, second) > LEAST_VALUE).any(axis=1))
    cosine = np.minimum(batch.wo[:, 2], np.minimum(batch.wi[:, 2], other.wi[:, 2]))
    judged &= cosine >= microfacets.LEAST_TANGENT_COSINE
    scale = (first * second).max(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        measured = case.direct(batch) * second / scale
        expected = case.direct(other) * first / scale
    return Compared(batch, measured, expected).where(judged)


def dark(case: Case) -> Compared:
    batch = case.few[-1].altered(color0=samples.BLACK, color82=samples.BLACK, color90=samples.WHITE)
    batch = batch.where(microfacets.is_below_0(batch))
    return Compared(batch, case.direct(batch), np.zeros((1, 3)))


def raised(batch: Batch, index: float, color82: float) -> Batch:
    """Raise color82, and the IOR of dielectrics, to minimum values.

    In float32, the terms of a Fresnel curve cancel if the IOR is near 1, or if the curve has a deep
    dip at 82 degrees.
    """
    changes: dict[str, ArrayLike] = {}
    if np.ndim(batch.inputs.get("ior", 0.0)) == 1:
        changes["ior"] = np.maximum(batch.inputs["ior"], index)
    if "color82" in batch.inputs:
        changes["color82"] = np.maximum(batch.inputs["color82"], color82)
    return batch.altered(**changes)


def retroreflection(case: Case) -> Iterator[Compared]:
    for batch in case.few:
        mirrored = replace(batch, wo=batch.wo * MIRROR)
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
    """Reflection of the sky by a lobe, compared with the mean of the sky weighted by the lobe.

    The light of an uneven sky is divided by the light of a uniform sky, so constant factors of the
    lobe cancel. From the mirrored view, the retroreflective lobe must match the same mean.
    """
    spec = case.of(FacetSpec)
    views = case.backend.take(spec.stretched)[0].first(8)
    pairs, weights = spec.lit(views, case.backend.counts.nodes)
    value = spec.single if case.backend.searched else spec.summed
    values = value(pairs).reshape(*weights.shape, 3) * weights[:, :, np.newaxis]
    albedo = values.sum(axis=1)
    bright = albedo.min(axis=1) > LEAST_VALUE
    reflected = (values * samples.sky(pairs.wi).reshape(values.shape)).sum(axis=1)
    views, mean = views.where(bright), reflected[bright] / albedo[bright]
    mirrored = replace(views, wo=views.wo * MIRROR)
    for each in (views, mirrored.altered(retroreflective=True)):
        yield Compared(each, case.albedo(each, samples.sky_map()) / case.albedo(each), mean)


def diagnose_sky(case: Case) -> Diagnosis:
    """Find out whether all reflection is wrong, or only retroreflection."""
    if case.tolerance("sky").wrong(next(reflected_sky(case))).any():
        return defect("other_directions")
    return defect("retroreflective_environment")


def anisotropic_albedo(case: Case) -> Iterator[Compared]:
    """Albedos with the host's environment method, and with the library's own lookups if available.

    In a prefiltered environment, eonlib fits Fresnel curves. The fit is exact for perfect mirrors,
    but too coarse for metals. A sum over directions by eonlib's own code must clamp negative
    Schlick curves to 0.
    """
    spec = case.of(FacetSpec)
    batch, albedo = case.backend.take(spec.stretched)
    for methods in (case.host.active, *own_lookups(case)):
        shader = None if methods == case.host.active else generated(case, methods)
        if methods.environment == "prefilter":
            rows = [(batch.altered(**spec.row.mirror), batch.strength * ONE)]
            if spec.row.layerable:
                rows.append((case.views[0], case.expected_albedo(case.views[0])))
        elif methods.searched:
            rows = [(batch, albedo)]
            if "color82" in batch.inputs:
                dip = replace(batch.first(1), wo=directions_at([0.05], 0.5)).altered(**DIP)
                rows.append((dip, spec.integral(dip)))
        else:
            rows = [case.backend.take(spec.stretched_sums)]
        for views, expected in rows:
            light = case.evaluating.evaluate(case.inputs(views), "environment", shader=shader)
            yield Compared(views, case.outputs(views, light), expected)


def own_lookups(case: Case) -> list[Methods]:
    """Lighting methods with the library's own lookups, or [] if a client chose the methods."""
    from mxeon.shaders.library import environment_folders

    if case.host.active == GENERATED and not case.control and environment_folders(case.library):
        return [Methods(environment, searched=True) for environment in ("fis", "prefilter")]
    return []


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
    return throughputs(replace(case, chosen=(batch,)), *SCATTERING)


# --- light that is transmitted, in the branch that looks up an environment ------------------------

SUM_ERROR = 1e-3  # rms error of an engine's sum over facet normals
LEAST_COSINE = 0.05  # smallest cosine of views of smooth surfaces
# Smallest difference between a tested cosine and the cosine of the critical angle, where the slope
# of F is infinite.
CRITICAL = 0.05
LEAST_PASSED = 0.01  # smallest transmitted light for which directions are measured
# A refracted ray amplifies errors of the view's cosine by IOR^2 / cosine. The tolerance covers an
# amplification by 1000. If a ray amplifies more, the error is divided by amplification / 1000.
AMPLIFIED = 1000.0
REFRACTED = lobes.SURROUNDINGS.plus(
    roundings(4 * AMPLIFIED, "(four of a cosine, times a slope of 1000)")
)
NORMAL = np.array([0.0, 0.0, 1.0])
MIRROR = np.array([-1.0, -1.0, 1.0])  # factors that mirror a direction about the normal
ONE = np.ones((1, 3))


def with_directions(spec: Spec, methods: Methods) -> bool:
    """Whether shaders sum the environment over directions instead of reading a prefiltered map."""
    return methods.environment == "fis"


def diagnose_transmitted(case: Case) -> Diagnosis:
    """Test whether transmitted light is the mean of 1 - F, or is that mean divided by G_1.

    MaterialX divides by G_1. The diagnosis also reports values that are not finite.
    """
    compared, functions = list(transmitted(case)), case.of(TransmissionSpec).functions

    def mean(batch: Batch) -> Array:
        return np.asarray(batch.strength * functions.passed(batch.wo, batch.inputs, False))

    def over_masking(batch: Batch) -> Array:
        return mean(batch) / smith_g1(batch.wo, batch.inputs["roughness"])[:, np.newaxis]

    def distance(value: Callable[[Compared], Array]) -> float:
        errors = [(each.measured - value(each))[np.isfinite(each.measured)] for each in compared]
        return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))

    distances = {
        "seen_over_masking": distance(lambda each: over_masking(each.batch)),
        "seen": distance(lambda each: mean(each.batch)),
    }
    key = min(distances, key=distances.__getitem__)
    known = distances[key] < max(NEAR * distance(lambda each: each.expected), SUM_ERROR)
    causes = defect(key).causes if known else ()
    return Diagnosis((*causes, *not_finite(compared)) or (UNKNOWN,))


def transmitted(case: Case) -> Iterator[Compared]:
    """The light through the surface, from a uniform environment, must be between two limits.

    One limit is the light that the BTDF passes without compensation. The other limit is all light
    that is not reflected. The second limit may be below the first limit for some Schlick curves,
    because compensation reflects too much light.
    """
    spec = case.of(TransmissionSpec)
    for batch in case.views:
        yield limited(spec, batch, case.transmitted(batch), case.opaque)


def limited(spec: TransmissionSpec, batch: Batch, measured: Array, opaque: bool) -> Compared:
    """Transmitted light, compared with the nearest value between the limits of `transmitted`.

    If opacity replaces refraction, a lobe in mode T passes the tint times all light.
    """
    if opaque and not spec.reflects:
        return Compared(batch, measured, batch.strength * spec.functions.tint(batch.inputs))
    low, high = batch.strength * np.sort(model_values(spec, "ends")(batch), axis=0)
    return Compared(batch, measured, np.clip(measured, low, high))


def clear(case: Case) -> Iterator[Compared]:
    for batch in case.views:
        white = batch.altered(tint=(1.0, 1.0, 1.0), weight=1.0)
        yield Compared(white, case.albedo(white) + case.transmitted(white), ONE)


Evaluate = Callable[..., Array]
CLIENT = Client(turn=states.TURNING, intensity=0.5, two_sided=True)


def with_methods(case: Case) -> Iterator[tuple[Methods, Compared]]:
    """Check the light for each set of generator methods that a known client uses."""
    transmits = TRANSMITTING(case.spec)
    if transmits:  # lighting methods of the clients Storm and MaterialXView
        clients = [Methods("prefilter", "opacity"), Methods("prefilter", "refraction")]
        if CLEAR(case.spec):  # shaders of mode RT also contain the code of mode T
            clients += own_lookups(case)
    else:
        clients = [Methods("prefilter", "refraction", "monteCarlo")]
        if case.host.target not in UNTABLED:
            clients.append(replace(clients[0], albedo="table"))
    compare = transmitted_to_client if transmits else reflected_to_client
    for methods in clients:
        evaluate = partial(case.evaluating.evaluate, shader=generated(case, methods))
        for compared in compare(case, evaluate, methods):
            yield methods, compared


def transmitted_to_client(case: Case, evaluate: Evaluate, methods: Methods) -> Iterator[Compared]:
    opaque = methods.transmission == "opacity"
    for batch in case.views:
        light = case.outputs(batch, evaluate(case.inputs(batch), "transmission", client=CLIENT))
        if not opaque:
            light = light / CLIENT.intensity
            if "tint" in batch.inputs:  # a two-sided environment tints light on entry and on exit
                batch = batch.altered(tint=np.square(batch.inputs["tint"]))
        yield limited(case.of(TransmissionSpec), batch, light, opaque)


def reflected_to_client(case: Case, evaluate: Evaluate, methods: Methods) -> Iterator[Compared]:
    """Check the throughput, the light of a white mirror, and a turned environment's reflection.

    A white mirror reflects all light. If the shader reads albedos from a table, the reflected share
    may also be the ratio of the tabulated albedo to the exact albedo.
    """
    for batch in case.views:
        views = case.inputs(batch)
        passed = case.throughputs(batch, evaluate(views, "direct", "throughput"))
        yield Compared(batch, passed, case.throughput(batch, "direct"))
        mirror = case.of(FacetSpec).row.mirror
        plain, views = (backends.isotropic(each).altered(**mirror) for each in (batch, views))
        light = case.outputs(plain, evaluate(views, "environment", client=CLIENT))
        ratios = np.ones((len(views.wo), 1))
        if methods.albedo == "table":
            ratios = np.append(
                ratios, tabulated(plain.wo[:, 2:], plain.rough[:, np.newaxis]), axis=1
            )
        ratios = plain.strength * ratios
        low, high = ratios.min(axis=1, keepdims=True), ratios.max(axis=1, keepdims=True)
        light = light / CLIENT.intensity
        yield Compared(plain, light, np.clip(light, low, high))
        views = views.first(64)
        uneven = partial(evaluate, branch="environment", irradiance=samples.sky_map())
        turned = uneven(states.in_turn(views, CLIENT))
        yield Compared(views, uneven(views, client=CLIENT) / CLIENT.intensity, turned)


def tabulated(mu: Array, alpha: Array) -> Array:
    """E_ss at the four nearest texels of MaterialX's table, divided by E_ss at (mu, alpha), (N, 4).

    The first rows and columns of the table do not resolve the dip of E_ss to 0.89 near mu = alpha.
    """
    sides = ((np.floor(x), np.ceil(x)) for x in (TABLE_SIZE * mu - 0.5, TABLE_SIZE * alpha - 0.5))
    texels = (np.clip(corner, 0, TABLE_SIZE - 1) + 0.5 for corner in product(*sides))
    albedos = np.concatenate([ggx_albedo_dir(*each / TABLE_SIZE) for each in texels], axis=1)
    return np.asarray(albedos / ggx_albedo_dir(mu, alpha))


def diagnose_methods(case: Case) -> Diagnosis:
    tolerance = case.tolerance("methods")
    wrong = dict.fromkeys(
        str(methods) for methods, compared in with_methods(case) if tolerance.wrong(compared).any()
    )
    return defect("wrong_with_methods", *wrong) if wrong else UNEXPLAINED


def modes(case: Case) -> Iterator[tuple[Cause, Compared]]:
    """Compare the reflection of mode RT with mode R, and the reflection of mode T with 0."""
    spec = case.of(TransmissionSpec)
    mode_R = case.another(spec.reflection) if spec.reflects else None
    unlike = "_unlike_R" if mode_R else ""

    def cause(key: str, branch: str = "") -> Cause:
        return Cause(Kind.DEFECT, key, branch=branch)

    for batch in case.views:
        expected = mode_R.direct(batch) if mode_R else 0.0 * ONE
        yield cause(f"reflects_light{unlike}"), Compared(batch, case.direct(batch), expected)
        expected = mode_R.albedo(batch) if mode_R else 0.0 * ONE
        yield cause(f"reflects_environment{unlike}"), Compared(batch, case.albedo(batch), expected)
        for branch in SCATTERING if mode_R else LIGHT:
            expected = mode_R.throughput(batch, branch) if mode_R else ONE
            compared = Compared(batch, case.throughput(batch, branch), expected)
            yield cause("passes_other_light", branch), compared
        if mode_R:
            yield cause("mode_R_transmits"), Compared(batch, mode_R.transmitted(batch), 0.0 * ONE)


OTHER_INDEX = controls.with_inputs("the IOR is different", ior=2.5, color0=(0.5, 0.5, 0.5))


def critical(case: Case) -> Compared:
    batch = smooth(case)
    functions = case.of(TransmissionSpec).functions
    index, mu = functions.ior(batch.inputs), np.minimum(batch.wo[:, 2], 1.0)
    judged = np.abs(mu - np.sqrt(np.maximum(1.0 - index * index, 0.0))) > CRITICAL
    judged &= ~microfacets.falls_below_0(batch.inputs)
    batch, mu = batch.where(judged), mu[judged]
    passed = functions.tint(batch.inputs) * (1.0 - functions.fresnel(mu, batch.inputs))
    return Compared(batch, case.transmitted(batch), batch.strength * passed)


def inside(case: Case) -> Iterator[Compared]:
    """Light that leaves a denser medium, compared with light that enters along reversed paths."""
    spec, mu = case.of(TransmissionSpec), np.array([0.05, 0.2, 0.5, 0.75, 1.0])
    views = directions_at(mu, 0.5)
    for index, alpha in ((1.5, 0.4), (2.0, 1.0)):
        batch = replace(case.views[0].first(len(mu)), wo=views, wi=views).altered(
            ior=1.0 / index, roughness=(alpha, alpha), tint=samples.WHITE, weight=1.0
        )
        outside = {"ior": np.array([index]), "tint": ONE}
        expected = spec.reversed(mu, alpha, index, outside)[:, np.newaxis] * ONE
        passed = case.transmitted(batch)
        yield Compared(batch, passed, expected)
        if spec.reflects:
            yield Compared(batch, case.albedo(batch) + passed, ONE)


def refraction(case: Case) -> Compared:
    batch = smooth(case)
    index = case.of(TransmissionSpec).functions.ior(batch.inputs)
    # Choose frames in which a solid sphere refracts each view to the center of a texel of the sky.
    out = through_sphere(batch.wo, index, NORMAL)
    texel = samples.texel_middles(out)
    frames = samples.aimed(np.broadcast_to(np.eye(3), (len(out), 3, 3)), out, texel)
    axes = {"tangent": float32(frames[:, :, 0]), "normal": float32(frames[:, :, 2])}
    batch = replace(batch.altered(**axes), frame=frames)
    excess = np.maximum(1.0, (index**2 / batch.wo[:, 2])[:, np.newaxis] / AMPLIFIED)
    measured, bright = transmitted_sky(case, batch)
    return Compared(batch, measured, samples.sky(texel)).over(excess).where(bright)


def transmitted_sky(case: Case, batch: Batch) -> tuple[Array, Mask]:
    """Mean radiance of the sky through a surface, and a mask of pairs that pass enough light."""
    uniform = case.transmitted(batch)
    bright = np.asarray(uniform.min(axis=1) > LEAST_PASSED)
    uneven = case.transmitted(batch, samples.sky_map())
    return uneven / np.where(bright[:, np.newaxis], uniform, 1.0), bright


def rough_refraction(case: Case) -> Compared:
    """Mean of the sky seen through rough glass, compared with the sky at the mean ray direction.

    The glass has two alphas. Each visible facet passes the same share of light, in the direction in
    which a ray through the facet would leave a solid sphere.
    """
    functions, rng = case.of(TransmissionSpec).functions, samples.generator()
    batch = case.few[0].first(64)
    count = len(batch.wo)
    wo, alpha = samples.turned_directions(rng, count), rounded(0.1 ** rng.random((2, count)))
    if "color0" in batch.inputs:
        color = 0.2 * batch.inputs["color0"]  # F is constant, so all facets have the same weight
        batch = batch.altered(color0=color, color82=samples.WHITE, color90=color)
    else:
        batch = batch.altered(ior=1.2 + 0.8 * rng.random(count))
    turn = 2.0 * np.pi * rng.random(count)
    tangent = rounded([np.cos(turn), np.sin(turn), 0.0 * turn])
    batch = replace(batch.altered(weight=1.0, roughness=alpha, tangent=tangent), wo=wo)
    measured, bright = transmitted_sky(case, batch)
    axes = np.stack([tangent, np.cross(NORMAL, tangent), 0.0 * wo + NORMAL], axis=1)
    middles = (np.arange(32) + 0.5) / 32
    u = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    view, index, alpha = (
        np.repeat(each, len(u), axis=0)
        for each in ((axes @ wo[:, :, np.newaxis])[:, :, 0], functions.ior(batch.inputs), alpha)
    )
    facets = sampling.ggx_sample(view, np.tile(u, (count, 1)), alpha)[0] + view
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    out = through_sphere(view, index, facets).reshape(count, len(u), 3).mean(axis=1)
    return Compared(batch, measured, samples.sky((out[:, np.newaxis] @ axes)[:, 0])).where(bright)


def through_sphere(wo: Array, index: Array, facet: Array) -> Array:
    """Directions, (N, 3), in which view rays leave a solid sphere after entering at a facet.

    A ray meets the far side of the sphere at the same angle, so the two refractions turn the ray by
    equal angles. The leaving ray is the incoming ray, rotated by 180 degrees about the inner ray.
    """
    inner = transmission.refraction_direction(wo, facet, index)
    return np.asarray(wo - 2.0 * np.sum(wo * inner, axis=1, keepdims=True) * inner)


def smooth(case: Case) -> Batch:
    batch = case.few[0].first(512)
    if "color0" in batch.inputs:  # add a nearly white color0, from which a high IOR follows
        batch = batch.with_row(0, directions_at(0.1, 0.5), weight=1.0, color0=0.99)
    return batch.where(batch.wo[:, 2] >= LEAST_COSINE).altered(roughness=(0.0, 0.0))


def transmitted_edges(case: Case) -> Compared:
    # Each pair needs a slow sum over directions, so test a fifth of the pairs with extreme inputs.
    batch = case.backend.edges.where(slice(None, None, 5))
    return Compared(batch, case.transmitted(batch), np.zeros((1, 3)))


def wrong_inputs(case: Case) -> list[str]:
    """Inputs that fail to change the light through the surface, or that wrongly change the light.

    `retroreflective` affects only reflection. If opacity replaces refraction, only weight and tint
    affect a lobe in mode T. In all other cases, every input must have an effect. The tangent has an
    effect if the alphas differ.
    """
    batch = case.few[0].first(64)
    dead = dead_inputs(case, batch, lambda batch: case.transmitted(batch, samples.sky_map()))
    unused = {"retroreflective"}
    if case.opaque and not CLEAR(case.spec):
        unused |= case.changes.keys() - {"weight", "tint"}
    return [name for name in case.changes if (name in dead) != (name in unused)]


# --- thin films -----------------------------------------------------------------------------------

Function = Callable[[Batch], Array]
ROUGHNESSES = (1.0, 0.3)  # alphas with strong and with weak compensation
# Alphas that need almost no compensation.
SMOOTH = (0.04, 0.005)
LEAST_F = 0.01  # films with a smaller Fresnel reflectance are not compared
THIN_LIMIT = 1e-3  # thickness in nm at which a film must have no effect


def curves(films: microfacets.Films, case: Case) -> Compared:
    """F of films: the value in the mirror direction, divided by the value of a perfect mirror.

    The lobes are so smooth that compensation has no effect.
    """
    batch = film_views(case.of(FilmSpec), films)
    mirror = mirror_of(case, batch)
    expected = case.expected(batch) / case.expected(mirror)
    return Compared(batch, case.direct(batch) / case.direct(mirror), expected)


def film_limit(case: Case) -> list[Compared]:
    """Values under films of IOR 1 or less, or of thickness THIN_LIMIT, compared with bare lobes.

    A film with an IOR below 1 must equal a film with IOR 1, even if the film with IOR 1 is wrong.
    For a thin film, even the equations deviate, because the tabulated sensitivities of the eye have
    five digits and do not add up to exactly 1. This deviation is accepted.
    """
    # Remove the dip of Schlick's curve, because a negative F counts as 0 under a film. Compare near
    # the mirror direction and with equal alphas, because another check covers two alphas.
    batch = backends.isotropic(case.backend.mirrored[0].first(case.backend.counts.few))
    batch = raised(batch, microfacets.LEAST_INDEX, 1.0).altered(thinfilm_thickness=300.0)
    without = batch.altered(thinfilm_thickness=0.0)
    bare = case.direct(without)
    vacuum, below_1 = (case.direct(batch.altered(thinfilm_ior=index)) for index in (1.0, 0.5))
    cases = [Compared(batch, vacuum, bare), Compared(batch, below_1, vacuum)]
    if "color0" not in batch.inputs:  # even a thin film changes the angle in Schlick's curve
        thin = batch.altered(thinfilm_thickness=THIN_LIMIT)
        deviation = case.expected(thin) - case.expected(without)
        cases.append(Compared(batch, case.direct(thin), bare + deviation))
    return cases


def film_energy(case: Case) -> Iterator[Compared]:
    for batch in case.few[::2]:  # skip special pairs, because other checks cover films of IOR 0
        most = case.direct(mirror_of(case, batch))
        yield Compared(batch, np.maximum(case.direct(batch), most), most)


def diagnose_average(case: Case) -> Diagnosis:
    """Test whether k is missing, or if F at one cosine or a mean of F0 and F90 replaces F_ss."""
    batch, measured, expected = film_average(case)
    (_, k), (_, expected_k) = (
        film_factors(case, value, batch, 1.0) for value in (case.direct, case.expected)
    )
    if k.max() < NEAR * expected_k.max():
        return Diagnosis((Cause(Kind.MODEL, UNCOMPENSATED),))

    def curve(value: Function, mu: float) -> Array:
        wo = directions_at(np.full(len(batch.wo), mu), 0.0)
        return averages(case, value, replace(batch, wo=wo, wi=wo * MIRROR))[0]

    others = {
        "average_at_half_vector": averages(case, case.direct, batch)[0],
        "average_at_two_thirds": curve(case.expected, 2.0 / 3.0),
        "average_by_ends": schlick_average(curve(case.direct, 1.0), 1.0),
    }
    errors = {key: np.sqrt(np.mean((measured - each) ** 2)) for key, each in others.items()}
    key = min(errors, key=errors.__getitem__)
    if not errors[key] < NEAR * np.sqrt(np.mean((measured - expected) ** 2)):
        return Diagnosis((diagnosis.OTHER_AVERAGE,))
    return replace(defect(key), permitted=key != "average_at_two_thirds")


def film_average(case: Case) -> Compared:
    batch = film_views(case.of(FilmSpec), microfacets.FRINGED)
    _, measured = averages(case, case.direct, batch)
    F, expected = averages(case, case.expected, batch)
    return Compared(batch, measured, expected).where(F.min(axis=1) > LEAST_F)


def film_smooth(case: Case) -> Compared:
    """Values F (1 + F_ss k) of smooth lobes, compared with a prediction from smoother lobes.

    F and k are measured on the host, and F_ss is computed by the model.
    """
    batch = film_views(case.of(FilmSpec), microfacets.FRINGED)
    F, F_ss = averages(case, case.expected, batch)
    (first, k), (second, other_k) = (film_factors(case, case.direct, batch, a) for a in SMOOTH)
    expected = second * (1.0 + F_ss * k) / (1.0 + F_ss * other_k)
    return Compared(batch, first, expected).where(F.min(axis=1) > LEAST_F)


def diagnose_visible(case: Case) -> Diagnosis:
    explained = ALBEDO.diagnose(case)
    return explained if diagnosis.SINGLY_RIGHT not in explained.causes else Diagnosis((UNMASKED,))


def visible(films: microfacets.Films, case: Case) -> Compared:
    """Averages F_o of F over visible facets, computed from albedos E_ss F_o (1 + F_ss k).

    Albedos are divided by the albedo of a perfect mirror, E_ss (1 + k) = 1. Pairs whose F is at
    most LEAST_F are skipped.
    """
    batch = film_views(case.of(FilmSpec), films)

    def mean(value: Function, albedo: Array) -> tuple[Array, Array]:
        F, F_ss = averages(case, value, batch)
        _, k = film_factors(case, value, batch, batch.rough)
        return F, np.asarray(albedo * (1.0 + k) / (1.0 + F_ss * k))

    _, measured = mean(case.direct, case.albedo(batch) / case.albedo(mirror_of(case, batch)))
    F, expected = mean(case.expected, case.expected_albedo(batch))
    return Compared(batch, measured, expected).where(F.min(axis=1) > LEAST_F)


def film_brushed(case: Case) -> Compared:
    """Albedos of lobes with two alphas under films, divided by the albedo of a perfect mirror.

    The comparison is skipped if the check `film_visible` fails, because some permitted formulas for
    films fail both checks.
    """
    tolerance = case.tolerance("film_visible")
    if not case.control and tolerance.wrong(visible(microfacets.STEEP, case)).any():
        raise Implied(f"{case.host.name}: not measured, because film_visible already differs")
    batch, expected = case.backend.take(case.of(FilmSpec).stretched)
    return Compared(batch, case.albedo(batch) / case.albedo(mirror_of(case, batch)), expected)


def averages(case: Case, value: Function, batch: Batch) -> tuple[Array, Array]:
    """F at the half vector, and F_ss, (N, 3) each, from values in the mirror direction.

    Two roughnesses are measured, because F and F_ss are two unknowns.
    """
    (first, k), (second, other_k) = (film_factors(case, value, batch, a) for a in ROUGHNESSES)
    F = (second * k - first * other_k) / (k - other_k)
    return F, (first - second) / (k - other_k) / np.maximum(F, 0.5 * LEAST_F)


def film_factors(
    case: Case, value: Function, batch: Batch, alpha: ArrayLike
) -> tuple[Array, Array]:
    """F (1 + F_ss k) and k of films for lights in the mirror direction, (N, 3) each.

    Values are divided by the single scattering of perfectly reflecting facets. So a perfect mirror,
    for which F = F_ss = 1, has the divided value 1 + k.
    """
    alpha = np.broadcast_to(alpha, len(batch.wo))
    batch = batch.altered(roughness=np.stack([alpha, alpha], axis=1))
    facets = 0.25 / (alpha * alpha * smith_lambda(batch.wo[:, 2], alpha))[:, np.newaxis]
    return value(batch) / facets, value(mirror_of(case, batch)) / facets - 1.0


def mirror_of(case: Case, batch: Batch) -> Batch:
    return batch.altered(thinfilm_thickness=0.0, **case.of(FilmSpec).row.mirror)


FILM = partial(
    Check,
    applies=FILMS,
    control=controls.with_inputs("the film is dropped", thinfilm_thickness=0.0),
    explain=VALUE.diagnose,
    requires=Ability.LIGHT,
    open=True,
)


# fmt: off
ROWS = (
    Check(key="lossless", claim="A lossless lobe returns all light at every roughness.",
          applies=FACETS, measure=lossless, tolerance="integral",
          control=controls.scale("values are 2 % too large", 1.02), explain=VALUE.diagnose),
    Check(key="dark",
          claim="Where the published curve of a dark color is below 0, nothing is reflected.",
          applies=FACETS & family(FacetSpec, lambda spec: "color82" in spec.row.inputs), measure=dark,
          tolerance="value", control=controls.with_inputs("color82 is 1", color82=(1.0, 1.0, 1.0)),
          explain=replace(defect("curve_below_0"), permitted=True), requires=Ability.PAIRS,
          open=True),
    Check(key="shape",
          claim="For one view, the values for two lights have the same ratio as the products D F G2.",
          applies=FACETS, measure=shape,
          control=controls.with_batch(
              "the roughness is 10 % larger",
              lambda batch: batch.altered(roughness=np.minimum(1.1 * batch.inputs["roughness"], 1.0))),
          explain=STRETCHED.diagnose, requires=Ability.PAIRS, open=True, hosts=lobes.shows_exactly),
    Check(key="retroreflection",
          claim="The retroreflective lobe equals the mirror lobe for the mirrored view.",
          applies=FACETS | FILMS, measure=retroreflection,
          control=controls.with_inputs("the flag is dropped", retroreflective=False),
          explain=diagnosis.ignored("retroreflective"), requires=Ability.PAIRS),
    Check(key="anisotropy", claim="The lobe turns with the tangent.",
          applies=FACETS, measure=anisotropy,
          control=controls.with_inputs("the tangent is dropped", tangent=(1.0, 0.0, 0.0)),
          explain=diagnosis.ignored("tangent"), requires=Ability.PAIRS),
    Check(key="sky",
          claim="The reflection of an uneven environment is the integral of value times radiance, also for retroreflection.",
          applies=FACETS, measure=reflected_sky,
          control=controls.with_inputs("the flag is dropped", retroreflective=False),
          explain=diagnose_sky, requires=Ability.PAIRS | Ability.LIGHT, methods=with_directions),
    Check(key="anisotropic_albedo",
          claim="The environment branch of an anisotropic lobe returns MaterialX's sum, masked by the mean alpha, or, with the library's own sum, the albedo.",
          applies=FACETS, measure=anisotropic_albedo, control=isotropic, requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: with_directions(spec, methods) or bool(methods.searched)),
    Check(key="anisotropic_value", claim="The value of an anisotropic lobe matches the model.",
          applies=FACETS | FILMS, measure=STRETCHED, control=isotropic,
          requires=Ability.PAIRS, open=True),
    Check(key="anisotropic_throughput",
          claim="An anisotropic lobe passes to its base the light that it does not reflect.",
          applies=family(FacetSpec, lambda spec: spec.row.layerable),
          measure=anisotropic_throughput, control=controls.pass_all, requires=Ability.PAIRS | Ability.LIGHT),
    Check(key="transmitted",
          claim="In a uniform environment, the transmitted light lies between the BTDF's integral and all light that is not reflected.",
          applies=TRANSMITTING, measure=transmitted, tolerance="value",
          control=controls.scale("values are twice as large", 2.0), explain=diagnose_transmitted),
    Check(key="clear",
          claim="A white lobe that reflects and transmits returns all light of a uniform environment.",
          applies=CLEAR, measure=clear, tolerance="light",
          control=controls.scale("values are 5 % too large", 1.05),
          explain=diagnose_transmitted, methods=with_directions),
    Check(key="methods",
          claim="With a prefiltered environment and with opacity, the same light is transmitted, and a mirror reflects all light.",
          applies=TRANSMITTING | (lobes.PLAIN & family(FacetSpec, lambda spec: spec.model == "schlick")),
          measure=lambda case: (compared for _, compared in with_methods(case)),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnose_methods, requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: methods == GENERATED),
    Check(key="kept",
          claim="Modes R and RT reflect, and pass to their base, the same light; mode T reflects nothing; mode R transmits nothing.",
          applies=TRANSMITTING, measure=lambda case: (compared for _, compared in modes(case)),
          control=controls.offset,
          explain=lambda case: diagnosis.causes_of(modes(case), case.tolerance("kept"))),
    Check(key="critical",
          claim="A smooth surface transmits 1 - F, and nothing beyond the critical angle.",
          applies=TRANSMITTING, measure=critical, control=OTHER_INDEX, explain=diagnose_transmitted,
          methods=lambda spec, methods: methods.transmission == "refraction" or CLEAR(spec)),
    Check(key="inside",
          claim="A denser medium lets out the light that could enter along the same paths, and reflects all other light.",
          applies=family(TransmissionSpec, lambda spec: "ior" in spec.row.inputs), measure=inside,
          control=controls.with_inputs("the IOR is that of the denser side", ior=1.5),
          explain=diagnose_transmitted, methods=lambda spec, methods: methods == GENERATED),
    Check(key="refraction",
          claim="An uneven environment is looked up along the ray that a solid sphere refracts.",
          applies=TRANSMITTING, measure=refraction, tolerance=REFRACTED, control=OTHER_INDEX,
          requires=Ability.LIGHT, methods=lambda spec, methods: methods.transmission == "refraction"),
    Check(key="rough_refraction",
          claim="Anisotropic rough glass looks up the environment in the directions to which its visible facets refract.",
          applies=TRANSMITTING, measure=rough_refraction, control=isotropic,
          explain=defect("other_refraction"), requires=Ability.PAIRS | Ability.LIGHT,
          methods=lambda spec, methods: methods == GENERATED),
    Check(key="transmitted_finite",
          claim="The transmitted light is finite at the edges of the domain.",
          applies=TRANSMITTING, measure=lambda case: count_not_finite(transmitted_edges(case)),
          tolerance=count_of(Quantity.VALUES), control=controls.no_number,
          explain=lambda case: Diagnosis(not_finite([transmitted_edges(case)]))),
    Check(key="transmitted_inputs",
          claim="Every input except retroreflective changes the transmitted light.",
          applies=TRANSMITTING, measure=lambda case: count_named(wrong_inputs(case)),
          tolerance=count_of(Quantity.INPUTS), control=controls.drop_changes,
          explain=lambda case: defect("wrong_effect", *wrong_inputs(case)), requires=Ability.LIGHT),
    FILM(key="film_curve",
         claim="Under a film, a smooth lobe reflects the Airy reflectance at the cosine of the view.",
         measure=partial(curves, microfacets.SHARP)),
    FILM(key="film_orders", claim="At grazing angles, a thin film reflects the sum of all interference orders.",
         measure=partial(curves, microfacets.ORDERED), requires=NO_ABILITY),
    FILM(key="film_limit",
         claim="A film with an IOR of 1 or less, or with almost no thickness, leaves the lobe unchanged.",
         measure=film_limit,
         control=controls.with_inputs("every film has an IOR of 1.5", thinfilm_ior=1.5)),
    FILM(key="film_energy", claim="No film reflects more than a lobe that reflects everything.",
         measure=film_energy, open=False,
         control=controls.with_values(
             "values under a film are 100 times as large",
             lambda batch, values: values * (100.0 if np.any(batch.inputs["thinfilm_thickness"]) else 1.0))),
    FILM(key="film_average",
         claim="The compensation uses the film's reflectance averaged over the hemisphere.",
         measure=film_average, explain=diagnose_average),
    FILM(key="film_smooth", claim="The compensation of smooth lobes also uses the film's average reflectance.",
         measure=film_smooth, explain=diagnose_average),
    FILM(key="film_visible",
         claim="The albedo averages the film's reflectance over the visible, lit facets.",
         measure=partial(visible, microfacets.STEEP), explain=diagnose_visible, methods=with_directions),
    FILM(key="film_brushed",
         claim="In an environment, an anisotropic lobe under a film reflects the film's reflectance times a mirror's light.",
         measure=film_brushed, tolerance="anisotropic_throughput", explain=UNEXPLAINED,
         requires=Ability.PAIRS | Ability.LIGHT, open=False, methods=with_directions),
    FILM(key="film_glossy",
         claim="The albedo of glossy lobes also averages the film's reflectance over the visible facets.",
         measure=partial(visible, microfacets.GLOSSY), explain=diagnose_visible, methods=with_directions),
)
# fmt: on
