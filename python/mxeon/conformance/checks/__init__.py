# SPDX-License-Identifier: Apache-2.0
"""The table of checks, what they measure, and what they are applied to."""
