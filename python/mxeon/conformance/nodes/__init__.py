# SPDX-License-Identifier: Apache-2.0
"""What is judged: each node in each of its modes, with the model that it has to be."""
