# SPDX-License-Identifier: Apache-2.0
"""Fits of every coefficient that is not exact, in arithmetic that is the same on every machine."""
