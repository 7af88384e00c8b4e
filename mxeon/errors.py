# SPDX-License-Identifier: Apache-2.0
"""Errors that have words for the user, and the exit status of the command that meets one."""


class Failure(RuntimeError):
    """Something that could not be done; the message says what and why, in one line.

    Attributes
    ----------
    status : int
        Exit status of the command: 1 a check failed, 3 something did not run.
    """

    status = 3


# Every other error is a bug, which shows its traceback.
WORDED = (Failure, ValueError, ImportError, OSError)
