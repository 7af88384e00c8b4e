# SPDX-License-Identifier: Apache-2.0
"""What all models share: arrays, checks of arguments, threads, quadrature, layers."""
