# SPDX-License-Identifier: Apache-2.0
"""The microfacet nodes under a thin film."""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar, NamedTuple

import numpy as np

from mxeon.conformance.engine import COUNT, WAVE, beside_rounding
from mxeon.conformance.samples import (
    SEED,
    Array,
    Batch,
    Counts,
    directions,
    float32,
    rounded,
    special_directions,
)
from mxeon.conformance.spec import Input
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.microfacets import (
    ESS_FIT,
    FRAME,
    INPUTS,
    SEEN_ESS,
    FacetSpec,
    simple,
)
from mxeon.conformance.specs.microfacets import VALUE as FACET_VALUE
from mxeon.conformance.tolerance import (
    Term,
    Tolerance,
    absolute,
    given,
    root_mean_square,
    roundings,
    sum_of,
)
from mxeon.hosts.base import Host
from mxeon.models.nodes.microfacets import FILM_NODES

# Largest errors of the shader's thin film, for cosines from 0.1 on and up to 1000 nm: tools/fits/thin_film.py
# searches for each.
FILM_SEEN = (
    7.8e-2  # mean over the visible facets in three cosines and F_ss in three, times the light lost
)
FILM_OILED = 6e-2  # the same of films of index 1.25 or more
FILM_WAVES = 2.0  # slope of curves of films from 200 nm in the cosines and sines of their phases
FILM_PHASE = 71.0  # largest phase of a first order, in radian: 1000 nm of index 2.5
CURVE_ROUNDINGS = (
    10 * 9.5 + 16
)  # ten in a phase, times the slope of a curve in its logarithm, and 16

FILM_ALBEDO = sum_of(
    Term(FILM_OILED, "the mean over visible facets and F_ss, in three cosines each"),
    Term(ESS_FIT, "the fit of E_ss"),
    unit="albedo",
    metric=absolute,
)
# A metal of a lower index reflects totally below such a film, in fringes that few cosines do not see.
FILM_TRAPPED = given(FILM_SEEN - FILM_OILED, "albedo", "films of a lower index than 1.25")


def _mean(value: float, words: str) -> Tolerance:
    """The largest error of 64 sets of 64 films, by tools/fits/thin_film_sets.py."""
    return given(value, "reflectance, rms", words, root_mean_square)


ERRORS = {
    # Few films come near to it: thin metals at grazing have the first, indices far apart the second.
    "value": sum_of(
        Term(ESS_FIT * SEEN_ESS, "the fit of E_ss, times 1.58 at most"),
        Term(3.5e-2 * (SEEN_ESS - 1.0), "F_ss in three cosines, times 0.58"),
        Term(8e-4, "orders that are not summed"),
    ),
    "albedo": FILM_ALBEDO,
    "throughput": FILM_ALBEDO,
    "film_curve": sum_of(
        Term(2.4e-6, "orders that are not summed, from 200 nm and a cosine of 0.3 on"),
        Term(0.65 * 2.8e-5, "the fit of E_ss at alpha 1e-3, times F (1 - F_ss)"),
        roundings(CURVE_ROUNDINGS, "of phases, times the slope 9.5, and 16"),
        unit="reflectance",
        metric=absolute,
    ),
    "film_orders": sum_of(
        Term(8.7e-7, "orders that are not summed, rms over 1024 films of 40 to 100 nm"),
        Term(1.5e-4, "the fit of E_ss at alpha 1e-3 and cosines of 0.1 to 0.2"),
        unit="reflectance, rms",
        metric=root_mean_square,
    ),
    # F_ss under a film that changes nothing, against the fit of it without one.
    "film_limit": sum_of(Term(4.4e-3 * (SEEN_ESS - 1.0), "F_ss in three cosines, times 0.58")),
    # Of the compensation a mirror has another share than a film.
    "film_energy": FACET_VALUE,
    "film_average": _mean(7e-3, "F_ss in three cosines of films of 50 to 1000 nm"),
    "film_smooth": _mean(1e-5, "F_ss in three cosines, times what a lobe of alpha 0.04 loses"),
    "film_visible": _mean(1.9e-3, "visible facets in three cosines, films of 50 to 100 nm"),
    "film_glossy": _mean(1.1e-3, "visible facets in three cosines, alpha 0.03 to 0.1"),
    "frame": sum_of(
        *FRAME.terms, roundings(2 * CURVE_ROUNDINGS, "of two values, phases times 9.5")
    ),
}


class Films(NamedTuple):
    """So many lobes under films, in mirrored lights, with a roughness, a cosine and a thickness in ranges."""

    size: int
    alpha: tuple[float, float]
    mu: tuple[float, float]
    thickness: tuple[float, float]  # nm


# tools/fits/thin_film_sets.py bounds the mean errors of sets of these sizes.
# Rough lobes under films of few fringes, where masking takes facets of another curve.
STEEP = Films(1 << 6, (0.6, 1.0), (0.6, 1.0), (50.0, 100.0))
FRINGED = STEEP._replace(thickness=(50.0, 1000.0))  # the same under films of up to many fringes
# Lobes whose visible facets are much alike, so that few cosines stand for them, under few fringes.
GLOSSY = STEEP._replace(alpha=(0.03, 0.1))
# Smooth lobes, whose film's curve is seen at one cosine, under films whose first orders count.
SHARP = Films(1 << 6, (1e-3, 1e-3), (0.3, 1.0), (200.0, 1000.0))
# Smooth lobes at grazing under films so thin that all orders count.
ORDERED = Films(1 << 10, (1e-3, 1e-3), (0.1, 0.2), (40.0, 100.0))
# Each average over a film's curve takes long.
COUNTS = Counts(1 << 8, 1 << 6, diagnosed=1 << 5, albedos=24, materials=16)
LEAST_OIL = 1.2  # index of these films, or there is none to see
LEAST_FILM = 1.25  # where albedos are compared: below, metals of a lower index reflect totally, in finer fringes
LEAST_FACET = 0.1  # cosine with the half vector: next to grazing all orders of a film count
THICK = (0.0, 1.0, 100.0, 1e4)  # thicknesses at the edges of the domain


@dataclass(frozen=True, eq=False, kw_only=True)
class FilmSpec(FacetSpec):
    """A microfacet node under a thin film."""

    counts: Counts = COUNTS

    least_cosine: ClassVar[float] = LEAST_FACET

    @property
    def bounded(self) -> tuple[Input, ...]:
        return tuple(each for each in super().bounded if each.name.startswith("thinfilm"))

    def engine(self, quantity: str, host: Host) -> tuple[Term, ...]:
        if quantity != "film_curve":
            return ()
        return (Term(FILM_WAVES * wave_error(host), "the engine's own cosine and sine, times 2"),)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return _in_air(super().random_inputs(rng, count))

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values of which half lie on an edge; a quarter of the films have the substrate's index."""
        inputs = _in_air(super().special_inputs(rng, count))
        if "tint" in inputs:
            same = rng.random(count) < 0.25
            inputs["thinfilm_ior"] = np.where(same, inputs["ior"], inputs["thinfilm_ior"])
        return inputs

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random pairs and special ones whose facets are not at grazing, and mirrored ones."""
        rng, count = np.random.default_rng(SEED), counts.pairs
        special = special_directions(rng)
        picked = rng.permutation(len(special[0]))[:count]
        random = directions(rng, count), directions(rng, count)
        pairs = (
            self._batch(rng, random, self.random_inputs),
            self._batch(rng, (special[0][picked], special[1][picked]), self.special_inputs),
            self.mirrored(counts)[0].first(count),
        )
        return tuple(batch.where(_steep(batch)) for batch in pairs)

    def few(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        return tuple(batch.first(counts.few) for batch in batches)

    def views(
        self, batches: tuple[Batch, ...], few: tuple[Batch, ...], counts: Counts
    ) -> tuple[Batch, ...]:
        """Views of the random pairs, and as many where few facets stand for all the least."""
        batch = batches[0].where(batches[0].wo[:, 2] >= self.least_cosine)
        easy = batch.first(counts.albedos)
        easy = replace(easy, inputs=simple(easy.inputs))
        hard = Films(counts.albedos, (0.08, 0.8), (0.1, 0.35), (200.0, 1000.0))
        return tuple(
            batch.altered(thinfilm_ior=np.maximum(batch.inputs["thinfilm_ior"], LEAST_FILM))
            for batch in (easy, film_views(self, hard))
        )

    def edges(self, counts: Counts) -> Batch:
        """Pairs and inputs at the edges of the domain, films next to vacuum and vast ones."""
        rng = np.random.default_rng(SEED)
        special = special_directions(rng)
        picked = rng.permutation(len(special[0]))[: 2 * counts.pairs]
        wo, wi = (each[picked] for each in special)
        inputs = self.special_inputs(rng, len(wo))
        inputs["thinfilm_thickness"] = rng.choice(THICK, len(wo))
        inputs["thinfilm_ior"][::16] = 0.0
        return Batch(wo, wi, inputs)


def _in_air(inputs: dict[str, Array]) -> dict[str, Array]:
    """Inputs in which a dielectric below 1 counts as 1, a film in air.

    From below 1 on, total reflection gives the curve a kink, which no short average sees.
    """
    return {**inputs, "ior": np.maximum(inputs["ior"], 1.0)} if "tint" in inputs else inputs


@lru_cache(maxsize=8)
def film_views(spec: PbrSpec, films: Films, seed: int = SEED) -> Batch:
    """Views of films in ranges, and mirrored lights."""
    rng, (count, *ranges) = np.random.default_rng(seed), films
    alpha, mu, thickness = (low + (high - low) * rng.random(count) for low, high in ranges)
    azimuth, radius = 2.0 * np.pi * rng.random(count), np.sqrt(1.0 - mu * mu)
    wo = rounded([radius * np.cos(azimuth), radius * np.sin(azimuth), mu])
    inputs = simple(spec.random_inputs(rng, count))
    inputs["thinfilm_ior"] = np.maximum(inputs["thinfilm_ior"], LEAST_OIL)
    inputs["roughness"] = rounded([alpha, alpha])
    inputs["thinfilm_thickness"] = rounded([thickness])[:, 0]
    if "tint" in inputs:
        inputs["tint"] = np.ones((count, 3))
    return Batch(wo, wo * [-1.0, -1.0, 1.0], inputs)


def _steep(batch: Batch) -> np.ndarray:
    """Pairs whose half vector is not at grazing to either."""
    half = batch.wo + batch.wi
    length = np.linalg.norm(half, axis=1)
    cosine = np.abs((half * batch.wo).sum(axis=1)) / np.maximum(length, 1e-12)
    return np.asarray(cosine >= LEAST_FACET)


@lru_cache(maxsize=16)
def wave_error(host: Host) -> float:
    """Error of the engine's own cosine and sine of the phases of a film, beyond two roundings."""
    phases = float32(np.linspace(0.0, FILM_PHASE, COUNT))
    return beside_rounding(WAVE.errors(host, phases), 2.0)


FILM_SPECS = tuple(
    FilmSpec.of(row, INPUTS[row.category], ERRORS, title=f"{row.category}, thin film")
    for row in FILM_NODES
)
