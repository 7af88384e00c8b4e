# SPDX-License-Identifier: Apache-2.0
"""The diagnosis of a failure: the known model, or known defect, that is nearest to the values."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mxeon.conformance.checks.batch import Array, Batch
from mxeon.models import table as reference
from mxeon.models.table import Model


@dataclass(frozen=True)
class Diagnosis:
    """The models nearest to some values.

    Attributes
    ----------
    text : str
        The nearest model and the next one, with their distances.
    distances : dict of str to float
        Root-mean-square distance to every model and defect, by title, in units of pi f cos.
    """

    text: str = ""
    distances: dict[str, float] = field(default_factory=dict)


def sentence(distances: Sequence[tuple[str, float]]) -> str:
    """The nearest model and the second nearest, in words.

    Parameters
    ----------
    distances : sequence of (str, float)
        Title and root-mean-square distance of two models or more, nearest first.

    Examples
    --------
    >>> sentence([("Lambert", 0.001), ("EON", 0.25)])
    'nearest known model: Lambert (rms 0.001), then EON (0.25)'
    """
    (first, least), (second, next_least) = distances[:2]
    return f"nearest known model: {first} (rms {least:.2g}), then {second} ({next_least:.2g})"


def nearest_value(probe: Any) -> Diagnosis:
    """The model nearest to the probe's values."""
    batches = [_clipped(batch) for batch in probe.few]
    rows = {row.brdf: row for row in reference.KNOWN_DEFECTS + reference.MODELS}
    return _nearest(
        rows.values(),
        [probe.direct(batch) for batch in batches],
        lambda row: [batch.expected(row.name) for batch in batches],
    )


def nearest_albedo(probe: Any) -> Diagnosis:
    """The model whose directional albedo is nearest to the probe's environment branch."""
    batches = [_clipped(batch) for batch in probe.cosines]
    rows = [row for row in reference.MODELS + reference.KNOWN_DEFECTS if row.albedo_dir]
    return _nearest(
        rows,
        [probe.albedo(batch) for batch in batches],
        lambda row: [batch.albedo(row.name) for batch in batches],
    )


def _clipped(batch: Batch) -> Batch:
    """The batch with roughness in [0, 1], where every model takes it."""
    return batch.altered(roughness=np.minimum(batch.inputs["roughness"], 1.0))


def _nearest(
    rows: Iterable[Model], measured: Sequence[Array], expected: Callable[[Model], list[Array]]
) -> Diagnosis:
    values = np.concatenate(measured)
    if not np.isfinite(values).all():
        return Diagnosis("values that are not finite: no model is near")
    distances = {
        row.title: float(np.sqrt(np.mean((values - np.concatenate(expected(row))) ** 2)))
        for row in rows
    }
    ranking = sorted(distances.items(), key=lambda item: item[1])
    return Diagnosis(sentence(ranking), distances)
