"""SIGINT (Ctrl-C) and SIGTERM while a program starts.

Until it has done anything a program ends at once, without a word and with exit code 0, wherever
the signal finds it: most of a start is the import of other packages, and an exception raised there
may be caught, or come out as another. Later each program ends in its own order.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)


def end_at_once() -> None:
    """Let a stop signal end this process with exit code 0: it has begun nothing yet."""
    for number in STOP_SIGNALS:
        signal.signal(number, _end)


def end_as_usual() -> None:
    """Undo :func:`end_at_once`: SIGINT raises KeyboardInterrupt, SIGTERM ends the process."""
    for number, usual in (
        (signal.SIGINT, signal.default_int_handler),
        (signal.SIGTERM, signal.SIG_DFL),
    ):
        if signal.getsignal(number) is _end:
            signal.signal(number, usual)


def never_end() -> None:
    """Ignore stop signals, at the end of a program.

    The interpreter restores its own handlers before it is gone: a late signal would kill it.
    """
    for number in STOP_SIGNALS:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def interruptible() -> Iterator[None]:
    """Let stop signals raise KeyboardInterrupt for the length of a block."""
    before = {number: signal.signal(number, _interrupt) for number in STOP_SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _end(_number: int, _frame: FrameType | None) -> None:
    os._exit(0)


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt
