# SPDX-License-Identifier: Apache-2.0
"""The nodes that transmit: subjects, probes, measurements."""
