# SPDX-License-Identifier: Apache-2.0
"""Faults made on purpose, and what became of the runs that suffered them."""
