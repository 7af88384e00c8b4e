# SPDX-License-Identifier: Apache-2.0
"""The results of a conformance run as plain data, and the verdict on them."""

from mxeon.conformance.results.pictures import AlbedoCurve, Picture, image_names
from mxeon.conformance.results.result import (
    DIFFERS,
    DIRECT,
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    SHADER_FUNCTIONS,
    SOURCE,
    VERDICTS,
    Claims,
    Control,
    Place,
    Result,
    in_words,
    of_white,
)
from mxeon.conformance.results.run import Run
from mxeon.conformance.results.summary import Summary, counted, summarize

__all__ = [
    "DIFFERS",
    "DIRECT",
    "FAILED",
    "NOT_RUN",
    "PASSED",
    "PORTRAIT",
    "SHADER_FUNCTIONS",
    "SOURCE",
    "VERDICTS",
    "AlbedoCurve",
    "Claims",
    "Control",
    "Picture",
    "Place",
    "Result",
    "Run",
    "Summary",
    "counted",
    "image_names",
    "in_words",
    "of_white",
    "summarize",
]
