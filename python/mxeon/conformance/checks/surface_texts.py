# SPDX-License-Identifier: Apache-2.0
"""The check of a sentence in a surface shader's specification."""

import numpy as np

from mxeon.conformance import check, controls, diagnosis
from mxeon.conformance.case import Case, values
from mxeon.conformance.results import Cause, Diagnosis, Kind
from mxeon.conformance.spec import broadcast_inputs
from mxeon.conformance.specs.surface_texts import EMITTED, SentenceSpec
from mxeon.errors import NotRun

SENTENCE = diagnosis.Comparison("value", values, lambda case: case.valued.value_candidates)
LOBES, LOBES_TOO = (Cause(Kind.DEFECT, key) for key in ("lobes_of_graph", "lobes_too"))


def diagnose(case: Case) -> Diagnosis:
    """Find which reading of the sentence the shader, or at least its graph of lobes, follows."""
    from mxeon.conformance.reference import Reference

    spec, explained = case.of(SentenceSpec), SENTENCE.diagnose(case)
    if explained.kind is Kind.MODEL or spec.evaluated == EMITTED:
        return explained
    [batch] = case.batches
    branch, _, factor = spec.evaluated
    inputs = broadcast_inputs(batch.altered(**{**spec.fixed, **batch.inputs}))
    try:
        shader = case.evaluating.shader
        graph = factor * Reference().evaluate(shader, batch.wo, batch.wi, inputs, branch)
    except NotRun:
        return explained
    readings = spec.value_candidates
    errors = {each.title: float(np.abs(each.values(batch) - graph).max()) for each in readings}
    nearest = min(errors, key=errors.__getitem__)
    if errors[nearest] > case.tolerance("value").value:
        return explained
    if explained.distances[nearest] < explained.distances[readings[0].title]:
        return Diagnosis((Cause(Kind.MODEL, nearest), LOBES_TOO), explained.distances)
    return Diagnosis((LOBES,), explained.distances)


# fmt: off
ROWS = (
    check.Check(key="specification", claim="The surface shader does what this sentence of its specification says.",
          applies=check.family(SentenceSpec), measure=SENTENCE, tolerance="value", control=controls.shifted,
          explain=diagnose, open=True),
)
# fmt: on
