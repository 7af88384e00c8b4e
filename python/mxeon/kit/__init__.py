# SPDX-License-Identifier: Apache-2.0
"""The kit tests renderers that mxeon cannot run, by pictures that a user renders and submits."""
