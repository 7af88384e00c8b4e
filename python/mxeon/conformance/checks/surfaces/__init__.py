# SPDX-License-Identifier: Apache-2.0
"""Surface shaders as a whole, with every lobe on: subjects, probes, measurements, tolerances."""
