"""SIGINT (Ctrl-C) and SIGTERM: what ends by them says nothing, and what its exit code says.

Until it has done anything a program ends at once, without a word, wherever the signal finds it:
most of a start is the import of other packages, and an exception raised there may be caught, or
come out as another. Later each program ends in its own order. A node that is told to stop has done
its work: its exit code is 0. A command that is stopped has not: its exit code is 128 and the number
of the signal (130, 143), as that of any command of a shell.
"""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)

HUNG = signal.SIGALRM
"""Kills what has done its work, and does not come to its end."""

_received: list[int] = []
"""The stop signals this process has noted."""


def end_at_once() -> None:
    """Let a stop signal end this process with exit code 0: a node that starts, or a worker."""
    for number in STOP_SIGNALS:
        signal.signal(number, _end)


def end_command_at_once() -> None:
    """Let a stop signal end this command with its exit code: it has begun nothing yet."""
    for number in STOP_SIGNALS:
        signal.signal(number, _end_command)


def interruptible() -> None:
    """Let stop signals raise KeyboardInterrupt from here on; :func:`stop_code` tells of it."""
    for number in STOP_SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _interrupt)


def note_stop(number: int) -> None:
    """Keep in mind that a stop signal has come; the first decides on the exit code."""
    _received.append(number)


def stop_code() -> int:
    """Return the exit code of a command that was stopped; 0 = it was not."""
    return 128 + _received[0] if _received else 0


def never_end() -> None:
    """Ignore stop signals, at the end of a program.

    The interpreter restores its own handlers before it is gone: a late signal would kill it.
    """
    for number in STOP_SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    # Where an interruption came in a text that was being executed, as packages make their classes
    # of, the interpreter remembers it, although it was caught, and at last ends by SIGINT. The next
    # text that is executed makes it forget.
    exec("")


def end_within(seconds: float) -> None:
    """Let the system end this process after a time, s, whatever it hangs in then.

    No handler of Python would be heard in a library that waits for itself. The process is then
    killed by :data:`HUNG`.
    """
    signal.signal(HUNG, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, seconds)


def _end(_number: int, _frame: FrameType | None) -> None:
    os._exit(0)


def _end_command(number: int, _frame: FrameType | None) -> None:
    os._exit(128 + number)


def _interrupt(number: int, _frame: FrameType | None) -> None:
    if not _received:
        # Where an exception cannot go on (a callback of C, the end of an object), Python tells of
        # it with a traceback: nobody wants that of an interruption.
        sys.unraisablehook = lambda _ignored: None
    note_stop(number)
    raise KeyboardInterrupt
