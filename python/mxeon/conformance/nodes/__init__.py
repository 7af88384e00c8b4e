# SPDX-License-Identifier: Apache-2.0
"""What is judged: each node in each mode, with its inputs, their ranges, and the model that it has to be."""
