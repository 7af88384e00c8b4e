# SPDX-License-Identifier: Apache-2.0
"""The nodes that transmit through microfacets: scatter modes T and RT."""

from dataclasses import dataclass, replace

from mxeon.conformance.specs.burley import VALUE as BURLEY_VALUE
from mxeon.conformance.specs.microfacets import (
    ENVIRONMENT,
    INPUTS,
    SCHLICK_THROUGHPUT,
    SMOOTH_ESS_FIT,
    THROUGHPUT,
    FacetSpec,
)
from mxeon.conformance.tolerance import Term, Tolerance, absolute, roundings, sum_of
from mxeon.models.nodes.transmissions import TRANSMISSION_NODES, TRANSMISSIONS, Transmission

# Largest slope of a Fresnel curve in the cosine, 0.05 from a critical angle: at index 1.02, cosine 0.05.
FRESNEL_SLOPE = 7.3


def _errors(passed: Tolerance) -> dict[str, Tolerance]:
    return {
        "value": passed,  # light that passes
        "light": sum_of(
            ENVIRONMENT.term("a reflected albedo"),
            passed.term("light that passes"),
            unit="light",
            metric=absolute,
        ),
        "kept": BURLEY_VALUE,  # one function of the same numbers
        "critical": sum_of(
            Term(SMOOTH_ESS_FIT, "the fit of E_ss of smooth lobes"),
            roundings(4 * FRESNEL_SLOPE, "of a cosine, times a Fresnel curve's largest slope, 7.3"),
            roundings(16),
            unit="albedo",
            metric=absolute,
        ),
    }


@dataclass(frozen=True, eq=False, kw_only=True)
class TransmissionSpec(FacetSpec):
    """A node of `mxeon.models.nodes.transmissions`."""

    @property
    def functions(self) -> Transmission:
        return TRANSMISSIONS[self.node]

    @property
    def reflects(self) -> bool:
        """Whether it reflects as well."""
        return self.row.fixed["scatter_mode"] == "RT"

    @property
    def reflection(self) -> FacetSpec:
        """The node where it only reflects."""
        row = replace(self.row, fixed={"scatter_mode": "R"})
        return FacetSpec.of(row, self.inputs, self.errors, counts=self.counts)


TRANSMISSION_SPECS = tuple(
    TransmissionSpec.of(
        row,
        INPUTS[row.category],
        _errors(THROUGHPUT if "tint" in row.inputs else SCHLICK_THROUGHPUT),
    )
    for row in TRANSMISSION_NODES
)
