# SPDX-License-Identifier: Apache-2.0
"""Infrastructure of all models: arrays, checks of arguments, evaluation in blocks, quadrature, layers."""
