# SPDX-License-Identifier: Apache-2.0
"""Emission, participating media, and light below the surface."""
