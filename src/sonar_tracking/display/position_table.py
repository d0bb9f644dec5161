"""The table of position tracks: in the terminal while the graph runs, and of what a bag holds.

People read compass courses (degrees clockwise from north), so that is what stands here.
"""

from __future__ import annotations

import math

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from sonar_tracking.filtering.uncertainty_ellipse import uncertainty_ellipse
from sonar_tracking.motion import compass_from_azimuth
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource

MOST_ROWS = 24
STATUS_STYLE = {
    TrackStatus.TENTATIVE: "yellow",
    TrackStatus.CONFIRMED: "green",
    TrackStatus.COASTED: "magenta",
    TrackStatus.TERMINATED: "dim",
}
CERTAIN = 0.995
"""Probability of a side from which on it is no longer shown."""

_RANK = {
    TrackStatus.CONFIRMED: 0,
    TrackStatus.COASTED: 1,
    TrackStatus.TENTATIVE: 2,
    TrackStatus.TERMINATED: 3,
}
COLUMNS = (
    "x\nm",
    "y\nm",
    "height\nm",
    "course\ndeg",
    "speed\nm/s",
    "95 % ellipse\nm, deg",
    "exist-\nence",
    "observ-\nable",
    "side",
)
"""Headings of two lines, so that a terminal of 80 columns is wide enough."""

HEIGHT = 2
"""Place of the column that is left out where no height is known."""


def position_table(title: str, tracks: PositionTracks, most_rows: int = MOST_ROWS) -> Table:
    """Return the table of one picture.

    Parameters
    ----------
    title : str
        Heading, e.g. the topic.
    tracks : PositionTracks
        The picture.
    most_rows : int
        Rows shown: confirmed tracks first, then coasted, tentative and terminated ones; a last
        line tells how many were left out.
    """
    table = Table(
        title=title,
        title_justify="left",
        box=box.SIMPLE_HEAD,
        show_edge=False,
        pad_edge=False,
        padding=0,
    )
    table.add_column("track", justify="right", no_wrap=True)
    table.add_column("status", no_wrap=True)
    heights = bool(np.isfinite(tracks.z).any())
    for heading in shown_cells(COLUMNS, heights):
        table.add_column(heading, justify="right", no_wrap=True)
    rows = sorted(range(len(tracks)), key=lambda row: (_RANK[_status(tracks, row)], row))
    for row in rows[:most_rows]:
        status = _status(tracks, row)
        table.add_row(
            str(int(tracks.id[row])),
            Text(status.name.lower(), style=STATUS_STYLE[status]),
            *shown_cells(position_cells(tracks, row), heights),
        )
    if len(rows) > most_rows:
        table.add_row("", Text(f"and {len(rows) - most_rows} more", style="dim"))
    return table


def shown_cells(cells: tuple[str, ...], heights: bool) -> tuple[str, ...]:
    """Return what is shown of a row of :data:`COLUMNS`, with or without heights."""
    return cells if heights else cells[:HEIGHT] + cells[HEIGHT + 1 :]


def position_cells(tracks: PositionTracks, row: int) -> tuple[str, ...]:
    """Return what the columns :data:`COLUMNS` say of one track; unknown is a dash.

    Parameters
    ----------
    tracks : PositionTracks
        The picture.
    row : int
        Row of the track.
    """
    x, y = (float(value) for value in tracks.state[row, :2])
    speed = math.hypot(*tracks.state[row, 2:])
    return (
        _number(x, "+.0f"),
        _number(y, "+.0f"),
        _height(tracks, row),
        _course(tracks, row),
        _number(speed, ".1f"),
        _ellipse(tracks, row),
        _number(float(tracks.existence_probability[row]), ".2f"),
        _number(float(tracks.observability[row]), ".2f"),
        side_text(tracks, row),
    )


def _height(tracks: PositionTracks, row: int) -> str:
    """Return the height with its standard deviation; alone where it was only assumed."""
    height, deviation = float(tracks.z[row]), float(tracks.z_standard_deviation[row])
    text = _number(height, "+.0f")
    return f"{text}±{deviation:.0f}" if math.isfinite(height + deviation) else text


def _course(tracks: PositionTracks, row: int) -> str:
    if int(tracks.source[row]) == TrackSource.STATIC:
        return "fixed"
    vx, vy = (float(value) for value in tracks.state[row, 2:])
    return compass_text(math.atan2(vy, vx)) if math.hypot(vx, vy) > 0.0 else "-"


def compass_text(azimuth: float) -> str:
    """Return an azimuth (rad) as people say a course: three digits, never 360; dash = unknown."""
    if not math.isfinite(azimuth):
        return "-"
    return f"{round(float(compass_from_azimuth(azimuth))) % 360:03d}"


def side_text(tracks: PositionTracks, row: int) -> str:
    """Return the side of the array a track stands on and its probability; dash = no sides."""
    hypothesis = int(tracks.hypothesis[row])
    if hypothesis == TrackHypothesis.SINGLE:
        return "-"
    name = TrackHypothesis(hypothesis).name.lower()
    probability = float(tracks.hypothesis_probability[row])
    if math.isnan(probability) or probability >= CERTAIN:
        return name
    return f"{name} {100.0 * probability:.0f}%"


def _status(tracks: PositionTracks, row: int) -> TrackStatus:
    return TrackStatus(int(tracks.status[row]))


def _ellipse(tracks: PositionTracks, row: int) -> str:
    """Return half axes and compass direction of the major one."""
    ellipse = uncertainty_ellipse(tracks.covariance[row])
    if ellipse is None:
        return "-"
    # An axis has no sense: of its two directions the one below 180 degrees is said.
    axis = round(float(np.mod(compass_from_azimuth(ellipse.azimuth), 180.0))) % 180
    return f"{ellipse.semi_major:.0f}x{ellipse.semi_minor:.0f}, {axis:03d}"


def _number(value: float, form: str) -> str:
    return f"{value:{form}}" if math.isfinite(value) else "-"
