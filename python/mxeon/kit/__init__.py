# SPDX-License-Identifier: Apache-2.0
"""The kit, for renderers that mxeon cannot start: scenes out, pictures in, a verdict on them."""
