# SPDX-License-Identifier: Apache-2.0
"""Negative controls: cases with wrong inputs or outputs, on which checks must fail."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.case import Case
from mxeon.conformance.samples import Array, Batch


@dataclass(frozen=True)
class Control:
    """A mistake that a check must catch: a description, and a function that makes the mistake."""

    words: str
    make: Callable[[Case], Case]

    def of(self, case: Case) -> Case:
        return replace(self.make(case), control=True)


def with_batch(words: str, change: Callable[[Batch], Batch]) -> Control:
    return Control(words, lambda case: replace(case, inputs=change))


def with_inputs(words: str, **inputs: ArrayLike) -> Control:
    return with_batch(words, lambda batch: batch.altered(**inputs))


def with_values(words: str, change: Callable[[Batch, Array], Array]) -> Control:
    return Control(words, lambda case: replace(case, outputs=change))


def scale(words: str, factor: float) -> Control:
    return with_values(words, lambda batch, values: factor * values)


def scale_cosine(words: str, power: int) -> Control:
    def change(batch: Batch, values: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(values * batch.wo[:, 2:] ** power)

    return with_values(words, change)


def _mean_colors(batch: Batch) -> Batch:
    colors = {
        name: np.repeat(np.mean(values, axis=-1, keepdims=True), 3, axis=-1)
        for name, values in batch.inputs.items()
        if name != "normal" and np.shape(values)[-1:] == (3,)
    }
    return batch.altered(**colors)


offset = with_values("0.001 is added to every value", lambda batch, values: values + 1e-3)
no_number = with_values(
    "one output is not a number",
    lambda batch, values: np.where(np.arange(len(values))[:, None], values, np.nan),
)
pass_all = Control(
    "all light passes",
    lambda case: replace(case, throughputs=lambda batch, values: np.ones_like(values)),
)
take_response = Control(
    "the response is returned as the throughput",
    lambda case: replace(case, throughputs=lambda batch, values: case.direct(batch)),
)
drop_changes = Control(
    "every change is dropped", lambda case: replace(case, inputs=lambda batch: case.few[0])
)
gray = with_batch("every channel gets the mean color", _mean_colors)
shifted = with_batch(
    "each row uses the inputs of another row",
    lambda batch: batch.altered(**{k: np.roll(v, 1, axis=0) for k, v in batch.inputs.items()}),
)
drop_normal = with_inputs("the node's normal is dropped", normal=(0.0, 0.0, 1.0))
