# SPDX-License-Identifier: Apache-2.0
"""Bounds of the checks: the tolerances of each kind of probe, each with its derivation."""
