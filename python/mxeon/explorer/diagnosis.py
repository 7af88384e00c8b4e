# SPDX-License-Identifier: Apache-2.0
"""What the libraries make of the rough diffuse nodes, measured where the page is written."""

from functools import lru_cache

from mxeon.conformance.accuracy import diffuse as tolerances
from mxeon.conformance.diagnosis.candidates import INEXACT
from mxeon.conformance.diagnosis.comparisons import ALBEDO, VALUE
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.errors import NotRun
from mxeon.explorer.data import Models
from mxeon.hosts import open_host
from mxeon.models.table import KNOWN_DEFECTS, MODELS


@lru_cache
def measured_models(library: str, node: str) -> Models | None:
    """The models that a node is with each state of its flag, as the gl host evaluates it.

    None where gl does not run here, or no known model is near.
    """
    try:
        with open_host("gl") as host:
            names = [
                _nearest(PairProbe(host, subject, library))
                for subject in SUBJECTS
                if subject.node == node
            ]
    except NotRun:
        return None
    return Models(names[0], names[-1]) if all(names) else None


def _nearest(probe: PairProbe) -> str:
    """Name of the model nearest to a probe's values, told by its albedo from others of its BRDF."""
    rows = {row.title: row for row in KNOWN_DEFECTS + MODELS}
    value, albedo = (
        min(diagnosis.distances.items(), key=lambda item: item[1], default=("", float("inf")))
        for diagnosis in (VALUE.diagnose(probe), ALBEDO.diagnose(probe))
    )
    if value[1] > INEXACT * tolerances.VALUE.value:
        return ""
    same = albedo[0] and rows[albedo[0]].brdf is rows[value[0]].brdf
    return rows[albedo[0] if same else value[0]].name
