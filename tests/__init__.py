# SPDX-License-Identifier: Apache-2.0
"""Tests. Each of pytest's processes keeps to one thread of BLAS, whose threads wait by spinning."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is imported
