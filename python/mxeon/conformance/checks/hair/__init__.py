# SPDX-License-Identifier: Apache-2.0
"""The hair node: subject, probe, tolerances."""
