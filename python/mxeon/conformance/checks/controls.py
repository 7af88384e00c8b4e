# SPDX-License-Identifier: Apache-2.0
"""Negative controls: a probe made wrong on purpose, on which its check has to fail."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.shaders.nodes import FLAG


@dataclass(frozen=True)
class Mistake:
    """What a control does wrong.

    Attributes
    ----------
    words : str
        For a reader.
    make : callable (probe) -> probe
        The probe with the mistake.
    """

    words: str
    make: Callable[[Probe], Probe]


def mistake(words: str) -> Callable[[Callable[[Probe], Probe]], Mistake]:
    """Decorator of a function that makes a probe wrong."""
    return lambda make: Mistake(words, make)


class Altered(Probe):
    """A probe made wrong: its batches changed on the way in, its values on the way out.

    Responses and throughputs are values of their own. What a control does not change is the probe's.

    Parameters
    ----------
    probe : Probe
    batch : callable (batch) -> batch
    values, throughputs : callable (batch, values) -> values
    """

    def __init__(
        self,
        probe: Probe,
        batch: Callable[[Batch], Batch] = lambda batch: batch,
        values: Callable[[Batch, Array], Array] = lambda batch, values: values,
        throughputs: Callable[[Batch, Array], Array] = lambda batch, values: values,
    ) -> None:
        super().__init__(probe.host, probe.subject, probe.library, probe.counts)
        self.probe, self.batch, self.values, self.throughputs = probe, batch, values, throughputs

    def __getattribute__(self, name: str) -> object:
        """Members of the probe in place of those of the base class, which raise."""
        own = any(name in vars(kind) for kind in type(self).__mro__ if kind is not Probe)
        if name.startswith("_") or own or name not in vars(Probe):
            return object.__getattribute__(self, name)
        return getattr(self.probe, name)

    @property
    def batches(self) -> tuple[Batch, ...]:
        """The few: a control has nothing to prove on all pairs."""
        return self.probe.few

    @property
    def cosines(self) -> tuple[Batch, ...]:
        """The first: pictures of an environment take long on some hosts."""
        return self.probe.cosines[:1]

    @cached_property
    def albedos(self) -> tuple[Array, ...]:
        """Those of the first."""
        return self.probe.albedos[:1]

    def direct(self, batch: Batch) -> Array:
        """Values of the changed batch, changed."""
        return self.values(batch, self.probe.direct(self.batch(batch)))

    def albedo(self, batch: Batch, irradiance: NDArray[np.float32] | None = None) -> Array:
        """Albedos of the changed batch, changed."""
        return self.values(batch, self.probe.albedo(self.batch(batch), irradiance))

    def transmitted(self, batch: Batch, radiance: NDArray[np.float32] | None = None) -> Array:
        """Light through the surface of the changed batch, changed."""
        return self.values(batch, self.probe.transmitted(self.batch(batch), radiance))

    def throughput(self, batch: Batch, branch: str) -> Array:
        """Throughputs of the changed batch, changed."""
        return self.throughputs(batch, self.probe.throughput(self.batch(batch), branch))

    def density(self, batch: Batch) -> Array:
        """Densities for the changed batch."""
        return self.probe.density(self.batch(batch))


def with_inputs(words: str, **inputs: ArrayLike) -> Mistake:
    """The host gets these inputs in place of the batch's."""
    return Mistake(words, lambda probe: Altered(probe, lambda batch: batch.altered(**inputs)))


@mistake("the mode returns the values of the other mode")
def take_other_mode(probe: Probe) -> Altered:
    """Values of the other mode: not by its flag, which a host may ignore."""
    own, other = ("eon", "qon") if probe.subject.model == "eon" else ("qon", "eon")

    def values(batch: Batch, values: Array) -> Array:
        if batch.inputs[FLAG] != (own == "eon"):
            return values
        return values + batch.expected(other) - batch.expected(own)

    return Altered(probe, values=values)


@mistake("every channel gets the mean color")
def gray(probe: Probe) -> Altered:
    def mean_color(batch: Batch) -> Batch:
        colors = {
            name: np.repeat(np.mean(values, axis=-1, keepdims=True), 3, axis=-1)
            for name, values in batch.inputs.items()
            if name != "normal" and np.shape(values)[-1:] == (3,)
        }
        return batch.altered(**colors)

    return Altered(probe, batch=mean_color)


@mistake("the response is returned as the throughput")
def take_response(probe: Probe) -> Altered:
    return Altered(probe, throughputs=lambda batch, values: probe.direct(batch))


@mistake("all light passes")
def pass_all(probe: Probe) -> Altered:
    return Altered(probe, throughputs=lambda batch, values: np.ones_like(values))


def scale(words: str, factor: float) -> Mistake:
    """Values are multiplied by a factor."""
    return Mistake(words, lambda probe: Altered(probe, values=lambda _, values: factor * values))


@mistake("0.001 is added to every value")
def offset(probe: Probe) -> Altered:
    return Altered(probe, values=lambda batch, values: values + 1e-3)


@mistake("one output is not a number")
def no_number(probe: Probe) -> Altered:
    return Altered(
        probe,
        values=lambda batch, values: np.where(np.arange(len(values))[:, None], values, np.nan),
    )


@mistake("the roughness is 10 % larger")
def rougher(probe: Probe) -> Altered:
    return Altered(
        probe,
        batch=lambda batch: batch.altered(
            roughness=np.minimum(1.1 * np.asarray(batch.inputs["roughness"]), 1.0)
        ),
    )


@mistake("the roughness is the same in both directions")
def isotropic(probe: Probe) -> Altered:
    return Altered(
        probe,
        batch=lambda batch: batch.altered(
            roughness=np.repeat(np.asarray(batch.inputs["roughness"])[:, :1], 2, axis=1)
        ),
    )


@mistake("each row uses the inputs of another row")
def shifted(probe: Probe) -> Altered:
    def batch(batch: Batch) -> Batch:
        inputs = {name: np.roll(values, 1, axis=0) for name, values in batch.inputs.items()}
        return batch.altered(**inputs)

    return Altered(probe, batch=batch)


@mistake("every change is dropped")
def drop_changes(probe: Probe) -> Altered:
    return Altered(probe, batch=lambda batch: probe.few[0])


def scale_cosine(words: str, power: int) -> Mistake:
    """Values carry a power of cos(theta_o) too many."""

    def values(batch: Batch, values: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            scaled: Array = values * batch.wo[:, 2:] ** power
        return scaled

    return Mistake(words, lambda probe: Altered(probe, values=values))
