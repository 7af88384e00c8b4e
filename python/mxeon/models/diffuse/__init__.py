# SPDX-License-Identifier: Apache-2.0
"""Rough diffuse reflection: the Oren-Nayar family, Burley, and diffuse transmission."""
