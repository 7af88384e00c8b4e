# SPDX-License-Identifier: Apache-2.0
"""Light through microfacets: refraction, the BTDF, what it passes, and the readings of Schlick."""
