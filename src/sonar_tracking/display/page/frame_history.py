"""What a page that is opened late is sent: the newest of every kind at once, then the past."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator

from sonar_tracking.display.page.page_frames import Frame

LARGEST = 192 * 1024 * 1024
"""Bytes kept, whatever the time."""

BACKWARDS = 5.0
"""Data times of a stream that go back by more than this begin anew, s."""

STEADY = frozenset({"sources", "health", "command_result", "waterfall_open", "lofar", "dots"})
"""Kinds that are no part of the past, or whose past is sent to who asks for it."""

LASTING = frozenset({"command"})
"""Kinds whose effect lasts, however long ago they were: kept apart from what is forgotten."""

MOST_LASTING = 10_000
"""Of those kept, the newest."""

WITHOUT_TIME = frozenset({"sources", "health", "command_result"})
"""Kinds that tell nothing of a time of the data: they are true wherever these begin."""


class FrameHistory:
    """Frames of a bounded time, within bounded memory.

    Parameters
    ----------
    seconds : float
        Data time kept.

    Attributes
    ----------
    bytes : int
        Size of what is kept of the past.
    newest : float
        Data time of the newest frame, s; minus infinity = there is none.
    """

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._frames: deque[Frame] = deque()
        self._lasting: deque[Frame] = deque(maxlen=MOST_LASTING)
        self.bytes = 0
        self.newest = -math.inf
        self.latest: dict[str, Frame] = {}

    def __len__(self) -> int:
        """Return the number of frames kept."""
        return len(self._lasting) + len(self._frames)

    def __iter__(self) -> Iterator[Frame]:
        """Iterate over the past, what lasts first, else as it came."""
        return iter((*self._lasting, *self._frames))

    def begins_anew(self, frame: Frame) -> bool:
        """Return whether a frame says that the clock of the data has gone back.

        Commands do not: they may be stamped late, or not at all.
        """
        if frame.kind in LASTING:
            return False
        before = self.latest.get(frame.stream)
        return before is not None and frame.time < before.time - BACKWARDS

    def add(self, frame: Frame) -> None:
        """Keep a frame, and forget what is older than the time kept."""
        self.latest[frame.stream] = frame
        if frame.kind in STEADY or not math.isfinite(frame.time):
            return
        if frame.kind in LASTING:
            self._lasting.append(frame)
            return
        self.newest = max(self.newest, frame.time)
        self._frames.append(frame)
        self.bytes += len(frame.data)
        oldest = self.newest - self._seconds
        while self.bytes > LARGEST or (self._frames and self._frames[0].time < oldest):
            self.bytes -= len(self._frames.popleft().data)

    def clear(self) -> None:
        """Forget everything: the data begin anew."""
        self._frames.clear()
        self._lasting.clear()
        latest = self.latest.items()
        self.latest = {name: frame for name, frame in latest if frame.kind in WITHOUT_TIME}
        self.bytes, self.newest = 0, -math.inf
