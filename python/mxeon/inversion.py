# SPDX-License-Identifier: Apache-2.0
"""Reflectance from a wanted albedo: the public name of `mxeon.models.diffuse.inversion`."""

from mxeon.models.diffuse.inversion import *  # noqa: F403
