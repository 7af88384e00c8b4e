# SPDX-License-Identifier: Apache-2.0
"""A row of the table of checks."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from mxeon.conformance.diagnosis import candidates as diagnosis
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.samples.measurement import Measurement, Metric
from mxeon.conformance.samples.tolerance import Tolerance


@dataclass(frozen=True)
class Check:
    """A row of the table: what is asked of a probe.

    Attributes
    ----------
    key, claim : str
        One word, and a sentence.
    models : tuple of str
        The models that it holds for.
    measure : callable (probe, metric) -> Measurement
    variant : str
        The error that the control makes.
    control : callable (probe) -> probe
    tolerances : dict of str to Tolerance
        By kind of probe; one that is missing cannot be asked.
    applies : callable (subject, host) -> bool
        Whether the check can be asked about a subject of those models on the host of a name.
    diagnose : callable (probe) -> Diagnosis
        Explanation of a failure.
    open : bool
        Whether an error differs, and does not fail, where a permitted function explains all values.
    adapt : callable (tolerance, probe) -> Tolerance
        The tolerance on the probe's host, by the errors of its engine's own functions.
    """

    key: str
    claim: str
    models: tuple[str, ...]
    measure: Callable[[Any, Metric], Measurement]
    variant: str
    control: Callable[[Any], Any]
    tolerances: Mapping[str, Tolerance]
    applies: Callable[[Any, str], bool] = lambda subject, host: True
    diagnose: Callable[[Any], Diagnosis] = diagnosis.of_value
    open: bool = False
    adapt: Callable[[Tolerance, Any], Tolerance] = lambda tolerance, probe: tolerance
