"""How long a call takes, and how that grows with the size of what it is given."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

import numpy as np

LEAST_BATCH = 2e-3
"""Short calls are repeated for so long before the clock is read, s."""

BATCHES = 3
"""At least."""

LONG = 0.25
"""A call that takes longer is timed twice only, s."""


def cpu_seconds(call: Callable[[], object], patience: float) -> float:
    """Return the processor time of a call: that of the fastest of several batches, s.

    Other work on the machine can only slow a batch down, and the time that others had the processor
    does not count.

    Parameters
    ----------
    call : callable
        Its first call warms caches up.
    patience : float
        How long to go on, s of the wall clock; three batches are made in any case.
    """
    first, once = _once(call), _once(call)
    if once > LONG:
        return min(first, once)
    count = max(1, math.ceil(LEAST_BATCH / max(once, 1e-7)))
    seconds: list[float] = []
    deadline = time.monotonic() + patience
    while len(seconds) < BATCHES or time.monotonic() < deadline:
        started = time.process_time()
        for _ in range(count):
            call()
        seconds.append((time.process_time() - started) / count)
    return min(seconds)


def _once(call: Callable[[], object]) -> float:
    started = time.process_time()
    call()
    return time.process_time() - started


def scaling_exponent(sizes: Sequence[float], seconds: Sequence[float]) -> float:
    """Return p of seconds = c size^p, by least squares of the logarithms; NaN for one size.

    Parameters
    ----------
    sizes : sequence of float
        Positive.
    seconds : sequence of float
        s, positive.
    """
    if len(set(sizes)) < 2:
        return math.nan
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])
