# SPDX-License-Identifier: Apache-2.0
"""Probes of a renderer's closures: those of a host that evaluates, of pairs that a renderer shows."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.diffuse import DiffuseLobe
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.probes.cases import BLACK, WHITE
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import (
    LOBE_RIM,
    RIM,
    SEED,
    Array,
    Batch,
    Counts,
    Values,
    directions,
    random_inputs,
)
from mxeon.conformance.samples.edge_cases import LEAST_TURNED
from mxeon.hosts.base import Host
from mxeon.hosts.pairs import LEAST_SINE, perpendicular, visible
from mxeon.models.nodes.bsdl import BSDL_VARIANTS
from mxeon.models.nodes.cycles import CYCLES_VARIANTS
from mxeon.models.nodes.node import Scattering, Variant
from mxeon.models.table import model

P = TypeVar("P", bound=Probe)
SMOOTH = ("eon", "qon", "burley")  # models whose roughness sharpens no lobe
OBLIQUE = (
    0.25  # sine times cosine of a view whose mirror direction is far from it and from its opposite
)
FARTHER = 1.001 * LEAST_SINE  # beyond roundings
NO_SINE = 1e-6  # of directions that are the same up to the roundings of float32
USUAL = Counts(1 << 12, 1 << 10, 1 << 9, albedos=8, materials=16, nodes=32, mirrored=1 << 10)


class RenderedSamples(Probe):
    """What a probe of closures has in common: pairs that a renderer shows, and inputs that it takes.

    Both cosines are at least RIM, and no lobe is so sharp that the place of a pixel counts. A roughness is at
    most 1, as OSL's stdosl.h has it, a weight is not negative, and there is no occlusion.
    """

    word: ClassVar[str] = "rendered"  # of its kinds
    # Functions of the renderer, by the name of a node's row.
    variants: ClassVar[Mapping[str, tuple[Variant[Scattering], ...]]] = BSDL_VARIANTS

    def __init__(
        self, host: Host, subject: Subject, library: str, counts: Counts | None = None
    ) -> None:
        super().__init__(host, _with_variants(subject, self.variants), library, counts)

    @classmethod
    def kind_of(cls, subject: Subject) -> str:
        return kinds.rendered_kind(super().kind_of(subject), cls.word)

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Those of any node, without those of which no pair is shown."""
        shown = (self._plain(batch.where(_is_shown(batch))) for batch in super().batches)
        return tuple(batch for batch in shown if len(batch.wo))

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """Few views of the random pairs: each has its share of the paths."""
        return (super().cosines[0].first(self.counts.albedos),)

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
        """Materials at the nodes of a quadrature, and views of which the nodes next to them are smooth."""
        batch, weights = super().integrated
        nodes = weights.shape[1]
        height = batch.wo[::nodes, 2]
        oblique = height * np.sqrt(1.0 - height * height) >= OBLIQUE
        return batch.where(np.repeat(oblique, nodes)), weights[oblique]

    def direct(self, batch: Batch) -> Array:
        """Values, where need be of a pair that is shown in place of one next to it."""
        return super().direct(replace(batch, wi=apart(batch.wo, batch.wi)))

    def _integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        return self._taken(super()._integrable(inputs))  # type: ignore[misc]  # of the class beside it

    def _plain(self, batch: Batch) -> Batch:
        """A batch with inputs that a renderer takes."""
        return replace(batch, inputs=self._taken(batch.inputs))

    def _taken(self, inputs: Mapping[str, Array]) -> dict[str, Array]:
        taken = {**inputs}
        taken.pop("occlusion", None)
        if "weight" in taken:
            taken["weight"] = np.maximum(taken["weight"], 0.0)
        least = 0.0 if self.subject.model in SMOOTH else LEAST_TURNED
        rough = [name for name in taken if name.endswith("roughness")]
        return taken | {name: np.clip(taken[name], least, 1.0) for name in rough}


class TracedSamples(RenderedSamples):
    """The same, of pairs that Cycles shows."""

    word = kinds.TRACED
    variants = CYCLES_VARIANTS


def rendered_of(probe: type[P], samples: type[RenderedSamples] = RenderedSamples) -> type[P]:
    """The class of the same probes on a host that evaluates a renderer's closures."""
    name = f"{samples.word.capitalize()}{probe.__name__}"
    return cast(type[P], type(name, (samples, probe), {"usual": USUAL}))


class RenderedLobeProbe(RenderedSamples, PairProbe):
    """The diffuse lobe of a surface shader, told apart from what lies over it.

    See `mxeon.conformance.probes.pictures.DiffuseLobeProbe`.
    """

    usual = USUAL

    subject: DiffuseLobe  # type: ignore[assignment]  # with inputs drawn here

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs far from the rim, with colors and roughnesses."""
        rng, count = np.random.default_rng(SEED), self.counts.few
        inputs = self._taken(random_inputs(rng, count, model(self.subject.model)))
        batch = Batch(directions(rng, count), directions(rng, count), inputs)
        return (batch.where(_is_shown(batch, LOBE_RIM)),)

    @property
    def few(self) -> tuple[Batch, ...]:
        return self.batches

    def direct(self, batch: Batch) -> Array:
        others = self._lit(batch.altered(color=BLACK))
        lambert = self._lit(batch.altered(color=WHITE, roughness=0.0)) - others
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # a shader that stays black has no value
            values: Array = (self._lit(batch) - others) / lambert * batch.wi[:, 2:]
        return values

    def _lit(self, batch: Batch) -> Array:  # type: ignore[override]
        ports = {"color": self.subject.color, "roughness": self.subject.roughness}
        inputs: Values = {port: batch.inputs[name] for name, port in ports.items() if port}
        shader = self._shader
        return self.host.evaluate(shader, batch.wo, batch.wi, inputs, "direct").astype(np.float64)


def apart(wo: Array, wi: Array) -> Array:
    """Lights turned away from the view, or from its opposite, until a renderer shows the pair."""
    # The direction across the view in which a light lies, or any where it has none.
    cosine = (wo * wi).sum(axis=1, keepdims=True)
    across = wi - cosine * wo
    sine = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(sine > NO_SINE, across, perpendicular(wo))
    along = np.sign(cosine) * np.sqrt(1.0 - FARTHER**2)
    moved = along * wo + FARTHER * across / np.linalg.norm(across, axis=1, keepdims=True)
    moved = moved / np.linalg.norm(moved, axis=1, keepdims=True)  # wo is one up to its roundings
    return np.where(visible(wo, wi)[:, np.newaxis], wi, moved)


def _with_variants(
    subject: Subject, known: Mapping[str, tuple[Variant[Scattering], ...]]
) -> Subject:
    """A subject with the functions of a renderer among those that may explain its values."""
    if not isinstance(subject, BsdfSubject) or subject.row.name not in known:
        return subject
    variants = (*known[subject.row.name], *subject.row.variants)
    return replace(subject, row=replace(subject.row, variants=variants))


def _is_shown(batch: Batch, rim: float = RIM) -> NDArray[np.bool_]:
    """Which pairs of a batch a renderer shows."""
    least = np.minimum(batch.wo[:, 2], np.abs(batch.wi[:, 2]))
    return np.asarray(visible(batch.wo, batch.wi) & (least >= rim))
