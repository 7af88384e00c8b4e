# SPDX-License-Identifier: Apache-2.0
"""Measurements and controls of microfacets under a thin film."""

from typing import Any

import numpy as np

from mxeon.conformance.checks.batch import Array, Batch
from mxeon.conformance.checks.controls import Altered
from mxeon.conformance.checks.measures import Case, Measurement, Metric, worst_of

NEXT_TO_NOTHING = 1e-3  # thickness in nm of a film that changes nothing
LEAST_INDEX = 1.05  # of a substrate whose lobe is compared


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
