# SPDX-License-Identifier: Apache-2.0
"""Probes of microfacets under a thin film."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.thin_films import SUMMED, THICK, FilmSum
from mxeon.conformance.probes.bsdf import MicrofacetProbe, simple
from mxeon.conformance.probes.pictures import Mask
from mxeon.conformance.samples.batch import (
    SEED,
    Array,
    Batch,
    Counts,
    FilmViews,
    directions,
    rounded,
)
from mxeon.conformance.samples.edge_cases import special_directions

HARD = {"alpha": (0.08, 0.8), "mu": (0.1, 0.35), "thickness": (200.0, 1000.0)}  # see `cosines`
STEEP = {"alpha": (0.6, 1.0), "mu": (0.6, 1.0), "thickness": (50.0, 100.0)}  # see `FilmViews`
FRINGED = {**STEEP, "thickness": (50.0, 1000.0)}  # see `FilmViews`
GLOSSY = {**STEEP, "alpha": (0.03, 0.1)}  # see `FilmViews`
SHARP = {"alpha": (1e-3, 1e-3), "mu": (0.3, 1.0), "thickness": (200.0, 1000.0)}  # see `FilmViews`
ORDERED = {"alpha": (1e-3, 1e-3), "mu": (0.1, 0.2), "thickness": (40.0, 100.0)}  # see `FilmViews`
# Films whose errors have one mean: tools/fits/thin_film_sets.py bounds it for sets of these sizes.
FEW_FILMS, CURVES = 1 << 6, 1 << 10
LEAST_OIL = 1.2  # index of these films, or there is none to see
LEAST_FILM = 1.25  # where albedos are asked: below, metals of a lower index reflect totally, in finer fringes
LEAST_FACET = 0.1  # cosine with the half vector: next to grazing all orders of a film count


class FilmProbe(MicrofacetProbe):
    """A microfacet node under a thin film on a host that evaluates any pairs."""

    # Each average over a film's curve takes long.
    usual: ClassVar[Counts] = Counts(1 << 8, 1 << 6, diagnosed=1 << 5, albedos=24, materials=16)
    least_cosine: ClassVar[float] = LEAST_FACET

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs and special ones whose facets are not at grazing, and mirrored ones."""
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        special = special_directions(rng)
        picked = rng.permutation(len(special[0]))[:count]
        random = directions(rng, count), directions(rng, count)
        pairs = (
            self._batch(rng, random, self.subject.random_inputs),
            self._batch(rng, (special[0][picked], special[1][picked]), self.subject.special_inputs),
            self.mirrored[0].first(count),
        )
        return tuple(batch.where(_steep(batch)) for batch in pairs)

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        return tuple(batch.first(self.counts.few) for batch in self.batches)

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """Views of the random pairs, and as many where few facets stand for all the least."""
        batch = self.batches[0].where(self.batches[0].wo[:, 2] >= self.least_cosine)
        easy = batch.first(self.counts.albedos)
        easy = replace(easy, inputs=simple(easy.inputs))
        hard = film_views(self.subject, self.counts.albedos, HARD)
        return tuple(
            batch.altered(thinfilm_ior=np.maximum(batch.inputs["thinfilm_ior"], LEAST_FILM))
            for batch in (easy, hard)
        )

    @cached_property
    def films(self) -> FilmViews:
        return FilmViews(
            *(
                film_views(self.subject, count, ranges)
                for count, ranges in (
                    (FEW_FILMS, STEEP),
                    (FEW_FILMS, FRINGED),
                    (FEW_FILMS, GLOSSY),
                    (CURVES, ORDERED),
                    (FEW_FILMS, SHARP),
                )
            )
        )

    def summed(self, first: Batch, second: Batch, output: str) -> Array:
        inputs = {f"{SUMMED[1]}/{name}": value for name, value in second.inputs.items()}
        both = replace(first, inputs={**first.inputs, **inputs})
        values: Array = getattr(self._sum, output)(both)
        return values

    @cached_property
    def _sum(self) -> "FilmProbe":
        return FilmProbe(self.host, FilmSum(self.subject.row), self.library)

    @cached_property
    def edges(self) -> Batch:
        """Pairs and inputs at the edges of the domain, films next to vacuum and vast ones."""
        rng = np.random.default_rng(SEED)
        special = special_directions(rng)
        picked = rng.permutation(len(special[0]))[: 2 * self.counts.pairs]
        wo, wi = (each[picked] for each in special)
        inputs = self.subject.special_inputs(rng, len(wo))
        inputs["thinfilm_thickness"] = rng.choice(THICK, len(wo))
        inputs["thinfilm_ior"][::16] = 0.0
        return Batch(wo, wi, inputs)


def film_views(
    subject: BsdfSubject, count: int, ranges: Mapping[str, tuple[float, float]], seed: int = SEED
) -> Batch:
    """Views of films with a roughness, a cosine and a thickness in ranges, and mirrored lights."""
    rng = np.random.default_rng(seed)
    alpha, mu, thickness = (low + (high - low) * rng.random(count) for low, high in ranges.values())
    azimuth, radius = 2.0 * np.pi * rng.random(count), np.sqrt(1.0 - mu * mu)
    wo = rounded([radius * np.cos(azimuth), radius * np.sin(azimuth), mu])
    inputs = simple(subject.random_inputs(rng, count))
    inputs["thinfilm_ior"] = np.maximum(inputs["thinfilm_ior"], LEAST_OIL)
    inputs["roughness"] = rounded([alpha, alpha])
    inputs["thinfilm_thickness"] = rounded([thickness])[:, 0]
    if "tint" in inputs:
        inputs["tint"] = np.ones((count, 3))
    return Batch(wo, wo * [-1.0, -1.0, 1.0], inputs)


def _steep(batch: Batch) -> Mask:
    """Pairs whose half vector is not at grazing to either."""
    half = batch.wo + batch.wi
    length = np.linalg.norm(half, axis=1)
    cosine = np.abs((half * batch.wo).sum(axis=1)) / np.maximum(length, 1e-12)
    return np.asarray(cosine >= LEAST_FACET)
