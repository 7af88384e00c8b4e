# SPDX-License-Identifier: Apache-2.0
"""Microfacets under a thin film: subjects, probes, measurements."""
