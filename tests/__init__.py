# SPDX-License-Identifier: Apache-2.0
"""Tests. Each pytest process uses one thread of BLAS and of PyTorch, whose waiting threads spin."""

import os

# Set before NumPy is imported, because BLAS reads it then.
os.environ.setdefault("OMP_NUM_THREADS", "1")
