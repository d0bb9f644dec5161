"""The live track table: what a person watches while the graph runs."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from sonar_tracking.display.plan_view import PlanView
from sonar_tracking.display.position_table import STATUS_STYLE, position_table
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import NANOSECONDS

PICTURE_COLUMNS = 61
PICTURE_ROWS = 16
POSITION_ROWS = 6
"""Rows of the bearing-time picture above positions."""


@dataclass(frozen=True)
class GraphState:
    """What the table says about the graph.

    Attributes
    ----------
    scenario : str
        Name of the scenario.
    data_seconds, wall_seconds : float
        Since data began to flow.
    backlog : int
        Messages the slowest consumer has not finished.
    activity : str
        What the graph is doing, e.g. ``"running"``.
    """

    scenario: str
    data_seconds: float
    wall_seconds: float
    backlog: int
    activity: str


class TrackTable:
    """Draws the tracks, their recent bearings, positions and the state of the graph."""

    def __init__(self) -> None:
        self._positions: dict[str, PositionTracks] = {}
        self._plan = PlanView()
        self._first_seen: dict[int, int] = {}
        self._history: deque[BearingTracks] = deque(maxlen=PICTURE_ROWS)

    def add(self, tracks: BearingTracks) -> None:
        """Take the newest picture."""
        if self._history and tracks.stamp < self._history[-1].stamp:
            self._history.clear()
            self._first_seen.clear()
        self._history.append(tracks)
        for identifier in tracks.id:
            self._first_seen.setdefault(int(identifier), tracks.stamp)

    def add_positions(self, topic: str, tracks: PositionTracks) -> None:
        """Take the newest positions of a topic."""
        self._positions[topic] = tracks
        self._plan.add(topic, tracks)

    def render(self, state: GraphState) -> RenderableType:
        """Return what to show: bearings unless there are only positions, then the positions."""
        parts: list[RenderableType] = [_head(state)]
        if self._history or not self._positions:
            # Where positions follow, a few rows of bearings have to do.
            newest = list(self._history)[-POSITION_ROWS if self._positions else 0 :]
            parts += [self._table(), bearing_time_picture(newest)]
        parts += [position_table(*entry) for entry in sorted(self._positions.items())]
        return Group(*parts, self._plan.render()) if self._positions else Group(*parts)

    def _table(self) -> Table:
        table = Table(show_edge=False, pad_edge=False)
        table.add_column("track", justify="right")
        table.add_column("status")
        for heading in ("bearing deg", "rate deg/s", "sigma deg", "SNR dB", "age s"):
            table.add_column(heading, justify="right")
        if not self._history:
            return table
        tracks = self._history[-1]
        for row in range(len(tracks.id)):
            status = TrackStatus(int(tracks.status[row]))
            identifier = int(tracks.id[row])
            age = (tracks.stamp - self._first_seen[identifier]) / NANOSECONDS
            table.add_row(
                str(identifier),
                Text(status.name.lower(), style=STATUS_STYLE[status]),
                _degrees(float(tracks.arrival_angle[row]), "+.2f"),
                _degrees(float(tracks.arrival_angle_rate[row]), "+.2f"),
                _degrees(math.sqrt(max(tracks.covariance[row, 0, 0], 0.0)), ".2f"),
                _decibel(float(tracks.signal_to_noise_ratio[row])),
                f"{age:.0f}",
            )
        return table


def _head(state: GraphState) -> Text:
    rate = state.data_seconds / state.wall_seconds if state.wall_seconds > 0 else 0.0
    return Text.assemble(
        (state.scenario, "bold"),
        f"  {state.data_seconds:7.1f} s of data  {rate:4.1f} x real time  ",
        f"backlog {state.backlog}  ",
        (state.activity, "cyan"),
    )


def bearing_time_picture(history: Sequence[BearingTracks]) -> Text:
    """Draw recent bearings, newest at the top, -90 to +90 degrees from left to right.

    Parameters
    ----------
    history : sequence of BearingTracks
        Oldest first.
    """
    middle = PICTURE_COLUMNS // 2
    lines = ["-90" + "0".center(PICTURE_COLUMNS - 6) + "+90 deg"]
    for tracks in reversed(history):
        line = [" "] * PICTURE_COLUMNS
        line[middle] = "."
        for identifier, angle in zip(tracks.id, tracks.arrival_angle, strict=True):
            if not math.isfinite(angle):
                continue
            place = middle + round(middle * math.degrees(angle) / 90.0)
            if 0 <= place < PICTURE_COLUMNS:
                line[place] = "0123456789abcdefghijklmnopqrstuvwxyz"[int(identifier % 36)]
        lines.append("".join(line))
    return Text("\n".join(lines), no_wrap=True)


def _degrees(angle: float, form: str) -> str:
    return f"{math.degrees(angle):{form}}" if math.isfinite(angle) else "-"


def _decibel(ratio: float) -> str:
    return f"{10.0 * np.log10(ratio):+.1f}" if ratio > 0.0 else "-"
