# SPDX-License-Identifier: Apache-2.0
"""Subjects, probes and measurements of microfacets under a thin film."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from mxeon.conformance.checks.batch import SEED, Array, Batch, directions
from mxeon.conformance.checks.bsdf.probes import MicrofacetProbe, simple
from mxeon.conformance.checks.bsdf.subjects import FILM, BsdfSubject
from mxeon.conformance.checks.controls import Altered
from mxeon.conformance.checks.measures import Case, Measurement, Metric, worst_of
from mxeon.conformance.checks.probes import PairProbe
from mxeon.conformance.checks.special import special_directions
from mxeon.models.pbrlib.thin_films import FILM_NODES

PAIRS = 1 << 8  # random ones, and special ones; each average over a film's curve takes long
ALBEDOS = 24
FEW = 1 << 6  # pairs of a control
NEXT_TO_NOTHING = 1e-3  # thickness in nm of a film that changes nothing
THICK, OILS = (0.0, 1.0, 100.0, 1e4), (1.0, 1.5)  # special thicknesses and indices
LEAST_FACET = 0.1  # cosine with the half vector: next to grazing all orders of a film count
LEAST_INDEX = 1.05  # of a substrate whose lobe is compared


@dataclass(frozen=True)
class FilmSubject(BsdfSubject):
    """A microfacet node under a thin film."""

    @property
    def title(self) -> str:
        """Name in reports."""
        return f"{self.row.category}, thin film"

    @property
    def kind(self) -> str:
        """Kind of its probe."""
        return FILM

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random values; a dielectric below 1 counts as 1, a film in air.

        From below 1 on, total reflection gives the curve a kink, which no short average sees.
        """
        inputs = super().random_inputs(rng, count)
        if "tint" in inputs:
            inputs["ior"] = np.maximum(inputs["ior"], 1.0)
        return inputs

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values of which half lie on an edge; of half the films the index is the substrate's."""
        inputs = super().special_inputs(rng, count)
        for name, edges in (("thinfilm_thickness", THICK[:-1]), ("thinfilm_ior", OILS)):
            picked = rng.choice(edges, count)
            inputs[name] = np.where(rng.random(count) < 0.5, picked, inputs[name])
        if "tint" in inputs:
            same = rng.random(count) < 0.25
            inputs["thinfilm_ior"] = np.where(same, inputs["ior"], inputs["thinfilm_ior"])
        return inputs


@dataclass(frozen=True, eq=False)
class FilmProbe(MicrofacetProbe):
    """A microfacet node under a thin film on a host that evaluates any pairs."""

    kind: ClassVar[str] = FILM
    diagnosed: ClassVar[int] = 1 << 5
    least_cosine: ClassVar[float] = LEAST_FACET

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """PAIRS random pairs and special ones whose facets are not at grazing, and mirrored ones."""
        rng = np.random.default_rng(SEED)
        special = special_directions(rng)
        picked = rng.permutation(len(special[0]))[:PAIRS]
        pairs = (
            self._batch(
                rng, (directions(rng, PAIRS), directions(rng, PAIRS)), self.subject.random_inputs
            ),
            self._batch(rng, (special[0][picked], special[1][picked]), self.subject.special_inputs),
            self.mirrored[0].first(PAIRS),
        )
        return tuple(batch.where(_steep(batch)) for batch in pairs)

    @cached_property
    def few(self) -> tuple[Batch, ...]:
        """FEW of each."""
        return tuple(batch.first(FEW) for batch in self.batches)

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """ALBEDOS views of the random pairs."""
        batch = super(MicrofacetProbe, self).cosines[0].first(ALBEDOS)
        return (replace(batch, inputs=simple(batch.inputs)),)

    @cached_property
    def edges(self) -> Batch:
        """Pairs and inputs at the edges of the domain, films next to vacuum and vast ones."""
        rng = np.random.default_rng(SEED)
        special = special_directions(rng)
        picked = rng.permutation(len(special[0]))[: 2 * PAIRS]
        wo, wi = (each[picked] for each in special)
        inputs = self.subject.special_inputs(rng, len(wo))
        inputs["thinfilm_thickness"] = rng.choice(THICK, len(wo))
        inputs["thinfilm_ior"][::16] = 0.0
        return Batch(wo, wi, inputs)


def _steep(batch: Batch) -> Array:
    """Pairs whose half vector is not at grazing to either."""
    half = batch.wo + batch.wi
    length = np.linalg.norm(half, axis=1)
    cosine = np.abs((half * batch.wo).sum(axis=1)) / np.maximum(length, 1e-12)
    return np.asarray(cosine >= LEAST_FACET)


def film_limit(probe: Any, metric: Metric) -> Measurement:
    """Values under a film of index 1, and under one next to nothing, against those without."""
    batch = _compared(probe)
    bare = probe.direct(batch.altered(thinfilm_thickness=0.0))
    cases = [Case(batch, probe.direct(batch.altered(thinfilm_ior=1.0)), bare)]
    if "color0" not in batch.inputs:  # whose curve is taken at another angle under a film
        thin = batch.altered(thinfilm_thickness=NEXT_TO_NOTHING)
        cases.append(Case(batch, probe.direct(thin), bare))
    return worst_of(metric, cases)


def thicker(probe: Any) -> Altered:
    """A control whose film is a quarter thicker."""
    return Altered(
        probe,
        batch=lambda batch: batch.altered(
            thinfilm_thickness=1.25 * np.asarray(batch.inputs["thinfilm_thickness"])
        ),
    )


def brighter(probe: Any) -> Altered:
    """A control whose values under a film are 100 times as large."""

    def values(batch: Batch, values: Array) -> Array:
        return values * np.where(np.any(batch.inputs["thinfilm_thickness"]), 100.0, 1.0)

    return Altered(probe, values=values)


def film_energy(probe: Any, metric: Metric) -> Measurement:
    """Values under a film, where they exceed those of a lobe that reflects all light."""
    cases = []
    for batch in probe.few[::2]:  # a mirror of index 0 is another check where directions are exact
        mirror = batch.altered(thinfilm_thickness=0.0, **probe.subject.row.mirror)
        most = probe.direct(mirror)
        cases.append(Case(batch, np.maximum(probe.direct(batch), most), most))
    return worst_of(metric, cases)


def _compared(probe: Any) -> Batch:
    """Random pairs with a film, whose substrate float32 can tell from vacuum."""
    batch: Batch = probe.few[0]
    changes: dict[str, Any] = {"thinfilm_thickness": 300.0}
    if "tint" in batch.inputs:
        changes["ior"] = np.maximum(batch.inputs["ior"], LEAST_INDEX)
    return batch.altered(**changes)


FILMS = tuple(FilmSubject(row) for row in FILM_NODES)
# The limit of a Schlick substrate is that of the index alone.
FILM_MODELS = tuple(row.name for row in FILM_NODES)
LAYERED = tuple(row.name for row in FILM_NODES if row.layerable)


def film_probe_type(subject: FilmSubject, probe: type[Any]) -> type[Any] | None:
    """Class of a subject's probes on a host that has probes of a class; None if it has none."""
    return FilmProbe if probe is PairProbe else None
