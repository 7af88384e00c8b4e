# SPDX-License-Identifier: Apache-2.0
"""Checks of text: definitions of nodes, generated sources and functions, none of them executed."""

from mxeon.conformance.text.checks import check_definitions as check_definitions
from mxeon.conformance.text.checks import check_texts as check_texts
