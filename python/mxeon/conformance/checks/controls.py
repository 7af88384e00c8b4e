# SPDX-License-Identifier: Apache-2.0
"""Negative controls: the probe of a check made wrong on purpose, on which the check has to fail."""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Batch

Array = NDArray[np.float64]
Control = Callable[[Probe], Probe]


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


def with_inputs(**inputs: ArrayLike) -> Control:
    """A control that passes these inputs to the host in place of the batch's."""
    return lambda probe: Altered(probe, batch=lambda batch: batch.altered(**inputs))


def gray(probe: Probe) -> Altered:
    """A control that loses the color: every channel gets the mean of the three."""

    def mean_color(batch: Batch) -> Batch:
        colors = {
            name: np.repeat(np.mean(values, axis=-1, keepdims=True), 3, axis=-1)
            for name, values in batch.inputs.items()
            if name != "normal" and np.shape(values)[-1:] == (3,)
        }
        return batch.altered(**colors)

    return Altered(probe, batch=mean_color)


def take_response(probe: Probe) -> Altered:
    """A control that takes the response for another output."""
    return Altered(probe, throughputs=lambda batch, values: probe.direct(batch))


def pass_all(probe: Probe) -> Altered:
    """A control whose throughput is 1."""
    return Altered(probe, throughputs=lambda batch, values: np.ones_like(values))


def scale(factor: float) -> Control:
    """A control whose values are multiplied by a factor."""
    return lambda probe: Altered(probe, values=lambda batch, values: factor * values)


def offset(probe: Probe) -> Altered:
    """A control to whose values a thousandth is added."""
    return Altered(probe, values=lambda batch, values: values + 1e-3)


def no_number(probe: Probe) -> Altered:
    """A control whose first value is not a number."""
    return Altered(
        probe,
        values=lambda batch, values: np.where(np.arange(len(values))[:, None], values, np.nan),
    )


def rougher(probe: Probe) -> Altered:
    """A control whose roughness is a tenth larger."""
    return Altered(
        probe,
        batch=lambda batch: batch.altered(
            roughness=np.minimum(1.1 * np.asarray(batch.inputs["roughness"]), 1.0)
        ),
    )


def isotropic(probe: Probe) -> Altered:
    """A control whose roughness is the same in both directions."""
    return Altered(
        probe,
        batch=lambda batch: batch.altered(
            roughness=np.repeat(np.asarray(batch.inputs["roughness"])[:, :1], 2, axis=1)
        ),
    )


def shifted(probe: Probe) -> Altered:
    """A control in which each pair has the inputs of another."""

    def batch(batch: Batch) -> Batch:
        inputs = {name: np.roll(values, 1, axis=0) for name, values in batch.inputs.items()}
        return batch.altered(**inputs)

    return Altered(probe, batch=batch)


def drop_changes(probe: Probe) -> Altered:
    """A control that drops every change of inputs: the host sees the first batch only."""
    return Altered(probe, batch=lambda batch: probe.few[0])


def scale_cosine(power: int) -> Control:
    """A control whose values carry a power of cos(theta_o) too many."""

    def values(batch: Batch, values: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            scaled: Array = values * batch.wo[:, 2:] ** power
        return scaled

    return lambda probe: Altered(probe, values=values)
