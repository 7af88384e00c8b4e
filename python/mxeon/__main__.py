# SPDX-License-Identifier: Apache-2.0
"""Entry point of the command `mxeon` and of `python -m mxeon`."""

import signal
import sys


def main() -> int:
    """Run the command; return its exit status."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback of the imports at Ctrl-C
    from mxeon import cli

    return cli.main()


if __name__ == "__main__":
    from mxeon.jobs.processes import forget_working_folder

    forget_working_folder()
    sys.exit(main())
