# SPDX-License-Identifier: Apache-2.0
"""Measures claims of [Portsmouth2025] for the page "The paper, checked"."""
