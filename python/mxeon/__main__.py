# SPDX-License-Identifier: Apache-2.0
"""Entry point of the command `mxeon` and of `python -m mxeon`."""

import signal
import sys


def main() -> int:
    """Run the command, and return the exit status."""
    end_at_interrupt()
    from mxeon import cli

    return cli.main()


def end_at_interrupt() -> None:
    """Let Ctrl-C end the process without a traceback while modules are imported."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


if __name__ == "__main__":
    end_at_interrupt()
    from mxeon.jobs.processes import forget_working_folder

    forget_working_folder()
    sys.exit(main())
