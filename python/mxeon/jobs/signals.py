# SPDX-License-Identifier: Apache-2.0
"""The signals that end a command: Ctrl-C, `kill`, and a terminal that is closed."""

import signal
import threading
from contextlib import contextmanager

TERMINAL = (signal.SIGINT, signal.SIGHUP)  # come to all processes of a terminal
ENDING = (*TERMINAL, signal.SIGTERM)

_postponed = None  # the numbers of those that came, while they are put off


class Ended(KeyboardInterrupt):
    """A signal ended the command.

    Attributes
    ----------
    status : int
        Exit status of the command: 128 and the number of the signal, as a shell has it.
    """

    def __init__(self, number):
        interrupted = number == signal.SIGINT
        super().__init__(
            "interrupted" if interrupted else f"ended by {signal.Signals(number).name}"
        )
        self.status = 128 + number


@contextmanager
def raised():
    """Raise Ended at such a signal, so that nothing stays behind; one that is ignored stays so."""

    def end(number, _):
        if _postponed is None:
            raise Ended(number)
        _postponed.append(number)

    main = threading.current_thread() is threading.main_thread()  # Python lets no other listen
    heard = [each for each in ENDING if main and signal.getsignal(each) != signal.SIG_IGN]
    before = {number: signal.signal(number, end) for number in heard}
    try:
        yield
    finally:
        for number, usual in before.items():
            signal.signal(number, usual or signal.SIG_DFL)


@contextmanager
def blocked():
    """Put such signals off; processes started meanwhile never hear of those of a terminal.

    This process decides when they end, by SIGTERM, so that one must reach them at any time.
    """
    global _postponed
    _postponed = []
    before = signal.pthread_sigmask(signal.SIG_BLOCK, TERMINAL)
    try:
        yield
    finally:
        postponed, _postponed = _postponed, None
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        if postponed:
            raise Ended(postponed[0])
