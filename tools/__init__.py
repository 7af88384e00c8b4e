# SPDX-License-Identifier: Apache-2.0
"""What makes coefficients, figures and pages; nothing that users install."""
