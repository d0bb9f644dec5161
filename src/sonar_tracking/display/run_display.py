"""What ``run`` and ``replay`` show while they work: a live table, or lines where that is no use."""

from __future__ import annotations

from types import TracebackType
from typing import Protocol

import numpy as np
from rich.console import Console
from rich.live import Live

from sonar_tracking.display.track_table import GraphState, TrackTable
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.positions import PositionTracks

REFRESH_SECONDS = 0.25
LINE_SECONDS = 10.0


class RunDisplay(Protocol):
    """What the orchestration tells a display."""

    def __enter__(self) -> RunDisplay: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...

    def say(self, sentence: str) -> None:
        """Show a sentence that stays."""

    def tracks(self, tracks: BearingTracks) -> None:
        """Take the newest bearing tracks."""

    def position_tracks(self, topic: str, tracks: PositionTracks) -> None:
        """Take the newest position tracks of a topic, e.g. ``"/active/tracks"``.

        May be called for any number of topics at any time; a topic is shown from its first
        picture on, the newest picture of each.
        """

    def due(self, wall: float) -> bool:
        """Return whether it is time to call :meth:`show`."""

    def show(self, state: GraphState, wall: float) -> None:
        """Show the state of the graph now."""


class LiveDisplay:
    """The track table, redrawn in place."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._live = Live(console=console, auto_refresh=False, transient=False)
        self._table = TrackTable()
        self._shown = 0.0

    def __enter__(self) -> LiveDisplay:
        self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._live.stop()

    def say(self, sentence: str) -> None:
        """Show a sentence above the table."""
        self._console.print(sentence, highlight=False, markup=False)

    def tracks(self, tracks: BearingTracks) -> None:
        """Take the newest bearing tracks."""
        self._table.add(tracks)

    def position_tracks(self, topic: str, tracks: PositionTracks) -> None:
        """Take the newest position tracks of a topic."""
        self._table.add_positions(topic, tracks)

    def due(self, wall: float) -> bool:
        """Return whether the table is old."""
        return wall - self._shown >= REFRESH_SECONDS

    def show(self, state: GraphState, wall: float) -> None:
        """Redraw the table."""
        self._shown = wall
        self._live.update(self._table.render(state), refresh=True)


class LineDisplay:
    """A line now and then, for logs, pipes and ``--no-display``."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._shown: float | None = None
        self._counts: dict[str, int] = {}

    def __enter__(self) -> LineDisplay:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        return

    def say(self, sentence: str) -> None:
        """Print a sentence."""
        self._console.print(sentence, highlight=False, markup=False, soft_wrap=True)

    def tracks(self, tracks: BearingTracks) -> None:
        """Take the newest bearing tracks."""
        self._counts["bearing tracks"] = len(tracks.id)

    def position_tracks(self, topic: str, tracks: PositionTracks) -> None:
        """Take the newest position tracks of a topic; tentative and ended ones are not counted."""
        self._counts[f"in {topic}"] = int(np.count_nonzero(tracks.established))

    def due(self, wall: float) -> bool:
        """Return whether a line is due."""
        if self._shown is None:
            self._shown = wall
        return wall - self._shown >= LINE_SECONDS

    def show(self, state: GraphState, wall: float) -> None:
        """Print one line."""
        self._shown = wall
        counts = [f"{count} {name}" for name, count in sorted(self._counts.items())]
        self.say(
            f"{state.activity}: {state.data_seconds:.1f} s of data in {state.wall_seconds:.1f} s, "
            f"{', '.join(counts) or 'no tracks'}, backlog {state.backlog}"
        )
