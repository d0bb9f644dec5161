"""What every sensor has heard of every target, kept for the stacked dots."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sonar_tracking.display.page.stacked_dots import Hearing
from sonar_tracking.records.arrays import FloatArray, IdArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.tma.targets.station_view import StationView

KEPT = 2000
"""Lists kept of one sensor, the newest."""

MOST_LINES = 4
"""Lines of a bearing track that are looked at where nobody tells which."""


@dataclass(frozen=True)
class _Instant:
    """What one sensor heard at one instant; a row a bearing track, or a line."""

    stamp: int
    pose: tuple[float, float, float, float, float]
    track_id: IdArray
    line_id: IdArray
    value: FloatArray
    deviation: FloatArray


class HearingLog:
    """Keeps bearings and lines by sensor."""

    def __init__(self) -> None:
        self._bearings: dict[str, deque[_Instant]] = {}
        self._lines: dict[str, deque[_Instant]] = {}
        self._cone: dict[str, bool] = {}

    def add_bearings(self, tracks: BearingTracks, view: StationView) -> None:
        """Take a list of bearing tracks, and where their sensor was.

        What was measured counts; where that is not reported, the filtered angle.
        """
        cone = tracks.angle_kind == AngleKind.CONE
        measured = np.isfinite(tracks.measurement) & np.isfinite(tracks.measurement_variance)
        value = np.where(measured, tracks.measurement, tracks.arrival_angle)
        variance = np.where(measured, tracks.measurement_variance, tracks.covariance[:, 0, 0])
        # Bearings that are only carried on measure nothing.
        value = np.where(measured.any() & ~measured, np.nan, value)
        self._cone[view.sensor_id] = cone
        axis = 0.0 if not cone and view.frame_id == "map" else view.axis
        none = np.zeros(len(value), np.uint64)
        deviation = np.sqrt(np.maximum(variance, 0.0))
        instant = _Instant(tracks.stamp, _pose(view, axis), tracks.id, none, value, deviation)
        _append(self._bearings, view.sensor_id, instant)

    def add_lines(self, lines: FrequencyLines, view: StationView) -> None:
        """Take a list of lines, and where their sensor was."""
        pose = _pose(view, view.axis)
        instant = _Instant(
            lines.stamp,
            pose,
            lines.track_id,
            lines.line_id,
            lines.frequency,
            lines.standard_deviation,
        )
        _append(self._lines, view.sensor_id, instant)

    def sensors_of(self, track_id: int) -> list[str]:
        """Return the sensors whose newest list has a bearing track of an identifier."""
        return [
            name
            for name, instants in self._bearings.items()
            if instants and np.any(instants[-1].track_id == track_id)
        ]

    def lines_of(self, sensor_id: str, track_id: int) -> list[int]:
        """Return the lines heard of a bearing track, those heard most often first."""
        counts: Counter[int] = Counter()
        for instant in self._lines.get(sensor_id, ()):
            counts.update(instant.line_id[instant.track_id == track_id].tolist())
        return [line_id for line_id, _ in counts.most_common(MOST_LINES)]

    def bearings(self, sensor_id: str, track_id: int) -> Hearing | None:
        """Return what a sensor has heard of one of its bearing tracks; None = nothing."""
        return self._hearing(self._bearings.get(sensor_id, ()), track_id, 0, sensor_id)

    def line(self, sensor_id: str, track_id: int, line_id: int) -> Hearing | None:
        """Return how a sensor has heard one line of one of its bearing tracks; None = never."""
        return self._hearing(self._lines.get(sensor_id, ()), track_id, line_id, sensor_id)

    def _hearing(
        self, instants: Iterable[_Instant], track_id: int, line_id: int, sensor_id: str
    ) -> Hearing | None:
        stamps, rows = [], []
        for instant in instants:
            found = (instant.track_id == track_id) & (instant.line_id == line_id)
            for row in np.flatnonzero(found & np.isfinite(instant.value))[:1]:
                stamps.append(instant.stamp)
                rows.append((*instant.pose, instant.value[row], instant.deviation[row]))
        if not rows:
            return None
        table = np.array(rows)
        return Hearing(
            stamps=np.array(stamps, np.int64),
            position=table[:, 0:2],
            velocity=table[:, 2:4],
            axis_azimuth=table[:, 4],
            value=table[:, 5],
            deviation=table[:, 6],
            cone=self._cone.get(sensor_id, True),
        )


def _pose(view: StationView, axis: float) -> tuple[float, float, float, float, float]:
    return (*view.position, *view.velocity, axis)


def _append(logs: dict[str, deque[_Instant]], sensor_id: str, instant: _Instant) -> None:
    log = logs.setdefault(sensor_id, deque(maxlen=KEPT))
    if not log or log[-1].stamp < instant.stamp:
        log.append(instant)
