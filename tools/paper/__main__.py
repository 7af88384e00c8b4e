# SPDX-License-Identifier: Apache-2.0
"""Make the figures of the EON paper and measure its claims: `python -m tools.paper out/figures`."""

import sys

from mxeon.cli.output import Progress
from tools.paper import figures

if len(sys.argv) != 2:
    sys.exit("usage: python -m tools.paper DIR")
print(figures(sys.argv[1], Progress("figures", lambda step: "")))
