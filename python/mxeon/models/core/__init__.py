# SPDX-License-Identifier: Apache-2.0
"""Code shared by all models: arrays, argument checks, evaluation in blocks, quadrature, layers."""
