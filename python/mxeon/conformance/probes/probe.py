# SPDX-License-Identifier: Apache-2.0
"""A probe: a node on a host, and what a check may ask of it; the base class of all."""

from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar, NoReturn, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance.nodes.subject import LobeSubject, Subject, ValuedSubject
from mxeon.conformance.probes.memory import albedo_of, expected_of, remembered
from mxeon.conformance.results import Claims
from mxeon.conformance.samples.batch import (
    Array,
    Batch,
    Candidate,
    Changes,
    Counts,
    FilmViews,
    Values,
)
from mxeon.hosts.base import Host


class Probe:
    """A subject on a host: samples of its inputs, the host's values, and the ones expected.

    A check asks for samples, for the values of a batch of them, and for the expected ones. What a
    kind of probe lacks raises one error, here; the tolerances of a check name the kinds that have
    all that it asks for.
    """

    # Kind of all probes of a class whose host does not show all that a subject's kind stands for.
    shown: ClassVar[str] = ""
    usual: ClassVar[Counts] = Counts()  # samples of a probe that is not told how many to draw

    subject: Subject

    def __init__(
        self, host: Host, subject: Subject, library: str, counts: Counts | None = None
    ) -> None:
        self.host, self.subject, self.library = host, subject, library
        self.counts = counts or self.usual

    @classmethod
    def kind_of(cls, subject: Subject) -> str:
        """Kind of the probe of a subject, by which checks have tolerances."""
        return cls.shown or subject.kind

    @property
    def kind(self) -> str:
        return self.kind_of(self.subject)

    def of(self, subject: Subject) -> Self:
        return type(self)(self.host, subject, self.library, self.counts)

    @property
    def reflection(self) -> "Probe":
        """The probe of the node where it only reflects."""
        self._lacks("reflection")

    def other(self, output: str) -> "Probe":
        self._lacks("other")

    # Samples.

    @property
    def batches(self) -> tuple[Batch, ...]:
        """All pairs that are judged, random and special ones."""
        self._lacks("batches")

    @property
    def few(self) -> tuple[Batch, ...]:
        """Some of them, for what takes long and for controls; unless overridden all of them."""
        return self.batches

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """Views whose albedo is asked."""
        self._lacks("cosines")

    @property
    def edges(self) -> Batch:
        """Pairs and inputs at the edges of the domain."""
        self._lacks("edges")

    @property
    def turned(self) -> Batch:
        """Pairs in frames of their own."""
        self._lacks("turned")

    @property
    def mirrored(self) -> tuple[Batch, Batch]:
        """Two lights near the mirror direction of each view."""
        self._lacks("mirrored")

    @property
    def integrated(self) -> tuple[Batch, Array]:
        """Materials at the nodes of a quadrature, and the weights of their values."""
        self._lacks("integrated")

    @property
    def stretched(self) -> tuple[Batch, Array]:
        """Views of anisotropic materials, and the integrals of their values by the equations."""
        self._lacks("stretched")

    @property
    def films(self) -> FilmViews:
        self._lacks("films")

    def summed(self, first: Batch, second: Batch, output: str) -> Array:
        """`direct` or `albedo` of two lobes with the inputs of two batches of the same pairs."""
        self._lacks("summed")

    @property
    def spheres(self) -> tuple[Batch, ...]:
        """Points of a sphere under each light, for some materials."""
        self._lacks("spheres")

    @property
    def backs(self) -> Batch:
        self._lacks("backs")

    @property
    def materials(self) -> Batch:
        """Views of materials in which every lobe takes part."""
        self._lacks("materials")

    @property
    def white(self) -> Batch:
        """Views of a material that loses no light."""
        self._lacks("white")

    @property
    def changed(self) -> Batch:
        """A few views for each input: of a material with every lobe, then with a change of it."""
        self._lacks("changed")

    @property
    def unset(self) -> tuple[str, ...]:
        """Inputs that its host cannot set."""
        return ()

    def region(self, key: str) -> Batch:
        """Pairs of a part of the domain that a check asks for apart."""
        self._lacks("region")

    # Values of the host.

    def direct(self, batch: Batch) -> Array:
        """Values in direct light, (N, 3): pi f cos(theta_i), a radiance, or an output."""
        self._lacks("direct")

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """Values of the environment branch, (N, 3); the environment is uniform unless given."""
        self._lacks("albedo")

    def throughput(self, batch: Batch, branch: str) -> Array:
        """The share of the light from below that passes the node, in a branch, (N, 3)."""
        self._lacks("throughput")

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        """Light of an environment through the surface, (N, 3); it is uniform unless given."""
        self._lacks("transmitted")

    def response(self, batch: Batch, branch: str) -> Array:
        """Values in any branch, (N, 3)."""
        self._lacks("response")

    @property
    def through(self) -> Array:
        """Light that comes through the media of the batch, over that without them, (N, 3)."""
        self._lacks("through")

    def missing(self, text: str) -> bool:
        """Whether the target has no implementation of a node of a document."""
        self._lacks("missing")

    def density(self, batch: Batch) -> Array:
        """Density in solid angle of the directions that the renderer draws, (N,)."""
        self._lacks("density")

    def sample(self, batch: Batch, u: Array) -> Array:
        """Directions that the renderer draws, (N, 3)."""
        self._lacks("sample")

    # Values that are expected.

    def condition(self, batch: Batch) -> Array:
        """What errors of values are divided by, (N, 3) or one number: 1 where little rounds."""
        return np.ones((1, 1))

    def expected(self, batch: Batch) -> Array:
        """Values that a right shader has in direct light, (N, 3)."""
        self._lacks("expected")

    def expected_albedo(self, batch: Batch) -> Array:
        """Directional albedos that a right shader has, (N, 3)."""
        self._lacks("expected_albedo")

    def expected_sky(self, batch: Batch) -> Array:
        """Mean of the uneven sky that a right shader scatters, (N, 3)."""
        self._lacks("expected_sky")

    @cached_property
    def albedos(self) -> tuple[Array, ...]:
        """Directional albedos that a right shader has at `cosines`."""
        return tuple(map(self.expected_albedo, self.cosines))

    @property
    def integrals(self) -> Array:
        """Integrals of the values of the integrated materials, by the equations, (N, 3)."""
        self._lacks("integrals")

    @property
    def changes(self) -> Mapping[str, Changes]:
        """For each input: inputs without and with a change of it alone, which must be seen."""
        self._lacks("changes")

    @property
    def black(self) -> Values:
        """Inputs with which the subject scatters nothing."""
        self._lacks("black")

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        """Functions that may explain the values, the subject's own model first."""
        self._lacks("value_candidates")

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        """Functions that may explain the albedos, the subject's own model first."""
        self._lacks("albedo_candidates")

    @property
    def claims(self) -> Claims:
        """What a result says of a renderer's own node beside its verdict."""
        return {}

    def _lacks(self, name: str) -> NoReturn:
        raise NotImplementedError(f"{type(self).__name__} has no {name}")


class ValueProbe(Probe):
    """A probe whose expected values are its subject's."""

    subject: ValuedSubject

    def expected(self, batch: Batch) -> Array:
        return expected_of(self.subject)(batch)

    @property
    def changes(self) -> Mapping[str, Changes]:
        return self.subject.changes

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        return self.subject.value_candidates


class LobeProbe(ValueProbe):
    """A probe of a node that scatters light."""

    subject: LobeSubject

    def expected_albedo(self, batch: Batch) -> Array:
        return albedo_of(self.subject)(batch)

    def expected_sky(self, batch: Batch) -> Array:
        return self.subject.sky(batch)

    @property
    def black(self) -> Values:
        return self.subject.black

    @cached_property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        return tuple(map(remembered, self.subject.albedo_candidates))


S = TypeVar("S", bound=Subject)


def subject_of(probe: Probe, family: type[S]) -> S:
    """The subject of a probe that a check asks of one family alone."""
    subject = probe.subject
    assert isinstance(subject, family), f"{subject.title} is no {family.__name__}"
    return subject
