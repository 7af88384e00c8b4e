# SPDX-License-Identifier: Apache-2.0
"""Tolerances: how exact a node's values are, by kind of probe, each with its derivation."""
