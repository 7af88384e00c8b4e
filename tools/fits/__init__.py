# SPDX-License-Identifier: Apache-2.0
"""Fits of the shaders' approximate coefficients, in arithmetic that is the same on every machine."""
