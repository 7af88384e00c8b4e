# SPDX-License-Identifier: Apache-2.0
"""Tests of mxeon. BLAS and PyTorch use a single thread per process, because idle threads spin."""

import os

# NumPy's BLAS library reads the number of threads when NumPy is imported.
os.environ.setdefault("OMP_NUM_THREADS", "1")
