# SPDX-License-Identifier: Apache-2.0
"""Checks of text: definitions of nodes, generated sources and functions, none of them executed."""

from collections.abc import Iterable

from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.nodes.diffuse import DiffuseSubject
from mxeon.conformance.results import Result
from mxeon.conformance.text.closures import check_closures
from mxeon.conformance.text.definitions import check_definitions
from mxeon.conformance.text.entries import check_entries
from mxeon.conformance.text.sources import check_calls, check_languages

__all__ = ["check_definitions", "check_texts"]


def check_texts(subjects: Iterable[DiffuseSubject], library: str) -> tuple[Result, ...]:
    """Results of all checks of generated text and of functions for the nodes of a library."""
    subjects = tuple(subjects)
    return (
        *check_closures(subjects, library),
        *check_languages(library),
        *check_entries(library),
        *check_calls((*subjects, *BSDFS), library),
    )
