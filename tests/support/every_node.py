# SPDX-License-Identifier: Apache-2.0
"""Judges the values of a library's nodes on gl, with the MaterialX that this process imports.

    python -m tests.support.every_node LIBRARY [NODE ...]

The program prints the verdicts as JSON.
"""

import builtins
import json
import sys

import mxeon
from tests.support.plans import keep

KEYS = ("value", "environment", "transmitted", "combination", "radiance", "transmittance", "output")


def main(library, *nodes):
    keep(builtins, lambda task: (task.host, task.check in KEYS) == ("gl", True))
    run = mxeon.check(None, ["gl"], [library], nodes=nodes or ["all"])
    print(json.dumps({f"{each.check}, {each.subject}": each.verdict for each in run.results}))


if __name__ == "__main__":
    main(*sys.argv[1:])
