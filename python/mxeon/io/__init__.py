# SPDX-License-Identifier: Apache-2.0
"""Read and write files of text, records and NumPy arrays."""
