# SPDX-License-Identifier: Apache-2.0
"""Checks of microfacets under a thin film."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.backends import WHITE
from mxeon.conformance.case import Case
from mxeon.conformance.check import (
    check,
    control,
    of_family,
    pass_all,
    scale_cosine,
    with_inputs,
    with_values,
)
from mxeon.conformance.checks.lobes import finite
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.candidates import NEAR, Diagnosis
from mxeon.conformance.diagnosis.comparisons import ALBEDO, THROUGHPUT, VALUE
from mxeon.conformance.samples import Array, Batch
from mxeon.conformance.specs.microfacets import LEAST_INDEX
from mxeon.conformance.specs.thin_films import (
    FRINGED,
    GLOSSY,
    ORDERED,
    SHARP,
    STEEP,
    FilmSpec,
    film_views,
)
from mxeon.conformance.tolerance import Compared, count_of
from mxeon.models.microfacet.ggx import smith_lambda

Function = Callable[[Batch], Array]
MIRRORED = (-1.0, -1.0, 1.0)
ROUGHNESSES = (1.0, 0.3)  # with much and with little compensation
SMOOTH = (0.04, 0.005)  # with next to none, for whose average a shader may take fewer cosines
RIGHT = "each value on its own is within tolerance"  # of an explanation that found nothing
LEAST_F = 0.01  # of a curve by which its averages are divided
THIN_LIMIT = 1e-3  # thickness in nm of a film that changes nothing
SLANT = 2.0 / 3.0  # mean cosine of a hemisphere, weighted by the cosine
RARE = 0.5  # index of a film that MaterialX counts as vacuum

is_film = of_family(FilmSpec)


@control("the film is a quarter thicker")
def thicker(case: Case) -> Case:
    def inputs(batch: Batch) -> Batch:
        thickness = np.asarray(batch.inputs["thinfilm_thickness"])
        return batch.altered(thinfilm_thickness=1.25 * thickness)

    return replace(case, inputs=inputs)


def brighter(batch: Batch, values: Array) -> Array:
    return values * np.where(np.any(batch.inputs["thinfilm_thickness"]), 100.0, 1.0)


check(
    "film",
    "Under a thin film, the value contains the film's Airy reflectance.",
    is_film,
    thicker,
    open=True,
)(VALUE)


@check(
    "film_curve",
    "Under a film, a smooth lobe reflects the Airy reflectance at the cosine of the view.",
    is_film,
    thicker,
    lit=True,
    open=True,
)
def film_curve(case: Case) -> Compared:
    """A film's curve at one cosine, of which the first orders count alone."""
    return _curves(case, film_views(case.of(FilmSpec), SHARP))


@check(
    "film_orders",
    "At grazing angles, a thin film reflects the sum of all orders.",
    is_film,
    thicker,
    open=True,
)
def film_orders(case: Case) -> Compared:
    """The same at grazing and of thin films, of which all orders count."""
    return _curves(case, film_views(case.of(FilmSpec), ORDERED))


def _curves(case: Case, batch: Batch) -> Compared:
    """Curves: values in mirrored lights over those of a mirror.

    The lobes are so smooth that their compensation is 1, whatever average it has.
    """
    (measured, mirror), (expected, white) = (
        (direct(batch), direct(_mirror(case, batch))) for direct in _sides(case)
    )
    return Compared(batch, measured / mirror, expected / white)


@check(
    "film_limit",
    "A film with an index of 1 or less, or with almost no thickness, leaves the lobe unchanged.",
    is_film,
    with_inputs("every film has an index of 1.5", thinfilm_ior=1.5),
    lit=True,
    open=True,
)
def film_limit(case: Case) -> list[Compared]:
    """Values under a film of index 1, and under one of THIN_LIMIT, against those without.

    A film of an index below that of vacuum counts as one of index 1, whatever that one does. Under a thin
    one the sensitivities count, of five digits, whose sum is not 1: as much as in the equations is right.
    """
    batch = _compared(case)
    without = batch.altered(thinfilm_thickness=0.0)
    bare = case.direct(without)
    empty, rare = (case.direct(batch.altered(thinfilm_ior=index)) for index in (1.0, RARE))
    cases = [Compared(batch, empty, bare), Compared(batch, rare, empty)]
    if "color0" not in batch.inputs:  # whose curve is taken at another angle under a film
        thin = batch.altered(thinfilm_thickness=THIN_LIMIT)
        sensed = case.expected(thin) - case.expected(without)
        cases.append(Compared(batch, case.direct(thin), bare + sensed))
    return cases


def _compared(case: Case) -> Batch:
    """Random pairs with a film, whose substrate float32 can tell from vacuum.

    Schlick's curve has no dip at 82 degrees: where that is negative, a film's counts as 0.
    """
    batch = case.few[0]
    changes: dict[str, ArrayLike] = {"thinfilm_thickness": 300.0}
    if "tint" in batch.inputs:
        changes["ior"] = np.maximum(batch.inputs["ior"], LEAST_INDEX)
    if "color82" in batch.inputs:
        changes["color82"] = WHITE
    return batch.altered(**changes)


@check(
    "film_energy",
    "No film reflects more than a lobe that reflects everything.",
    is_film,
    with_values("values under a film are 100 times as large", brighter),
    lit=True,
)
def film_energy(case: Case) -> list[Compared]:
    cases = []
    for batch in case.few[::2]:  # a mirror of index 0 is another check where directions are exact
        mirror = batch.altered(thinfilm_thickness=0.0, **case.of(FilmSpec).row.mirror)
        most = case.direct(mirror)
        cases.append(Compared(batch, np.maximum(case.direct(batch), most), most))
    return cases


check(
    "film_environment",
    "The environment branch returns the film's directional albedo.",
    is_film,
    thicker,
    lit=True,
    open=True,
)(ALBEDO)


@check(
    "film_average",
    "The compensation uses the film's reflectance averaged over the hemisphere.",
    is_film,
    thicker,
    lit=True,
    open=True,
    diagnose=lambda case: diagnose_average(case),
)
def film_average(case: Case) -> Compared:
    return average_case(case, film_views(case.of(FilmSpec), FRINGED))


def average_case(case: Case, batch: Batch) -> Compared:
    """F_ss of films whose curve is not next to 0, of the host and of the equations."""
    (_, measured), (F, expected) = (_averages(case, each, batch) for each in _sides(case))
    bright = F.min(axis=1) > LEAST_F
    return Compared(batch.where(bright), measured[bright], expected[bright])


@check(
    "film_smooth",
    "On smooth lobes, too, the compensation uses the film's average.",
    is_film,
    thicker,
    lit=True,
    open=True,
    diagnose=lambda case: diagnose_average(case),
)
def film_smooth(case: Case) -> Compared:
    """Values F (1 + F_ss k) of lobes that lose little, against those of lobes that lose less.

    F and k are the host's, and F_ss that of the equations.
    """
    batch = film_views(case.of(FilmSpec), FRINGED)
    F, F_ss = _averages(case, case.expected, batch)
    (first, k), (second, other_k) = (
        _parts(case, case.direct, batch.altered(roughness=(alpha, alpha))) for alpha in SMOOTH
    )
    expected = second * (1.0 + F_ss * k) / (1.0 + F_ss * other_k)
    bright = F.min(axis=1) > LEAST_F
    return Compared(batch.where(bright), first[bright], expected[bright])


@check(
    "film_visible",
    "The albedo averages the film's reflectance over the visible, lit facets.",
    is_film,
    thicker,
    lit=True,
    open=True,
    diagnose=lambda case: diagnose_visible(case),
)
def film_visible(case: Case) -> Compared:
    return _visible_cases(case, film_views(case.of(FilmSpec), STEEP))


@check(
    "film_glossy",
    "On glossy lobes, too, the albedo averages the film's reflectance over the visible facets.",
    is_film,
    thicker,
    lit=True,
    open=True,
    diagnose=lambda case: diagnose_visible(case),
)
def film_glossy(case: Case) -> Compared:
    """The same of lobes whose facets are much alike."""
    return _visible_cases(case, film_views(case.of(FilmSpec), GLOSSY))


def _visible_cases(case: Case, batch: Batch) -> Compared:
    """Means over the visible facets of films whose curve is not next to 0."""
    albedos = (
        lambda each: case.albedo(each) / case.albedo(_mirror(case, each)),
        case.expected_albedo,
    )
    (_, measured), (F, expected) = (
        _visible(case, direct, albedo, batch)
        for direct, albedo in zip(_sides(case), albedos, strict=True)
    )
    bright = F.min(axis=1) > LEAST_F
    return Compared(batch.where(bright), measured[bright], expected[bright])


check(
    "film_throughput",
    "The throughput of a layer under a film is 1 - E of the film.",
    lambda spec: isinstance(spec, FilmSpec) and spec.row.layerable,
    pass_all,
    lit=True,
)(THROUGHPUT)


check(
    "film_finite",
    "Every value under a film is finite at the edges of the domain.",
    is_film,
    scale_cosine("the value is divided by cos(theta_o)", -1),
    tolerance=count_of("values"),
    lit=True,
    diagnose=input_diagnosis.diagnose_finite,
)(finite)


def diagnose_average(case: Case) -> Diagnosis:
    """Whether F at one cosine stands in the place of its average."""
    batch, measured, expected = average_case(case, film_views(case.of(FilmSpec), FRINGED))
    direct, model = _sides(case)
    view = np.broadcast_to([np.sqrt(1.0 - SLANT * SLANT), 0.0, SLANT], batch.wo.shape)
    slanted = replace(batch, wo=view, wi=view * MIRRORED)
    others = {
        "at the half vector": _averages(case, direct, batch)[0],
        "at the cosine 2/3": _averages(case, model, slanted)[0],
    }
    errors = {words: np.sqrt(np.mean((measured - each) ** 2)) for words, each in others.items()}
    words = min(errors, key=errors.__getitem__)
    if not errors[words] < NEAR * np.sqrt(np.mean((measured - expected) ** 2)):
        return Diagnosis("the compensation uses a different average of the film's reflectance")
    text = f"the compensation uses F {words} instead of its average"
    return Diagnosis(text, permitted=words == "at the half vector")


def diagnose_visible(case: Case) -> Diagnosis:
    """The explanation of a film's albedo, or the weights of the facets where that is right."""
    explained = ALBEDO.diagnose(case)
    if RIGHT not in explained.text:
        return explained
    return Diagnosis("the visible facets are not weighted by masking and shadowing")


def _sides(case: Case) -> tuple[Function, Function]:
    """Values of the host, and of the equations."""
    return case.direct, case.expected


def _averages(case: Case, direct: Function, batch: Batch) -> tuple[Array, Array]:
    """F at the half vector of mirrored lights, and F_ss, (N, 3) each, from values at two roughnesses.

    A value over that of facets that reflect everything is F (1 + F_ss k), k = (1 - E_ss) / E_ss, in
    which a lobe that reflects everything has F = F_ss = 1.
    """
    (first, k), (second, other_k) = (
        _parts(case, direct, batch.altered(roughness=(alpha, alpha))) for alpha in ROUGHNESSES
    )
    F = (second * k - first * other_k) / (k - other_k)
    return F, (first - second) / (k - other_k) / np.maximum(F, 0.5 * LEAST_F)


def _parts(case: Case, direct: Function, batch: Batch) -> tuple[Array, Array]:
    """F (1 + F_ss k) and k of films in mirrored lights, (N, 3) each; k is (1 - E_ss) / E_ss."""
    facets = _facets(batch)
    return direct(batch) / facets, direct(_mirror(case, batch)) / facets - 1.0


def _facets(batch: Batch) -> Array:
    """Values of facets that reflect everything, in mirrored lights, (N, 1)."""
    alpha, mu = np.broadcast_to(batch.inputs["roughness"], (len(batch.wo), 2))[:, 0], batch.wo[:, 2]
    return np.asarray(0.25 / (alpha * alpha * smith_lambda(mu, alpha))[:, np.newaxis])


def _visible(case: Case, direct: Function, albedo: Function, batch: Batch) -> tuple[Array, Array]:
    """F at the half vector, and F_o of an albedo E_ss F_o (1 + F_ss k), (N, 3) each.

    The albedo is that over the one of a mirror, E_ss (1 + k) = 1.
    """
    F, F_ss = _averages(case, direct, batch)
    _, k = _parts(case, direct, batch)
    return F, np.asarray(albedo(batch) * (1.0 + k) / (1.0 + F_ss * k))


def _mirror(case: Case, batch: Batch) -> Batch:
    """The same pairs with a lobe that reflects everything."""
    return batch.altered(thinfilm_thickness=0.0, **case.of(FilmSpec).row.mirror)
