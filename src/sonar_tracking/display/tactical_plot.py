"""Tactical plot: the chart of a run, seen from above, north up.

Own ship's track, the targets where the truth is known, the tracks with the ellipses that hold the
target with 95 % probability, contacts as dots (early ones pale) and lines of bearing. Marks on the
tracks stand at the same instants on all of them, so that one sees who was where when.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonar_tracking.display.chart_graticule import draw_graticule
from sonar_tracking.display.picture_files import new_figure, save_picture
from sonar_tracking.display.position_history import PositionHistory
from sonar_tracking.display.tactical_scene import TacticalScene
from sonar_tracking.filtering.uncertainty_ellipse import uncertainty_ellipse
from sonar_tracking.records.arrays import FloatArray, IndexArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


SEA = "#F3F7FA"
OWN_SHIP = "#1A1A1A"
TRUTH = "#6B6B6B"
TRACK_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#B8860B", "#56B4E9", "#8B5CF6")
ELLIPSES_PER_TRACK = 6
MOST_BEARINGS = 36
"""Lines of bearing drawn, about, at instants all of whose lines are."""

MOST_LEGEND_TRACKS = 10
MOST_CONTACTS = 60_000
"""Of more, evenly chosen ones are drawn."""

ARROW_HEAD = np.array([[1.0, 0.0], [-0.8, 0.5], [-0.45, 0.0], [-0.8, -0.5], [1.0, 0.0]])
"""Outline of own ship's mark, bow along +x."""

KILOMETRES_FROM = 4_000.0
"""Charts wider than this are in kilometres, m."""


def draw_tactical_plot(scene: TacticalScene, path: Path, title: str = "") -> tuple[Path, Path]:
    """Draw a tactical plot, and return the files written.

    Parameters
    ----------
    scene : TacticalScene
        What lies on the chart.
    path : Path
        Image file.
    title : str
        Heading.
    """
    low, high = _limits(scene)
    size = _figure_size(high - low)
    figure = new_figure(*size)
    axes = figure.add_subplot()
    scale, unit = (1e-3, "km") if float(np.max(high - low)) > KILOMETRES_FROM else (1.0, "m")
    axes.set(xlim=tuple(scale * np.array([low[0], high[0]])))
    axes.set(ylim=tuple(scale * np.array([low[1], high[1]])))
    axes.set_aspect("equal")
    axes.set_facecolor(SEA)
    axes.grid(color="white", linewidth=1.2)
    axes.set_axisbelow(True)
    axes.set(xlabel=f"east, {unit}", ylabel=f"north, {unit}", title=title)
    if scene.datum is not None:
        draw_graticule(axes, low, high, scale, scene.datum)
    interval = _mark_interval(scene)
    _draw_contacts(axes, scene, scale)
    _draw_bearings(axes, scene, scale, 2.0 * float(np.linalg.norm(high - low)))
    _draw_open_tracks(axes, scene, scale)
    _draw_tracks(axes, scene, scale, interval)
    _draw_truth(axes, scene, scale, interval)
    _draw_own_ship(axes, scene, scale, interval)
    _draw_other_ships(axes, scene, scale)
    _draw_stations(axes, scene, scale)
    _draw_north(axes)
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        axes.legend(
            handles,
            labels,
            loc="best",
            fontsize=8,
            framealpha=0.9,
            title=f"marks every {_duration_text(interval)}, ellipses 95 %",
            title_fontsize=8,
        )
    return save_picture(figure, path)


def _limits(scene: TacticalScene) -> tuple[FloatArray, FloatArray]:
    """Return the corners of the chart: all that is drawn but ellipses and lines, and a margin.

    Of a track the outermost hundredth does not count, so that one that runs away for a moment does
    not shrink the rest; of contacts the outermost fifth of either side.
    """
    parts = [scene.own_ship[:, 1:3], _inner(scene.contacts[:, 1:3], 20.0)]
    parts += [np.array(list(scene.stations.values())).reshape(-1, 2)]
    parts += [history.positions for history in scene.truth]
    parts += [_inner(history.positions, 1.0) for history in _all_tracks(scene)]
    points = np.concatenate(parts)
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    margin = 0.07 * max(float(np.max(high - low)), 10.0)
    # A chart much longer than wide is hard to read: the short side is at least 45 % of it.
    shortest = 0.45 * float(np.max(high - low))
    missing = np.maximum(shortest - (high - low), 0.0)
    return low - 0.5 * missing - margin, high + 0.5 * missing + margin


def _inner(points: FloatArray, percent: float) -> FloatArray:
    if not len(points):
        return points
    return np.clip(points, *np.percentile(points, [percent, 100.0 - percent], axis=0))


def _figure_size(extent: FloatArray) -> tuple[float, float]:
    longest = 9.0
    width, height = longest * extent / np.max(extent)
    return float(width) + 0.8, float(height) + 0.7


def _all_tracks(scene: TacticalScene) -> Iterator[PositionHistory]:
    for histories in scene.tracks.values():
        yield from histories


def _mark_interval(scene: TacticalScene) -> float:
    """Return a round time of which about eight make up the run, s."""
    ends = [*scene.own_ship[-1:, 0], *scene.contacts[-1:, 0]]
    histories = [*scene.truth, *_all_tracks(scene)]
    ends += [history.seconds(scene.start)[-1] for history in histories]
    wanted = max([*ends, 1.0]) / 8.0
    steps = (1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 21600, 86400)
    return float(next((step for step in steps if step >= wanted), steps[-1]))


def _duration_text(seconds: float) -> str:
    return f"{seconds / 60.0:g} min" if seconds >= 60.0 else f"{seconds:g} s"


def _marks(times: FloatArray, interval: float) -> IndexArray:
    """Return the first row at or after each multiple of the interval."""
    if not len(times):
        return np.empty(0, np.intp)
    number = np.floor(times / interval + 1e-9)
    return np.flatnonzero(np.diff(number, prepend=number[0]) > 0)


def _draw_contacts(axes: Axes, scene: TacticalScene, scale: float) -> None:
    contacts = scene.contacts[:: 1 + len(scene.contacts) // MOST_CONTACTS]
    if not len(contacts):
        return
    # Early dots are pale: clutter stays a haze, a target draws a line through it.
    times = contacts[:, 0]
    age = (times - times[0]) / max(float(times[-1] - times[0]), 1e-9)
    alpha = np.clip(6_000.0 / len(contacts), 0.12, 0.7)
    colours = np.zeros((len(contacts), 4))
    colours[:, :3] = (0.72 - 0.42 * age)[:, None]
    colours[:, 3] = alpha * (0.5 + 0.5 * age)
    axes.scatter(
        scale * contacts[:, 1],
        scale * contacts[:, 2],
        s=5.0,
        c=colours,
        linewidths=0.0,
        zorder=1.5,
        rasterized=True,
        label=f"{len(scene.contacts)} contacts",
    )


def _draw_bearings(axes: Axes, scene: TacticalScene, scale: float, length: float) -> None:
    """Draw the lines of bearing of a few instants, from the sensor outwards."""
    from matplotlib.collections import LineCollection

    instants = np.unique(scene.bearings[:, 0])
    if not len(instants):
        return
    count = max(4, round(MOST_BEARINGS * len(instants) / len(scene.bearings)))
    chosen = instants[np.unique(np.linspace(0, len(instants) - 1, count).astype(int))]
    lines = scene.bearings[np.isin(scene.bearings[:, 0], chosen)]
    begin = lines[:, 1:3]
    end = begin + length * np.stack([np.cos(lines[:, 3]), np.sin(lines[:, 3])], axis=-1)
    axes.add_collection(
        LineCollection(
            list(scale * np.stack([begin, end], axis=1)),
            colors="#5A7A94",
            linewidths=0.6,
            alpha=0.4,
            zorder=1.7,
            label="bearings",
        ),
        autolim=False,
    )


def _draw_open_tracks(axes: Axes, scene: TacticalScene, scale: float) -> None:
    """Draw what may be a target dotted: sides of a line array, solutions without a range."""
    for number, history in enumerate(scene.open_tracks):
        label = "" if number else "open (side or range)"
        axes.plot(*(scale * history.positions).T, ":", color="#7A4FA3", linewidth=1.0, label=label)


def _draw_tracks(axes: Axes, scene: TacticalScene, scale: float, interval: float) -> None:
    number = 0
    many = sum(map(len, scene.tracks.values())) > MOST_LEGEND_TRACKS
    for topic, histories in scene.tracks.items():
        for row, history in enumerate(histories):
            colour = TRACK_COLOURS[number % len(TRACK_COLOURS)]
            number += 1
            label = f"{topic.lstrip('/')} {history.id}"
            if many:
                label = "" if row else f"{topic.lstrip('/')}: {len(histories)} tracks"
            _draw_ellipses(axes, history, colour, scale)
            points = scale * history.positions
            line = scale * history.positions_with_gaps()
            axes.plot(*line.T, color=colour, linewidth=1.7, zorder=4, label=label)
            marks = points[_marks(history.seconds(scene.start), interval)]
            axes.plot(*marks.T, "o", color=colour, markersize=3.5, zorder=4)
            _name(axes, points[-1], str(history.id), colour)


def _draw_ellipses(axes: Axes, history: PositionHistory, colour: str, scale: float) -> None:
    count = len(history.stamps)
    rows = np.unique(np.linspace(0, count - 1, ELLIPSES_PER_TRACK).astype(int))
    for row in rows:
        ellipse = uncertainty_ellipse(history.tracks.covariance[row])
        if ellipse is None:
            continue
        outline = scale * ellipse.outline(history.positions[row])
        last = row == count - 1
        axes.fill(*outline.T, color=colour, alpha=0.16 if last else 0.05, zorder=2)
        axes.plot(
            *outline.T, color=colour, linewidth=1.1 if last else 0.6, alpha=0.85 if last else 0.4
        )


def _draw_truth(axes: Axes, scene: TacticalScene, scale: float, interval: float) -> None:
    for number, history in enumerate(scene.truth):
        points = scale * history.positions
        axes.plot(
            *points.T,
            color=TRUTH,
            linestyle=(0, (4, 2)),
            linewidth=1.2,
            zorder=3,
            label="" if number else "targets (truth)",
        )
        marks = points[_marks(history.seconds(scene.start), interval)]
        axes.plot(*marks.T, "o", color=TRUTH, markersize=2.5, zorder=3)
        axes.plot(*points[0], "s", color=TRUTH, markersize=4.5, zorder=3)
        _name(axes, points[0], f"T{history.id}", TRUTH)


def _draw_own_ship(axes: Axes, scene: TacticalScene, scale: float, interval: float) -> None:
    if not len(scene.own_ship):
        return
    points = scale * scene.own_ship[:, 1:3]
    axes.plot(*points.T, color=OWN_SHIP, linewidth=1.4, zorder=5, label="own ship")
    marks = points[_marks(scene.own_ship[:, 0], interval)]
    axes.plot(*marks.T, "o", color=OWN_SHIP, markersize=3, zorder=5)
    heading = float(scene.own_ship[-1, 3])
    rotation = np.array(
        [[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]]
    )
    axes.plot(*points[-1], marker=ARROW_HEAD @ rotation, color=OWN_SHIP, markersize=13, zorder=6)


def _draw_other_ships(axes: Axes, scene: TacticalScene, scale: float) -> None:
    for name, states in scene.other_ships.items():
        if len(states):
            points = scale * states[:, 1:3]
            axes.plot(*points.T, color=OWN_SHIP, linewidth=1.0, linestyle="--", zorder=5)
            axes.plot(*points[-1], "o", color=OWN_SHIP, markersize=5, zorder=6)
            _name(axes, points[-1], name, OWN_SHIP)


def _draw_stations(axes: Axes, scene: TacticalScene, scale: float) -> None:
    for name, place in scene.stations.items():
        point = scale * np.array(place)
        axes.plot(*point, "^", color=OWN_SHIP, markersize=8, zorder=6)
        _name(axes, point, name, OWN_SHIP)


def _draw_north(axes: Axes) -> None:
    """Draw the arrow that says where north is, in the upper left corner."""
    place, colour = "axes fraction", "#333333"
    style: dict[str, Any] = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.4}
    axes.annotate("", (0.035, 0.95), (0.035, 0.88), xycoords=place, arrowprops=style, zorder=8)
    axes.text(
        0.035,
        0.955,
        "N",
        transform=axes.transAxes,
        ha="center",
        va="bottom",
        fontsize=10,
        color=colour,
        zorder=8,
    )


def _name(axes: Axes, place: FloatArray, text: str, colour: str) -> None:
    from matplotlib.patheffects import withStroke

    axes.annotate(
        text,
        xy=(float(place[0]), float(place[1])),
        xytext=(5, 5),
        textcoords="offset points",
        fontsize=9,
        fontweight="bold",
        color=colour,
        path_effects=[withStroke(linewidth=2.5, foreground="white")],
        annotation_clip=True,
        zorder=7,
    )
