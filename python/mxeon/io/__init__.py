# SPDX-License-Identifier: Apache-2.0
"""NumPy arrays and text as files. Independent of shading."""
