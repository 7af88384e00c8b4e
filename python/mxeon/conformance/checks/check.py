# SPDX-License-Identifier: Apache-2.0
"""A row of the table of checks."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from mxeon.conformance.accuracy.accuracy import ACCURACY, Quantity
from mxeon.conformance.checks.controls import Mistake
from mxeon.conformance.diagnosis import candidates as diagnosis
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.measurement import Case, Measurement, Metric, worst_of
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
    measure : callable (probe) -> Case, iterable of Case, or Measurement
        What is compared, of which the worst row counts; or a number of its own.
    control : Mistake
        With which it has to fail.
    allowed : Quantity or Tolerance
        The quantity by whose accuracy a kind of probe is judged, which it may lack; or the tolerance
        where it is the same for all.
    pairs : bool
        Whether it asks for pairs of directions that not every host shows.
    lit : bool
        Whether it asks how light is found, summed or let through, which no closure tells.
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
    measure: Callable[[Probe], Case | Iterable[Case] | Measurement]
    control: Mistake
    allowed: Quantity | Tolerance
    pairs: bool = False
    lit: bool = False
    applies: Callable[[Subject, str], bool] = lambda subject, host: True
    diagnose: Callable[[Probe], Diagnosis] = diagnosis.diagnose_value
    open: bool = False
    adapt: Callable[[Tolerance, Subject, str, Host], Tolerance] = lambda tolerance, *_: tolerance

    def measured(self, probe: Probe, metric: Metric) -> Measurement:
        """The worst error of a probe."""
        found = self.measure(probe)
        if isinstance(found, Measurement):
            return found
        return worst_of(metric, [found] if isinstance(found, Case) else found)

    def tolerance(self, kind: str) -> Tolerance | None:
        """The tolerance for a kind of probe, or None where it cannot be asked."""
        accuracy = ACCURACY[kind]
        if (self.pairs and not accuracy.pairs) or (self.lit and not accuracy.lit):
            return None
        return self.allowed if isinstance(self.allowed, Tolerance) else accuracy.of(self.allowed)
