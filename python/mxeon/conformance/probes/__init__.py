# SPDX-License-Identifier: Apache-2.0
"""Probes: a node on a host, with its samples, the host's values for them and the expected ones."""
