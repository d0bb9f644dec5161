"""Which bearing track a line belongs to that came without one: by its angle, over time.

The log likelihood of the angles of a line is summed for every bearing track of its station, the
past fading. A line goes to the track that explains it best, if its newest angle lies within the
gate and no other track explains the line nearly as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.lines import NOT_ATTRIBUTED, FrequencyLines
from sonar_tracking.records.time import NANOSECONDS

FADING = 0.9
"""Weight of the past against a new frame."""

FRAMES = 10
"""So many frames the past stands for, once there are as many."""

MARGIN = float(np.log(20.0))
"""By which the best track must lead the next one."""

VAGUEST = 10.0
"""Variance of an angle that says nothing any more, rad^2."""

FORGOTTEN_AFTER = 600 * NANOSECONDS
"""A line not heard for this long is forgotten, ns."""


@dataclass(frozen=True)
class TrackAngle:
    """Where a bearing track is.

    Attributes
    ----------
    angle, variance : float
        From broadside, rad and rad^2.
    """

    angle: float
    variance: float


@dataclass(frozen=True)
class _Record:
    """What is remembered of a line: mean log likelihood of each track, frames, last stamp."""

    scores: dict[int, float]
    frames: int
    stamp: int


class LineAttribution:
    """Remembers what each line of each station looked like.

    Parameters
    ----------
    gate : float
        Standard deviations.
    """

    def __init__(self, gate: float) -> None:
        self._gate = gate
        self._records: dict[tuple[str, int], _Record] = {}

    def update(self, lines: FrequencyLines, tracks: Mapping[int, TrackAngle]) -> list[int]:
        """Return the bearing track of each line; 0 = none.

        Parameters
        ----------
        lines : FrequencyLines
            Of one station; what names its track keeps it.
        tracks : mapping of int to TrackAngle
            The bearing tracks of that station now.
        """
        sensor = lines.sensor.sensor_id
        chosen = []
        columns = (lines.track_id, lines.line_id, lines.arrival_angle, lines.arrival_angle_variance)
        for track, line, angle, variance in zip(*columns, strict=True):
            if int(track) != NOT_ATTRIBUTED:
                chosen.append(int(track))
                continue
            key = (sensor, int(line))
            distances = _distances(float(angle), float(variance), tracks)
            before = self._records.get(key, _Record({}, 0, 0))
            scores = self._extend_scores(before.scores, distances)
            self._records[key] = _Record(scores, min(before.frames + 1, FRAMES), lines.stamp)
            chosen.append(self._best(self._records[key], distances))
        oldest = lines.stamp - FORGOTTEN_AFTER
        self._records = {key: one for key, one in self._records.items() if one.stamp >= oldest}
        return chosen

    def _extend_scores(
        self, before: Mapping[int, float], distances: Mapping[int, tuple[float, float]]
    ) -> dict[int, float]:
        scores = {}
        for track, (squared, spread) in distances.items():
            fit = -0.5 * (min(squared, self._gate**2 + 10.0) + np.log(2.0 * np.pi * spread))
            scores[track] = FADING * before.get(track, fit) + (1.0 - FADING) * fit
        return scores

    def _best(self, record: _Record, distances: Mapping[int, tuple[float, float]]) -> int:
        order = sorted(record.scores, key=lambda track: (-record.scores[track], track))
        if not order or distances[order[0]][0] > self._gate**2:
            return NOT_ATTRIBUTED
        if len(order) > 1:
            lead = record.scores[order[0]] - record.scores[order[1]]
            if record.frames * lead < MARGIN:
                return NOT_ATTRIBUTED
        return order[0]


def _distances(
    angle: float, variance: float, tracks: Mapping[int, TrackAngle]
) -> dict[int, tuple[float, float]]:
    """Return squared normalised distance and variance of the difference, to each track."""
    if not (abs(angle) <= 2.0 * np.pi and 0.0 < variance < VAGUEST):
        return {}
    spreads = {number: track.variance + variance for number, track in tracks.items()}
    return {
        number: ((angle - track.angle) ** 2 / spreads[number], spreads[number])
        for number, track in tracks.items()
    }
