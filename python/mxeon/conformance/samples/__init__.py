# SPDX-License-Identifier: Apache-2.0
"""Pairs of directions with a node's inputs, random ones and edge cases; errors and tolerances."""
