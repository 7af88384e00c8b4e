# SPDX-License-Identifier: Apache-2.0
"""Rough diffuse reflection made right in every MaterialX target, and proved by running it."""

__version__ = "0.1.0"
