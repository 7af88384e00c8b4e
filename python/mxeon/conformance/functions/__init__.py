# SPDX-License-Identifier: Apache-2.0
"""Checks of shader functions, each against the NumPy function of its name."""
