# SPDX-License-Identifier: Apache-2.0
"""A row of the table of checks."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mxeon.conformance.checks.controls import Control
from mxeon.conformance.diagnosis import candidates as diagnosis
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.measurement import Measurement, Metric
from mxeon.conformance.samples.tolerance import Tolerance
from mxeon.hosts.base import Host


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
    adapt : callable (tolerance, subject, kind, host) -> Tolerance
        The tolerance on a host, by the errors of its engine's own functions.
    """

    key: str
    claim: str
    models: tuple[str, ...]
    measure: Callable[[Probe, Metric], Measurement]
    variant: str
    control: Control
    tolerances: Mapping[str, Tolerance]
    applies: Callable[[Subject, str], bool] = lambda subject, host: True
    diagnose: Callable[[Probe], Diagnosis] = diagnosis.diagnose_value
    open: bool = False
    adapt: Callable[[Tolerance, Subject, str, Host], Tolerance] = lambda tolerance, *_: tolerance
