# SPDX-License-Identifier: Apache-2.0
"""The explanation of a failure: the known model, defect or fault behind it, or its place."""
