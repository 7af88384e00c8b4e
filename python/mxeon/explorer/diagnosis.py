# SPDX-License-Identifier: Apache-2.0
"""What the libraries make of the rough diffuse nodes, measured where the page is written."""

from functools import lru_cache

from mxeon.conformance.backends import Evaluating
from mxeon.conformance.case import Case, make_case
from mxeon.conformance.diagnosis.candidates import INEXACT
from mxeon.conformance.diagnosis.comparisons import ALBEDO, VALUE
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.conformance.specs.diffuse import VALUE as VALUE_ERROR
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
                _nearest(make_case(Evaluating, host, spec, library))
                for spec in DIFFUSE
                if spec.node == node
            ]
    except NotRun:
        return None
    return Models(names[0], names[-1]) if all(names) else None


def _nearest(case: Case) -> str:
    """Name of the model nearest to a case's values, told by its albedo from others of its BRDF."""
    rows = {row.title: row for row in KNOWN_DEFECTS + MODELS}
    value, albedo = (
        min(diagnosis.distances.items(), key=lambda item: item[1], default=("", float("inf")))
        for diagnosis in (VALUE.diagnose(case), ALBEDO.diagnose(case))
    )
    if value[1] > INEXACT * VALUE_ERROR.value:
        return ""
    same = albedo[0] and rows[albedo[0]].brdf is rows[value[0]].brdf
    return rows[albedo[0] if same else value[0]].name
