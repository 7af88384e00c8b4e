# SPDX-License-Identifier: Apache-2.0
"""What a host computes instead: the known model, or known defect, that its values are nearest to."""

from dataclasses import dataclass, field

import numpy as np

from mxeon.models import table as reference


@dataclass(frozen=True)
class Diagnosis:
    """What values are nearest to.

    Attributes
    ----------
    text : str
        The nearest model and the next one, with their distances.
    distances : dict of str to float
        Root-mean-square distance to every model and defect, by title, in units of pi f cos.
    """

    text: str = ""
    distances: dict = field(default_factory=dict)


def nearest_value(probe):
    """The model nearest to the probe's values, as a Diagnosis."""
    batches = [_clipped(batch) for batch in probe.few]
    rows = {row.brdf: row for row in reference.KNOWN_DEFECTS + reference.MODELS}
    return _nearest(
        rows.values(),
        [probe.direct(batch) for batch in batches],
        lambda row: [batch.expected(row.name) for batch in batches],
    )


def nearest_albedo(probe):
    """The model whose directional albedo is nearest to the probe's environment branch."""
    batches = [_clipped(batch) for batch in probe.cosines]
    rows = [row for row in reference.MODELS + reference.KNOWN_DEFECTS if row.albedo_dir]
    return _nearest(
        rows,
        [probe.albedo(batch) for batch in batches],
        lambda row: [_albedo(row, batch) for batch in batches],
    )


def _albedo(row, batch):
    parameter = [batch.inputs["roughness"]] if row.parameter else []
    return row.albedo_dir(batch.wo[:, 2], batch.inputs["color"], *parameter)


def _clipped(batch):
    """The batch with roughness in [0, 1], where every model takes it."""
    return batch.altered(roughness=np.minimum(batch.inputs["roughness"], 1.0))


def _nearest(rows, measured, expected):
    measured = np.concatenate(measured)
    if not np.isfinite(measured).all():
        return Diagnosis("values that are not finite: no model is near")
    distances = {
        row.title: float(np.sqrt(np.mean((measured - np.concatenate(expected(row))) ** 2)))
        for row in rows
    }
    first, second = sorted(distances, key=distances.get)[:2]
    return Diagnosis(
        f"nearest known model: {first} (rms {distances[first]:.2g}), "
        f"then {second} ({distances[second]:.2g})",
        distances,
    )
