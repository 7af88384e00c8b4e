# SPDX-License-Identifier: Apache-2.0
"""Tests of mxeon. BLAS and PyTorch use one thread per pytest process, because idle threads use CPUs."""

import os

# NumPy's BLAS library reads the number of threads when NumPy is imported.
os.environ.setdefault("OMP_NUM_THREADS", "1")
