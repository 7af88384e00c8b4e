# SPDX-License-Identifier: Apache-2.0
"""Importance sampling: the public name of `mxeon.models.sampling`."""

from mxeon.models.sampling import *  # noqa: F403
