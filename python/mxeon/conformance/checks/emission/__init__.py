# SPDX-License-Identifier: Apache-2.0
"""The nodes of pbrlib that emit light, and media: subjects, probes, measurements, tolerances."""
