# SPDX-License-Identifier: Apache-2.0
"""The program that `mxeon.hosts.process` runs in a renderer's Python, where mxeon may be absent.

The first argument is a script with a function `start`. This function takes the other arguments, and
returns the greeting, a function that answers a request, and the exceptions to report as
`{"error": ...}`. A script that cannot start exits with a reason, as in `sys.exit("no display")`.
Standard output of a renderer is redirected to standard error.
"""

import json
import os
import sys
from runpy import run_path


def main(script: str, *arguments: str) -> None:
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    try:
        greeting, answer, errors = run_path(script)["start"](*arguments)
    except SystemExit as reason:
        print(json.dumps({"error": reason.code}), file=replies)
        sys.exit(1)
    print(json.dumps(greeting), file=replies)
    for line in sys.stdin:
        reply = {}
        try:
            answer(**json.loads(line))
        except errors as error:
            reply["error"] = " ".join(str(error).split())
        print(json.dumps(reply), file=replies)


if __name__ == "__main__":
    main(*sys.argv[1:])
