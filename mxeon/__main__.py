# SPDX-License-Identifier: Apache-2.0
"""`python -m mxeon` is the command `mxeon`."""

import sys

from mxeon.cli import main

sys.exit(main())
