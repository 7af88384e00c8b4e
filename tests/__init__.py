# SPDX-License-Identifier: Apache-2.0
"""Tests. Each of pytest's processes keeps to one thread of BLAS and of PyTorch, whose threads wait by spinning."""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy is imported; BLAS reads it too
