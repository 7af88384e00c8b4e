# SPDX-License-Identifier: Apache-2.0
"""Known faults of the way from a node's inputs to a model, whatever the model, to name them by."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, permutations
from operator import itemgetter

import numpy as np

from mxeon.conformance.samples import Array, Batch

CHANNELS = ("red", "green", "blue")
CONSTANTS = (0.1, 0.25, 0.3, 0.5, 0.75, 1.0)  # roughness that may be wired in


@dataclass(frozen=True)
class Fault:
    """A fault, as it changes what a model gives: its batch on the way in, its values on the way out."""

    text: str
    batch: Callable[[Batch], Batch] = lambda batch: batch
    values: Callable[[Batch, Array], Array] = lambda batch, values: values


def _input(name: str, change: Callable[[Array], Array]) -> Callable[[Batch], Batch]:
    """A change of an input, where the batch has it."""

    def batch(batch: Batch) -> Batch:
        if name not in batch.inputs:
            return batch
        return batch.altered(**{name: change(np.asarray(batch.inputs[name], np.float64))})

    return batch


def _scaled(scale: Callable[[Batch], Array]) -> Callable[[Batch, Array], Array]:
    """A change of values by a factor for each pair; 0 where the factor has no value."""

    def values(batch: Batch, values: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = np.reshape(scale(batch), (-1, 1))
        return values * np.where(np.isfinite(factor), factor, 0.0)

    return values


def _column(name: str) -> Callable[[Batch], Array]:
    return lambda batch: np.asarray(batch.inputs.get(name, 1.0))


def _of_colors() -> Iterator[Fault]:
    for order in permutations(range(3)):
        words = ", ".join(CHANNELS[channel] for channel in order)
        yield Fault(
            f"the color channels are exchanged: they arrive as {words}",
            _input("color", itemgetter((..., list(order)))),
        )
    for channel, name in enumerate(CHANNELS):
        yield Fault(
            f"every channel takes the {name} of the color",
            _input("color", itemgetter((..., [channel] * 3))),
        )
    yield Fault(
        "every channel takes the mean of the color",
        _input("color", lambda color: color.mean(axis=-1, keepdims=True) * np.ones(3)),
    )
    yield Fault(
        "the color is ignored; 0.18 is used instead",
        _input("color", lambda color: np.full_like(color, 0.18)),
    )
    yield Fault("the color is clamped to 1", _input("color", lambda color: np.minimum(color, 1.0)))
    yield Fault("the color is squared", _input("color", np.square))
    yield Fault("the color is replaced by its square root", _input("color", np.sqrt))


def _of_roughness() -> Iterator[Fault]:
    yield Fault("the roughness is squared", _input("roughness", np.square))
    yield Fault("the roughness is replaced by its square root", _input("roughness", np.sqrt))
    yield Fault(
        "tangent and bitangent are exchanged",
        _input(
            "roughness", lambda roughness: roughness[:, ::-1] if roughness.ndim > 1 else roughness
        ),
    )
    yield Fault("the roughness is halved", _input("roughness", lambda roughness: 0.5 * roughness))
    for constant in CONSTANTS:
        change = partial(np.full_like, fill_value=constant)
        yield Fault(
            f"the roughness is ignored; {constant:g} is used instead", _input("roughness", change)
        )


def _of_weight() -> Iterator[Fault]:
    occlusion = _input("occlusion", np.ones_like)
    ways: tuple[tuple[str, Callable[[Array], Array]], ...] = (
        ("", np.ones_like),
        (" but for 0 and below", lambda weight: np.where(weight > 0.0, 1.0, 0.0)),
    )
    for but, change in ways:
        weight = _input("weight", change)
        yield Fault(f"the weight is ignored{but}", weight)
        yield Fault(
            f"the occlusion is ignored, and the weight{but}",
            lambda batch, weight=weight: weight(occlusion(batch)),  # type: ignore[misc]
        )
    yield Fault("the weight is applied twice", values=_scaled(_column("weight")))


COLOR_FAULTS = tuple(_of_colors())
INPUT_FAULTS = (*_of_weight(), *COLOR_FAULTS, *_of_roughness())

DIRECT_FAULTS = (
    *INPUT_FAULTS,
    Fault("the occlusion is ignored", _input("occlusion", np.ones_like)),
    Fault("the occlusion is applied once too often", values=_scaled(_column("occlusion"))),
    Fault("the cosine of the light is missing", values=_scaled(lambda batch: 1.0 / batch.wi[:, 2])),
    Fault("the cosine of the light is applied twice", values=_scaled(lambda batch: batch.wi[:, 2])),
    Fault(
        "the cosine is the viewer's instead of the light's: the directions are swapped",
        values=_scaled(lambda batch: batch.wo[:, 2] / batch.wi[:, 2]),
    ),
    Fault(
        "the light is mirrored about the normal: s has the wrong sign",
        lambda batch: replace(batch, wi=batch.wi * [-1.0, -1.0, 1.0]),
    ),
    Fault(
        "light from below the horizon is reflected as if it came from above",
        lambda batch: replace(batch, wi=np.where([False, False, True], abs(batch.wi), batch.wi)),
    ),
)

ENVIRONMENT_FAULTS = (
    *INPUT_FAULTS,
    Fault(
        "the occlusion is applied here and again by the caller",
        values=_scaled(_column("occlusion")),
    ),
    Fault(
        "the albedo is the one at normal incidence",
        lambda batch: replace(batch, wo=np.broadcast_to([0.0, 0.0, 1.0], batch.wo.shape)),
    ),
)


def exchanges(names: Iterable[str]) -> Iterator[Fault]:
    """Two inputs in each other's place, or all those of two nodes, whose names are before a slash."""
    for pair in combinations(dict.fromkeys(name.split("/")[0] for name in names), 2):
        yield Fault(f"{pair[0]} and {pair[1]} are exchanged", partial(_exchanged, *pair))


def _exchanged(one: str, other: str, batch: Batch) -> Batch:
    changes, inputs = {}, batch.inputs
    for name in inputs:
        node, *port = name.split("/")
        there = "/".join([{one: other, other: one}.get(node, node), *port])
        if there in inputs and np.shape(inputs[there]) == np.shape(inputs[name]):
            changes[name] = inputs[there]
    return batch.altered(**changes)


def scaled_by(factor: float) -> Fault:
    """The fault of values that carry a factor."""
    text = f"every value is {factor:.6g} times the right one"
    if np.isclose(factor, np.pi, rtol=1e-5):
        text = "the factor 1/pi is missing"
    if np.isclose(factor, 1.0 / np.pi, rtol=1e-5):
        text = "the factor 1/pi is applied twice"
    return Fault(text, values=lambda batch, values: factor * values)


def normal_ignored(batch: Batch) -> Batch:
    """The pairs of a batch in turned frames as a node sees them that uses the surface's normal, +z."""
    wo, wi = batch.world(batch.wo), batch.world(batch.wi)
    side = np.where(wo[:, 2:] < 0.0, -1.0, 1.0)
    return replace(batch, wo=wo * side, wi=wi * side, frame=None)
