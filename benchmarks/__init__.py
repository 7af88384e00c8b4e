# SPDX-License-Identifier: Apache-2.0
"""Benchmarks: `python -m benchmarks` measures, checks what it measures, and writes the page."""
