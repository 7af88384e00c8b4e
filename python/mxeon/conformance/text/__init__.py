# SPDX-License-Identifier: Apache-2.0
"""Checks of text: definitions of nodes, generated sources and functions, none of them executed."""
