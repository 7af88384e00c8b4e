# SPDX-License-Identifier: Apache-2.0
"""Judges the nodes of a library on gl with the MaterialX of this process, each by its values.

python -m tests.support.every_node LIBRARY [NODE ...]     prints the verdicts as JSON
"""

import json
import sys
from contextlib import closing

from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.shaders.document.policy import DEFAULT

KEYS = (
    *("value", "environment", "film", "transmitted", "combination"),
    *("radiance", "transmittance", "output"),
)


def main(library, *nodes):
    tasks = make_plan((), ("gl",), (library,), nodes=nodes or ("all",)).tasks
    with closing(Judge(DEFAULT)) as judge:
        results = [
            each
            for task in tasks
            if (task.host, task.check in KEYS) == ("gl", True)
            for each in judge.work(task).results
        ]
    print(json.dumps({f"{each.check}, {each.subject}": each.verdict for each in results}))


if __name__ == "__main__":
    main(*sys.argv[1:])
