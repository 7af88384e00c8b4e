# SPDX-License-Identifier: Apache-2.0
"""Scripts that fit the coefficients of approximations in shaders."""
