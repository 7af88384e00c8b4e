# SPDX-License-Identifier: Apache-2.0
"""The BSDF nodes of pbrlib beside the rough diffuse ones: subjects, probes, measurements, tolerances."""
