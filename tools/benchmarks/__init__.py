# SPDX-License-Identifier: Apache-2.0
"""Benchmarks: `python -m tools.benchmarks` measures, checks what it measures, and writes the page."""
