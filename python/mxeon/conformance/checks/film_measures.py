# SPDX-License-Identifier: Apache-2.0
"""Measurements and controls of microfacets under a thin film."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.checks.controls import Altered, mistake
from mxeon.conformance.diagnosis.candidates import NEAR, Diagnosis
from mxeon.conformance.diagnosis.comparisons import ALBEDO
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.probes.bsdf import LEAST_INDEX
from mxeon.conformance.probes.cases import WHITE
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.conformance.samples.measurement import Case
from mxeon.models.microfacet.ggx_formulas import smith_lambda

Values = Callable[[Batch], Array]
MIRRORED = (-1.0, -1.0, 1.0)
ROUGHNESSES = (1.0, 0.3)  # with much and with little compensation
SMOOTH = (0.04, 0.005)  # with next to none, for whose average a shader may take fewer cosines
RIGHT = "each value on its own is within tolerance"  # of an explanation that found nothing
FILM_INPUTS = ("thinfilm_thickness", "thinfilm_ior")
LEAST_F = 0.01  # of a curve by which its averages are divided
THIN_LIMIT = 1e-3  # thickness in nm of a film that changes nothing
RARE = 0.5  # index of a film that MaterialX counts as vacuum


def film_limit(probe: Probe) -> Iterable[Case]:
    """Values under a film of index 1, and under one of THIN_LIMIT, against those without.

    A film of an index below that of vacuum counts as one of index 1, whatever that one does. Under a thin
    one the sensitivities count, of five digits, whose sum is not 1: as much as in the equations is right.
    """
    batch = _compared(probe)
    without = batch.altered(thinfilm_thickness=0.0)
    bare = probe.direct(without)
    empty, rare = (probe.direct(batch.altered(thinfilm_ior=index)) for index in (1.0, RARE))
    cases = [Case(batch, empty, bare), Case(batch, rare, empty)]
    if "color0" not in batch.inputs:  # whose curve is taken at another angle under a film
        thin = batch.altered(thinfilm_thickness=THIN_LIMIT)
        sensed = probe.expected(thin) - probe.expected(without)
        cases.append(Case(batch, probe.direct(thin), bare + sensed))
    return cases


def film_curve(probe: Probe) -> Iterable[Case]:
    """A film's curve at one cosine, of which the first orders count alone."""
    return [_curves(probe, probe.films.sharp)]


def film_orders(probe: Probe) -> Iterable[Case]:
    """The same at grazing and of thin films, of which all orders count."""
    return [_curves(probe, probe.films.ordered)]


def _curves(probe: Probe, batch: Batch) -> Case:
    """Curves: values in mirrored lights over those of a mirror.

    The lobes are so smooth that their compensation is 1, whatever average it has.
    """
    (measured, mirror), (expected, white) = (
        (direct(batch), direct(_mirror(probe, batch))) for direct in _sides(probe)
    )
    return Case(batch, measured / mirror, expected / white)


def film_sum(probe: Probe) -> Iterable[Case]:
    """Sums of two lobes in one pixel against both by themselves, of which one thing is another.

    In an environment that is the roughness, by which the visible facets are others.
    """
    batch: Batch = probe.films.steep
    substrate = tuple(name for name in batch.inputs if name not in (*FILM_INPUTS, "roughness"))
    cases = []
    for output, names in (
        ("direct", FILM_INPUTS[:1]),
        ("direct", FILM_INPUTS[1:]),
        ("direct", substrate),
        ("albedo", ("roughness",)),
    ):
        other = batch.altered(**{name: np.roll(batch.inputs[name], 1, axis=0) for name in names})
        first, second = (getattr(probe, output)(each) for each in (batch, other))
        cases.append(Case(batch, probe.summed(batch, other, output), first + second))
    return cases


def film_average(probe: Probe) -> Iterable[Case]:
    """F_ss of a film, from values at two roughnesses, against that of the equations."""
    return [average_case(probe, probe.films.fringed)]


def film_smooth(probe: Probe) -> Iterable[Case]:
    """Values F (1 + F_ss k) of lobes that lose little, against those of lobes that lose less.

    F and k are the host's, and F_ss that of the equations.
    """
    batch: Batch = probe.films.fringed
    F, F_ss = _averages(probe, probe.expected, batch)
    (first, k), (second, other_k) = (
        _parts(probe, probe.direct, batch.altered(roughness=(alpha, alpha))) for alpha in SMOOTH
    )
    expected = second * (1.0 + F_ss * k) / (1.0 + F_ss * other_k)
    bright = F.min(axis=1) > LEAST_F
    return [Case(batch.where(bright), first[bright], expected[bright])]


def average_case(probe: Probe, batch: Batch) -> Case:
    """F_ss of films whose curve is not next to 0, of the host and of the equations."""
    (_, measured), (F, expected) = (_averages(probe, each, batch) for each in _sides(probe))
    bright = F.min(axis=1) > LEAST_F
    return Case(batch.where(bright), measured[bright], expected[bright])


def film_visible(probe: Probe) -> Iterable[Case]:
    """A film's mean over the visible facets, from its albedo, against that of the equations."""
    return _visible_cases(probe, probe.films.steep)


def film_glossy(probe: Probe) -> Iterable[Case]:
    """The same of lobes whose facets are much alike."""
    return _visible_cases(probe, probe.films.glossy)


def _visible_cases(probe: Probe, batch: Batch) -> Iterable[Case]:
    """Means over the visible facets of films whose curve is not next to 0."""
    albedos = (
        lambda each: probe.albedo(each) / probe.albedo(_mirror(probe, each)),
        probe.expected_albedo,
    )
    (_, measured), (F, expected) = (
        _visible(probe, direct, albedo, batch)
        for direct, albedo in zip(_sides(probe), albedos, strict=True)
    )
    bright = F.min(axis=1) > LEAST_F
    return [Case(batch.where(bright), measured[bright], expected[bright])]


def diagnose_average(probe: Probe) -> Diagnosis:
    """Whether F at one cosine stands in the place of its average."""
    batch, measured, expected = average_case(probe, probe.films.fringed)
    direct, model = _sides(probe)
    slanted = replace(batch, wo=view_at(2.0 / 3.0, batch), wi=view_at(2.0 / 3.0, batch) * MIRRORED)
    others = {
        "at the half vector": _averages(probe, direct, batch)[0],
        "at the cosine 2/3": _averages(probe, model, slanted)[0],
    }
    errors = {words: np.sqrt(np.mean((measured - each) ** 2)) for words, each in others.items()}
    words = min(errors, key=errors.__getitem__)
    if not errors[words] < NEAR * np.sqrt(np.mean((measured - expected) ** 2)):
        return Diagnosis("the compensation uses a different average of the film's reflectance")
    text = f"the compensation uses F {words} instead of its average"
    return Diagnosis(text, permitted=words == "at the half vector")


def diagnose_visible(probe: Probe) -> Diagnosis:
    """The explanation of a film's albedo, or the weights of the facets where that is right."""
    explained = ALBEDO.diagnose(probe)
    if RIGHT not in explained.text:
        return explained
    return Diagnosis("the visible facets are not weighted by masking and shadowing")


def view_at(mu: float, batch: Batch) -> Array:
    """Views of one cosine, (N, 3)."""
    return np.broadcast_to([np.sqrt(1.0 - mu * mu), 0.0, mu], batch.wo.shape)


def _sides(probe: Probe) -> tuple[Values, Values]:
    """Values of the host, and of the equations."""
    return probe.direct, probe.expected


def _averages(probe: Probe, direct: Values, batch: Batch) -> tuple[Array, Array]:
    """F at the half vector of mirrored lights, and F_ss, (N, 3) each, from values at two roughnesses.

    A value over that of facets that reflect everything is F (1 + F_ss k), k = (1 - E_ss) / E_ss, in
    which a lobe that reflects everything has F = F_ss = 1.
    """
    (first, k), (second, other_k) = (
        _parts(probe, direct, batch.altered(roughness=(alpha, alpha))) for alpha in ROUGHNESSES
    )
    F = (second * k - first * other_k) / (k - other_k)
    return F, (first - second) / (k - other_k) / np.maximum(F, 0.5 * LEAST_F)


def _parts(probe: Probe, direct: Values, batch: Batch) -> tuple[Array, Array]:
    """F (1 + F_ss k) and k of films in mirrored lights, (N, 3) each."""
    return direct(batch) / _facets(batch), _k(probe, direct, batch)


def _k(probe: Probe, direct: Values, batch: Batch) -> Array:
    """(1 - E_ss) / E_ss in mirrored lights, (N, 3)."""
    return np.asarray(direct(_mirror(probe, batch)) / _facets(batch) - 1.0)


def _facets(batch: Batch) -> Array:
    """Values of facets that reflect everything, in mirrored lights, (N, 1)."""
    alpha, mu = np.broadcast_to(batch.inputs["roughness"], (len(batch.wo), 2))[:, 0], batch.wo[:, 2]
    return np.asarray(0.25 / (alpha * alpha * smith_lambda(mu, alpha))[:, np.newaxis])


def _visible(probe: Probe, direct: Values, albedo: Values, batch: Batch) -> tuple[Array, Array]:
    """F at the half vector, and F_o of an albedo E_ss F_o (1 + F_ss k), (N, 3) each.

    The albedo is that over the one of a mirror, E_ss (1 + k) = 1.
    """
    F, F_ss = _averages(probe, direct, batch)
    k = _k(probe, direct, batch)
    return F, np.asarray(albedo(batch) * (1.0 + k) / (1.0 + F_ss * k))


def _mirror(probe: Probe, batch: Batch) -> Batch:
    """The same pairs with a lobe that reflects everything."""
    return batch.altered(thinfilm_thickness=0.0, **subject_of(probe, BsdfSubject).row.mirror)


@mistake("the film is a quarter thicker")
def thicker(probe: Probe) -> Altered:
    return Altered(
        probe,
        batch=lambda batch: batch.altered(
            thinfilm_thickness=1.25 * np.asarray(batch.inputs["thinfilm_thickness"])
        ),
    )


@mistake("values under a film are 100 times as large")
def brighter(probe: Probe) -> Altered:
    def values(batch: Batch, values: Array) -> Array:
        return values * np.where(np.any(batch.inputs["thinfilm_thickness"]), 100.0, 1.0)

    return Altered(probe, values=values)


def film_energy(probe: Probe) -> Iterable[Case]:
    """Values under a film, where they exceed those of a lobe that reflects all light."""
    cases = []
    for batch in probe.few[::2]:  # a mirror of index 0 is another check where directions are exact
        mirror = batch.altered(thinfilm_thickness=0.0, **subject_of(probe, BsdfSubject).row.mirror)
        most = probe.direct(mirror)
        cases.append(Case(batch, np.maximum(probe.direct(batch), most), most))
    return cases


def _compared(probe: Probe) -> Batch:
    """Random pairs with a film, whose substrate float32 can tell from vacuum.

    Schlick's curve has no dip at 82 degrees: where that is negative, a film's counts as 0.
    """
    batch: Batch = probe.few[0]
    changes: dict[str, ArrayLike] = {"thinfilm_thickness": 300.0}
    if "tint" in batch.inputs:
        changes["ior"] = np.maximum(batch.inputs["ior"], LEAST_INDEX)
    if "color82" in batch.inputs:
        changes["color82"] = WHITE
    return batch.altered(**changes)
