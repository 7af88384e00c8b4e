# SPDX-License-Identifier: Apache-2.0
"""Checks of the utility nodes, which compute numbers and colors that feed the lobes.

Values are compared in units in which their roundings are alike.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.conformance.accuracy import utilities as tolerances
from mxeon.conformance.accuracy.diffuse import count_of
from mxeon.conformance.accuracy.engine import widen_for_engine
from mxeon.conformance.accuracy.utilities import ALPHA
from mxeon.conformance.checks import measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import drop_changes, no_number, shifted
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.candidates import Diagnosis, explain
from mxeon.conformance.probes.cases import dead_inputs
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.conformance.samples.measurement import (
    Case,
    Measurement,
    count_not_finite,
)
from mxeon.models.microfacet.artistic_ior import normal_reflectance
from mxeon.models.nodes.utilities import LARGEST_REFLECTIVITY, UTILITIES

NAMES = tuple(row.category for row in UTILITIES)


def output(probe: Probe) -> Iterator[Case]:
    """Outputs against those of the equations."""
    unit = UNITS.get(probe.subject.title, _as_it_is)
    for batch in probe.batches:
        measured, expected = probe.direct(batch), probe.expected(batch)
        yield Case(batch, unit(measured, batch), unit(expected, batch))


def explained(probe: Probe) -> Diagnosis:
    """The explanation of a probe's outputs."""
    unit = UNITS.get(probe.subject.title, _as_it_is)
    candidates = [
        replace(each, values=partial(_in_unit, unit, each.values))
        for each in probe.value_candidates
    ]
    tolerance = widen_for_engine(ALPHA, probe.subject, probe.kind, probe.host)
    return explain(probe, list(output(probe)), candidates, (), tolerance)


def finite_outputs(probe: Probe) -> Measurement:
    """Number of outputs that are not finite, at the ends of the ranges and beyond."""
    return count_not_finite(probe.edges, probe.direct(probe.edges))


def explained_finite(probe: Probe) -> Diagnosis:
    """The explanation of outputs that are not finite: a bound that an input of each exceeds."""
    # Find the outputs that are not finite.
    batch = probe.edges
    bad = np.asarray(~np.isfinite(probe.direct(batch)).all(axis=1))
    if not bad.any():
        return Diagnosis()
    share = f"{int(bad.sum())} of {len(bad)} outputs are not finite"
    # Look for an input that is out of its range in all of them.
    for name, values in batch.inputs.items():
        rows = np.reshape(values, (len(bad), -1))
        low, high = rows.min(axis=1), rows.max(axis=1)
        if low[bad].max() <= 0.0:
            return Diagnosis(f"{share}, all with {name} {low[bad].max():g} or below")
        if high[bad].min() >= 1.0:
            return Diagnosis(f"{share}, all with {name} {high[bad].min():g} or above")
    return Diagnosis(share)


def round_trip(probe: Probe) -> Iterable[Case]:
    """Reflectance at normal incidence of an artistic index, against the reflectivity asked for."""
    extinction = probe.other("extinction")
    measured = []
    for batch in probe.batches:
        reflectance = normal_reflectance(probe.direct(batch), extinction.direct(batch))
        asked = np.minimum(batch.inputs["reflectivity"], LARGEST_REFLECTIVITY)
        measured.append(Case(batch, reflectance, asked))
    return measured


def _in_unit(
    unit: Callable[[Array, Batch], Array], values: Callable[[Batch], Array], batch: Batch
) -> Array:
    return np.asarray(unit(values(batch), batch))


def _as_it_is(values: Array, batch: Batch) -> Array:
    return values


def _of_index(values: Array, batch: Batch) -> Array:
    """n (1 - sqrt(r))^2: a rounding of 1 - sqrt(r) is divided by it in n."""
    root = np.sqrt(_reflectivity(batch))
    return np.asarray(values * np.square(1.0 - root))


def _of_extinction(values: Array, batch: Batch) -> Array:
    """k^2 (1 - r) / (n_max + 1)^2: k^2 is a difference of terms that large, over 1 - r."""
    r = _reflectivity(batch)
    largest = 2.0 / (1.0 - np.sqrt(r))  # n_max + 1
    return np.asarray(np.square(values) * (1.0 - r) / np.square(largest))


def _reflectivity(batch: Batch) -> Array:
    return np.asarray(np.clip(batch.inputs["reflectivity"], 0.0, LARGEST_REFLECTIVITY))


# Of outputs in which a rounding grows, by title.
UNITS: Mapping[str, Callable[[Array, Batch], Array]] = {
    "artistic_ior, ior": _of_index,
    "artistic_ior, extinction": _of_extinction,
}

CHECKS = (
    Check(
        "output",
        "The output of the utility node matches its equations.",
        NAMES,
        output,
        shifted,
        "value",
        diagnose=explained,
        open=True,
        adapt=widen_for_engine,
    ),
    Check(
        "round_trip",
        "The artistic index reproduces the requested reflectivity.",
        ("artistic_ior",),
        round_trip,
        shifted,
        tolerances.ROUND_TRIP,
        applies=lambda subject, host: subject.title == "artistic_ior, ior",
        diagnose=explained,
    ),
    Check(
        "output_inputs",
        "Every input of the utility node changes the outputs that depend on it.",
        NAMES,
        measures.counted(dead_inputs),
        drop_changes,
        count_of("inputs"),
        diagnose=input_diagnosis.diagnose_inputs,
    ),
    Check(
        "output_finite",
        "Every output is finite, at the ends of the ranges and beyond.",
        NAMES,
        finite_outputs,
        no_number,
        count_of("values"),
        pairs=True,
        diagnose=explained_finite,
    ),
)
