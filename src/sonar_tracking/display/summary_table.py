"""What became of each track, as rows of text: for the terminal, a file and a picture."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.display.picture_files import new_figure, save_picture
from sonar_tracking.display.place_text import place_text
from sonar_tracking.display.position_history import PositionHistory
from sonar_tracking.display.position_table import COLUMNS, position_cells, shown_cells
from sonar_tracking.display.track_history import TrackHistory
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.bearings import AngleKind, TrackStatus
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.time import seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from rich.table import Table

MOST_PICTURE_ROWS = 40
ROW_HEIGHT = 0.25
"""Of the picture, inches."""

HEAD_ROWS = 3.6
"""Height of title and headings, in rows."""


@dataclass(frozen=True)
class SummaryTable:
    """A table of text.

    Attributes
    ----------
    title : str
        Heading, e.g. the topic.
    headings : tuple of str
        Of the columns.
    rows : tuple of tuple of str
        One a track.
    """

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def to_rich(self) -> Table:
        """Return the table as the terminal shows it."""
        from rich import box
        from rich.table import Table

        table = Table(
            title=self.title,
            title_justify="left",
            box=box.SIMPLE_HEAD,
            show_edge=False,
            pad_edge=False,
            padding=0,
        )
        for heading in self.headings:
            table.add_column(heading, justify="right", no_wrap=True)
        for row in self.rows:
            table.add_row(*row)
        return table


def bearing_summary(title: str, histories: Iterable[TrackHistory], start: int) -> SummaryTable:
    """Return a table with one row a bearing track.

    Parameters
    ----------
    title : str
        Heading.
    histories : iterable of TrackHistory
        Tracks to list.
    start : int
        Stamp that counts as time zero, ns.
    """
    rows = []
    for history in histories:
        coasted = 100.0 * np.mean(history.status == TrackStatus.COASTED)
        known = history.deviations[np.isfinite(history.deviations)]
        rows.append(
            (
                str(history.id),
                *_life(history.stamps, start),
                _angle_text(history, 0),
                _angle_text(history, -1),
                f"{np.degrees(np.median(known)):.2f}" if known.size else "-",
                f"{coasted:.0f}",
            )
        )
    headings = (
        *("track", "first\ns", "last\ns", "from\ndeg", "to\ndeg"),
        *("deviation\ndeg", "coasted\n%"),
    )
    return SummaryTable(title, headings, tuple(rows))


def position_summary(
    title: str, histories: Iterable[PositionHistory], start: int, datum: Datum | None = None
) -> SummaryTable:
    """Return a table with one row a position track, as it stood at its end.

    Parameters
    ----------
    title : str
        Heading.
    histories : iterable of PositionHistory
        Tracks to list.
    start : int
        Stamp that counts as time zero, ns.
    datum : Datum or None
        Of ``map``; None = places are not listed.
    """
    listed = tuple(histories)
    heights = any(np.isfinite(history.tracks.z[-1]) for history in listed)
    rows = tuple(
        (
            str(history.id),
            *_life(history.stamps, start),
            *shown_cells(position_cells(history.tracks, len(history.stamps) - 1), heights),
            *(() if datum is None else (place_text(history.positions[-1], datum),)),
        )
        for history in listed
    )
    headings = ("track", "first\ns", "last\ns", *shown_cells(COLUMNS, heights))
    headings += () if datum is None else ("latitude\nlongitude",)
    return SummaryTable(title, headings, rows)


def draw_summary_tables(tables: Sequence[SummaryTable], path: Path) -> tuple[Path, Path]:
    """Draw tables below each other, and return the files written.

    Parameters
    ----------
    tables : sequence of SummaryTable
        At least one; of a long one the first rows are drawn, and the number of the others.
    path : Path
        Image file.
    """
    shown = [_shortened(table) for table in tables]
    heights = [ROW_HEIGHT * (len(table.rows) + HEAD_ROWS) for table in shown]
    figure = new_figure(11.0, sum(heights) + 0.2, layout=None)
    top = 1.0
    for table, height in zip(shown, heights, strict=True):
        share = height / (sum(heights) + 0.2)
        _draw_table(figure.add_axes((0.02, top - share, 0.96, share)), table)
        top -= share
    return save_picture(figure, path)


def _shortened(table: SummaryTable) -> SummaryTable:
    if len(table.rows) <= MOST_PICTURE_ROWS:
        return table
    left_out = len(table.rows) - MOST_PICTURE_ROWS
    title = f"{table.title}, without {left_out} more tracks"
    return SummaryTable(title, table.headings, table.rows[:MOST_PICTURE_ROWS])


def _draw_table(axes: Axes, table: SummaryTable) -> None:
    """Draw one table; a unit of height is a row, the headings take two."""
    axes.set_axis_off()
    axes.set(xlim=(0.0, 1.0), ylim=(len(table.rows) + HEAD_ROWS, 0.0))
    axes.text(0.0, 0.6, table.title, fontweight="bold", fontsize=11, va="center")
    edges = _right_edges(table)
    first = HEAD_ROWS - 0.9
    for edge, heading in zip(edges, table.headings, strict=True):
        axes.text(edge, first, heading, ha="right", va="bottom", fontsize=8, color="#555555")
    axes.axhline(first + 0.15, color="#555555", linewidth=0.8)
    for number, row in enumerate(table.rows):
        middle = first + 0.75 + number
        if number % 2:
            axes.axhspan(middle - 0.5, middle + 0.5, color="#EEF3F7", linewidth=0)
        for edge, text in zip(edges, row, strict=True):
            axes.text(edge, middle, text, ha="right", va="center", fontsize=9)


def _right_edges(table: SummaryTable) -> FloatArray:
    """Return where the columns end, 0 to 1, as wide as their longest text."""
    lines = [
        [line for cell in (heading, *cells) for line in cell.split("\n")]
        for heading, *cells in zip(table.headings, *table.rows, strict=True)
    ]
    widths = np.array([max(map(len, column)) + 3 for column in lines])
    return (np.cumsum(widths) - 0.5) / np.sum(widths)


def _life(stamps: IntArray, start: int) -> tuple[str, str]:
    first, last = seconds(int(stamps[0]) - start), seconds(int(stamps[-1]) - start)
    return f"{first:.1f}", f"{last:.1f}"


def _angle_text(history: TrackHistory, row: int) -> str:
    """Return an angle from broadside with its sign, a compass bearing without."""
    degrees = float(history.degrees[row])
    return f"{degrees:.1f}" if history.kind == AngleKind.AZIMUTH else f"{degrees:+.1f}"
