# SPDX-License-Identifier: Apache-2.0
"""The kit, for renderers that mxeon cannot start: scenes out, pictures in, and a verdict on them."""
