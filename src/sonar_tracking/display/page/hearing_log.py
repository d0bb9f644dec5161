"""What every sensor has heard of every target, kept for the stacked dots."""

from __future__ import annotations

from array import array
from collections.abc import Iterator

import numpy as np

from sonar_tracking.display.page.stacked_dots import Hearing
from sonar_tracking.records.arrays import FloatArray, IdArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.tma.targets.station_view import StationView

KEPT = 2000
"""Measurements kept of one target by one sensor, at least, the newest."""

MOST_ROWS = 300_000
"""Measurements kept of all targets; of more, targets are forgotten that were heard longest ago."""

MOST_LINES = 4
"""Lines of a bearing track that are looked at where nobody tells which."""

_COLUMNS = 7
"""Position, velocity and axis of the sensor, value and deviation."""

Target = tuple[str, int, int]
"""Sensor, bearing track, and line; line 0 = its bearings."""


class _Heard:
    """What one sensor measured of one target, a row an instant, in little memory."""

    def __init__(self) -> None:
        self.stamps = array("q")
        self._rows = array("d")

    def add(self, stamp: int, row: tuple[float, ...]) -> int:
        """Add a row; return by how many there are more now."""
        before = len(self.stamps)
        self.stamps.append(stamp)
        self._rows.extend(row)
        if len(self.stamps) > 2 * KEPT:
            del self.stamps[:KEPT], self._rows[: KEPT * _COLUMNS]
        return len(self.stamps) - before

    def hearing(self, cone: bool) -> Hearing:
        """Return the rows as columns."""
        table = np.array(self._rows).reshape(-1, _COLUMNS)
        return Hearing(
            stamps=np.array(self.stamps, np.int64),
            position=table[:, 0:2],
            velocity=table[:, 2:4],
            axis_azimuth=table[:, 4],
            value=table[:, 5],
            deviation=table[:, 6],
            cone=cone,
        )


class HearingLog:
    """Keeps bearings and lines by sensor and target."""

    def __init__(self) -> None:
        self._heard: dict[Target, _Heard] = {}
        self._lines: dict[tuple[str, int], set[int]] = {}
        self._newest: dict[str, IdArray] = {}
        self._last: dict[tuple[str, bool], int] = {}
        self._cone: dict[str, bool] = {}
        self._n_rows = 0

    def add_bearings(self, tracks: BearingTracks, view: StationView) -> None:
        """Take a list of bearing tracks, and where their sensor was.

        What was measured counts; where that is not reported, the filtered angle.
        """
        if not self._is_news(view.sensor_id, False, tracks.stamp):
            return
        cone = tracks.angle_kind == AngleKind.CONE
        measured = np.isfinite(tracks.measurement) & np.isfinite(tracks.measurement_variance)
        value = np.where(measured, tracks.measurement, tracks.arrival_angle)
        variance = np.where(measured, tracks.measurement_variance, tracks.covariance[:, 0, 0])
        # Bearings that are only carried on measure nothing.
        value = np.where(measured.any() & ~measured, np.nan, value)
        self._cone[view.sensor_id] = cone
        self._newest[view.sensor_id] = tracks.id
        axis = 0.0 if not cone and view.frame_id == "map" else view.axis
        lines = np.zeros(len(value), np.uint64)
        deviation = np.sqrt(np.maximum(variance, 0.0))
        self._add(view, axis, tracks.stamp, _rows(tracks.id, lines, value, deviation))

    def add_lines(self, lines: FrequencyLines, view: StationView) -> None:
        """Take a list of lines, and where their sensor was."""
        if not self._is_news(view.sensor_id, True, lines.stamp):
            return
        for track_id, line_id in zip(lines.track_id.tolist(), lines.line_id.tolist(), strict=True):
            self._lines.setdefault((view.sensor_id, track_id), set()).add(line_id)
        rows = _rows(lines.track_id, lines.line_id, lines.frequency, lines.standard_deviation)
        self._add(view, view.axis, lines.stamp, rows)

    def sensors_of(self, track_id: int) -> list[str]:
        """Return the sensors whose newest list has a bearing track of an identifier."""
        return [name for name, tracks in self._newest.items() if np.any(tracks == track_id)]

    def lines_of(self, sensor_id: str, track_id: int) -> list[int]:
        """Return the lines heard of a bearing track, those heard most often first."""
        counts = {
            line_id: len(self._heard[sensor_id, track_id, line_id].stamps)
            for line_id in self._lines.get((sensor_id, track_id), ())
            if (sensor_id, track_id, line_id) in self._heard
        }
        return sorted(counts, key=lambda line_id: (-counts[line_id], line_id))[:MOST_LINES]

    def bearings(self, sensor_id: str, track_id: int) -> Hearing | None:
        """Return what a sensor has heard of one of its bearing tracks; None = nothing."""
        return self.line(sensor_id, track_id, 0)

    def line(self, sensor_id: str, track_id: int, line_id: int) -> Hearing | None:
        """Return how a sensor has heard one line of one of its bearing tracks; None = never."""
        heard = self._heard.get((sensor_id, track_id, line_id))
        return None if heard is None else heard.hearing(self._cone.get(sensor_id, True))

    def _is_news(self, sensor_id: str, lines: bool, stamp: int) -> bool:
        """Return whether a list is later than those before it, and remember it."""
        last = self._last.get((sensor_id, lines))
        if last is not None and stamp <= last:
            return False
        self._last[sensor_id, lines] = stamp
        return True

    def _add(
        self,
        view: StationView,
        axis: float,
        stamp: int,
        rows: Iterator[tuple[int, int, float, float]],
    ) -> None:
        pose = (*view.position, *view.velocity, axis)
        for track_id, line_id, value, deviation in rows:
            heard = self._heard.setdefault((view.sensor_id, track_id, line_id), _Heard())
            self._n_rows += heard.add(stamp, (*pose, value, deviation))
        while self._n_rows > MOST_ROWS:
            self._forget(min(self._heard, key=lambda target: self._heard[target].stamps[-1]))

    def _forget(self, target: Target) -> None:
        self._n_rows -= len(self._heard.pop(target).stamps)
        sensor_id, track_id, line_id = target
        lines = self._lines.get((sensor_id, track_id), set())
        lines.discard(line_id)
        if not lines:
            self._lines.pop((sensor_id, track_id), None)


def _rows(
    track_id: IdArray, line_id: IdArray, value: FloatArray, deviation: FloatArray
) -> Iterator[tuple[int, int, float, float]]:
    """Yield the rows that measure something, the first of each target."""
    seen: set[tuple[int, int]] = set()
    columns = (track_id.tolist(), line_id.tolist(), value.tolist(), deviation.tolist())
    known = np.isfinite(value).tolist()
    for is_known, track, line, measured, spread in zip(known, *columns, strict=True):
        if is_known and (track, line) not in seen:
            seen.add((track, line))
            yield track, line, measured, spread
