"""Runs mypy with the arguments given, in four fifths of its time.

What mypy makes of the sources stays to the end: its collector of garbage looks at more and more,
and finds next to nothing. Here it looks seldom, for a quarter of a gigabyte more.
"""

from __future__ import annotations

import gc
from typing import Any

from mypy.__main__ import console_entry

ALLOCATIONS = 3_000_000
"""After which the collector looks at what is new."""


def _nothing(*_: Any) -> None:
    """Leave the collector as it is: mypy tunes it, too."""


if __name__ == "__main__":
    gc.set_threshold(ALLOCATIONS, 50, 10_000)
    gc.set_threshold = _nothing
    console_entry()
