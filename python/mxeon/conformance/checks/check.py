# SPDX-License-Identifier: Apache-2.0
"""A row of the table of checks: what is asked of a probe, and where its bound comes from."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from mxeon.conformance.accuracy.accuracy import ACCURACY, Quantity
from mxeon.conformance.checks.controls import Mistake
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.diagnosis.comparisons import VALUE, Comparison
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
    measure : Comparison, or callable (probe) -> Case, iterable of Case, or Measurement
        What is compared, of which the worst row counts; or a number of its own.
    control : Mistake
        With which it has to fail.
    allowed : Quantity, Tolerance or None
        The quantity by whose accuracy a kind of probe is judged, which it may lack; the tolerance
        where it is the same for all; or None for the quantity of a Comparison.
    pairs : bool
        Whether it asks for pairs of directions that not every host shows.
    lit : bool
        Whether it asks how light is found, summed or let through, which no closure tells.
    applies : callable (subject, host) -> bool
        Whether the check can be asked about a subject of those models on the host of a name.
    diagnose : callable (probe) -> Diagnosis, or None
        Explanation of a failure; None for that of the Comparison, or of values.
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
    allowed: Quantity | Tolerance | None = None
    pairs: bool = False
    lit: bool = False
    applies: Callable[[Subject, str], bool] = lambda subject, host: True
    diagnose: Callable[[Probe], Diagnosis] | None = None
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
        if isinstance(self.allowed, Tolerance):
            return self.allowed
        return accuracy.of(self.allowed or self.comparison.quantity)

    @property
    def comparison(self) -> Comparison:
        """What it compares, or values where it measures something of its own."""
        return self.measure if isinstance(self.measure, Comparison) else VALUE

    def explain(self, probe: Probe) -> Diagnosis:
        """The explanation of a failure."""
        return (self.diagnose or self.comparison.diagnose)(probe)
