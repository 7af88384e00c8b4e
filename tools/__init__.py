# SPDX-License-Identifier: Apache-2.0
"""Scripts for coefficients, figures and pages; users install none of them."""
