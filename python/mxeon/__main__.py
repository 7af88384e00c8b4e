# SPDX-License-Identifier: Apache-2.0
"""The process of the command `mxeon`, which is `python -m mxeon` too."""

import signal
import sys


def main():
    """Run the command; return its exit status."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback of the imports at Ctrl-C
    from mxeon.cli import main

    return main()


if __name__ == "__main__":
    from mxeon.jobs.processes import forget_working_folder

    forget_working_folder()
    sys.exit(main())
