# SPDX-License-Identifier: Apache-2.0
"""Fits of approximate coefficients for shaders, in arithmetic that is the same on every machine."""
