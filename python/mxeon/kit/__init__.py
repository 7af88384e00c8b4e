# SPDX-License-Identifier: Apache-2.0
"""The kit: tests of renderers that mxeon cannot run. Users submit the renderer's pictures."""
