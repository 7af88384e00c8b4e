# SPDX-License-Identifier: Apache-2.0
"""Faults: mistakes of a shader that uses a correct model, such as an ignored weight."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, permutations
from operator import itemgetter

import numpy as np

from mxeon.conformance.results import Cause, Kind
from mxeon.conformance.samples import Array, Batch
from mxeon.models.core.arguments import RANGES

CHANNELS = ("red", "green", "blue")
CONSTANTS = (0.1, 0.25, 0.3, 0.5, 0.75, 1.0)  # possible hard-coded roughnesses


@dataclass(frozen=True)
class Fault:
    """A mistake that changes the batch that a model receives, or the model's results."""

    key: str  # key of `mxeon.conformance.words.FAULTS`
    batch: Callable[[Batch], Batch] = lambda batch: batch
    values: Callable[[Batch, Array], Array] = lambda batch, values: values
    names: tuple[str, ...] = ()  # affected inputs or channels
    numbers: tuple[float, ...] = ()  # numbers in the message, such as a factor

    def cause(self, rms: float) -> Cause:
        return Cause(Kind.FAULT, self.key, self.names, self.numbers, rms=rms)


NO_FAULT = Fault("")


def _input(name: str, change: Callable[[Array], Array]) -> Callable[[Batch], Batch]:
    """A function that changes one input of a batch, if the batch has the input."""

    def changed(batch: Batch) -> Batch:
        if name not in batch.inputs:
            return batch
        return batch.altered(**{name: change(np.asarray(batch.inputs[name], np.float64))})

    return changed


def _scaled(scale: Callable[[Batch], Array]) -> Callable[[Batch, Array], Array]:
    """A function that scales values by a factor per pair, or by 0 if a factor is not finite."""

    def scaled(batch: Batch, values: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = np.reshape(scale(batch), (-1, 1))
        return values * np.where(np.isfinite(factor), factor, 0.0)

    return scaled


def _column(name: str) -> Callable[[Batch], Array]:
    return lambda batch: np.asarray(batch.inputs.get(name, 1.0))


NO_WEIGHT = _input("weight", np.ones_like)
POSITIVE_WEIGHT = _input("weight", lambda weight: np.where(weight > 0.0, 1.0, 0.0))
NO_OCCLUSION = _input("occlusion", np.ones_like)
# fmt: off
COLOR_FAULTS = (
    *(
        Fault("channels_exchanged", _input("color", itemgetter((..., list(order)))),
              names=tuple(CHANNELS[channel] for channel in order))
        for order in permutations(range(3))
    ),
    *(
        Fault("one_channel", _input("color", itemgetter((..., [channel] * 3))), names=(name,))
        for channel, name in enumerate(CHANNELS)
    ),
    Fault("mean_color", _input("color", lambda color: color.mean(axis=-1, keepdims=True) * np.ones(3))),
    Fault("color_ignored", _input("color", partial(np.full_like, fill_value=0.18)), numbers=(0.18,)),
    Fault("color_clamped", _input("color", lambda color: np.minimum(color, 1.0))),
    Fault("color_squared", _input("color", np.square)),
    Fault("color_square_root", _input("color", np.sqrt)),
)
INPUT_FAULTS = (
    Fault("weight_ignored", NO_WEIGHT),
    Fault("occlusion_and_weight_ignored", lambda batch: NO_WEIGHT(NO_OCCLUSION(batch))),
    Fault("weight_ignored_above_0", POSITIVE_WEIGHT),
    Fault("occlusion_and_weight_ignored_above_0", lambda batch: POSITIVE_WEIGHT(NO_OCCLUSION(batch))),
    Fault("weight_twice", values=_scaled(_column("weight"))),
    *COLOR_FAULTS,
    Fault("roughness_squared", _input("roughness", np.square)),
    Fault("roughness_square_root", _input("roughness", np.sqrt)),
    Fault("tangents_exchanged",
          _input("roughness", lambda alpha: alpha[:, ::-1] if alpha.ndim > 1 else alpha)),
    Fault("roughness_halved", _input("roughness", lambda roughness: 0.5 * roughness)),
    *(
        Fault("roughness_ignored", _input("roughness", partial(np.full_like, fill_value=each)), numbers=(each,))
        for each in CONSTANTS
    ),
)
DIRECT_FAULTS = (
    *INPUT_FAULTS,
    Fault("occlusion_ignored", NO_OCCLUSION),
    Fault("occlusion_twice", values=_scaled(_column("occlusion"))),
    Fault("cosine_missing", values=_scaled(lambda batch: 1.0 / batch.wi[:, 2])),
    Fault("cosine_twice", values=_scaled(lambda batch: batch.wi[:, 2])),
    Fault("directions_swapped", values=_scaled(lambda batch: batch.wo[:, 2] / batch.wi[:, 2])),
    Fault("light_mirrored", lambda batch: replace(batch, wi=batch.wi * [-1.0, -1.0, 1.0])),
    Fault("light_from_below",
          lambda batch: replace(batch, wi=np.where([False, False, True], abs(batch.wi), batch.wi))),
)
ENVIRONMENT_FAULTS = (
    *INPUT_FAULTS,
    Fault("occlusion_by_caller", values=_scaled(_column("occlusion"))),
    Fault("normal_incidence",
          lambda batch: replace(batch, wo=np.broadcast_to([0.0, 0.0, 1.0], batch.wo.shape))),
)
# fmt: on


def exchanges(names: Iterable[str]) -> Iterator[Fault]:
    """Faults that exchange two inputs, or all inputs of two nodes (like `top` in `top/weight`)."""
    for pair in combinations(dict.fromkeys(name.split("/")[0] for name in names), 2):
        yield Fault("inputs_exchanged", partial(_exchanged, *pair), names=pair)


def _exchanged(one: str, other: str, batch: Batch) -> Batch:
    changes, inputs = {}, batch.inputs
    for name in inputs:
        first, *port = name.split("/")
        source = "/".join([{one: other, other: one}.get(first, first), *port])
        if source in inputs and np.shape(inputs[source]) == np.shape(inputs[name]):
            low, high, _ = RANGES.get(name.split("/")[-1], (-np.inf, np.inf, ""))
            changes[name] = np.clip(inputs[source], low, high)
    return batch.altered(**changes)


def scaled_by(factor: float) -> Fault:
    for key, known in (("pi_missing", np.pi), ("pi_twice", 1.0 / np.pi)):
        if np.isclose(factor, known, rtol=1e-5):
            return Fault(key, values=lambda batch, values: factor * values)
    return Fault("scaled", values=lambda batch, values: factor * values, numbers=(factor,))


def normal_ignored(batch: Batch) -> Batch:
    """The batch as if every surface had the normal +z or -z, whichever faces the viewer."""
    wo, wi = batch.world(batch.wo), batch.world(batch.wi)
    side = np.where(wo[:, 2:] < 0.0, -1.0, 1.0)
    return replace(batch, wo=wo * side, wi=wi * side, frame=None)
