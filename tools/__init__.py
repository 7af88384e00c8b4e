# SPDX-License-Identifier: Apache-2.0
"""Scripts that make coefficients, figures and pages. The scripts are not part of the package."""
