"""Bearings of a sensor with their tracks known become its complete pictures, look by look."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict, update
from sonar_tracking.motion import wrapped
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.time import END_OF_DATA, seconds

RATE_DEVIATION = np.radians(0.5)
RATE_NOISE = np.radians(0.02) ** 2
"""Of the bearing rate, as in the association: rad/s and rad^2/s^3."""

SAME_LINE = 0.01
"""A line that differs from one heard before by less than this share is that line."""


@dataclass(frozen=True)
class SensorBearings:
    """Bearings of one sensor, in order of time.

    Attributes
    ----------
    stamp : ndarray of int, shape (n,)
        ns.
    number : ndarray of int, shape (n,)
        Track of each, from 1; 0 = of none. At one stamp each track has one bearing.
    angle, deviation, elevation, elevation_deviation : ndarray, shape (n,)
        rad; elevations may be NaN.
    frequencies : tuple of tuple
        Lines heard with each bearing: frequency and its standard deviation, Hz.
    kind : AngleKind
        What the angles are.
    """

    stamp: IntArray
    number: IntArray
    angle: FloatArray
    deviation: FloatArray
    elevation: FloatArray
    elevation_deviation: FloatArray
    frequencies: tuple[tuple[tuple[float, float], ...], ...]
    kind: AngleKind


@dataclass
class _Followed:
    state: KalmanState
    stamp: int
    last: int


def bearing_pictures(
    bearings: SensorBearings, sensor_at: Callable[[int], Sensor]
) -> Iterator[tuple[BearingTracks, FrequencyLines | None]]:
    """Yield the bearing tracks of each look, and the lines heard in it.

    A track is there from its first to its last bearing, coasted where it has none.

    Parameters
    ----------
    bearings : SensorBearings
        Of one sensor.
    sensor_at : callable
        Returns the sensor at a stamp, ns.
    """
    looks = np.split(np.arange(len(bearings.stamp)), np.flatnonzero(np.diff(bearings.stamp)) + 1)
    stamps = [int(bearings.stamp[rows[0]]) for rows in looks]
    last = {int(number): int(row) for row, number in enumerate(bearings.number) if number}
    followed: dict[int, _Followed] = {}
    known_lines: dict[int, list[tuple[int, float]]] = {}
    for rows, stamp, following in zip(looks, stamps, [*stamps[1:], END_OF_DATA], strict=True):
        heard = {int(bearings.number[row]): int(row) for row in rows if bearings.number[row]}
        innovations = {n: _follow(followed, n, row, bearings, last) for n, row in heard.items()}
        sensor = sensor_at(stamp)
        picture = _picture(bearings, stamp, followed, heard, innovations)
        yield (
            BearingTracks(stamp=stamp, next_stamp=following, sensor=sensor, **picture),
            _lines(bearings, heard, known_lines, (stamp, following), sensor),
        )
        for number in [n for n, each in followed.items() if bearings.stamp[each.last] <= stamp]:
            del followed[number]


def _follow(
    followed: dict[int, _Followed],
    number: int,
    row: int,
    bearings: SensorBearings,
    last: dict[int, int],
) -> float:
    """Take a bearing into its track; return the innovation, rad, NaN for the first one."""
    angle, variance = bearings.angle[row], bearings.deviation[row] ** 2
    stamp = int(bearings.stamp[row])
    if number not in followed:
        state = KalmanState(np.array([angle, 0.0]), np.diag([variance, RATE_DEVIATION**2]))
        followed[number] = _Followed(state, stamp, last[number])
        return float("nan")
    track = followed[number]
    ahead = _predicted(track, stamp)
    near = ahead.mean[0] + wrapped(angle - ahead.mean[0])
    noise = np.array([[variance]])
    done = update(ahead, np.array([near]), np.array([[1.0, 0.0]]), noise)
    track.state, track.stamp = done.state, stamp
    return float(done.innovation[0])


def _predicted(track: _Followed, stamp: int) -> KalmanState:
    interval = seconds(stamp - track.stamp)
    noise = process_noise_matrix(RATE_NOISE, interval)
    return predict(track.state, transition_matrix(interval), noise)


def _picture(
    bearings: SensorBearings,
    stamp: int,
    followed: dict[int, _Followed],
    heard: dict[int, int],
    innovations: dict[int, float],
) -> dict[str, Any]:
    """Return the columns of the bearing tracks."""
    numbers = sorted(followed)
    rows = [heard.get(number) for number in numbers]
    unknown = np.full(len(numbers), np.nan)

    def of_heard(values: FloatArray) -> FloatArray:
        return np.array([np.nan if row is None else values[row] for row in rows])

    elevations = bool(np.isfinite(bearings.elevation).any())
    states = [_predicted(followed[number], stamp) for number in numbers]
    told = of_heard(bearings.elevation) if elevations else np.empty(0)
    return {
        "id": np.array(numbers, np.uint64),
        "status": np.array(
            [TrackStatus.COASTED if row is None else TrackStatus.CONFIRMED for row in rows],
            np.uint8,
        ),
        "arrival_angle": np.array([wrapped(state.mean[0]) for state in states]),
        "arrival_angle_rate": np.array([state.mean[1] for state in states]),
        "covariance": np.array([state.covariance for state in states]).reshape(-1, 2, 2),
        "measurement": of_heard(bearings.angle),
        "measurement_variance": of_heard(bearings.deviation) ** 2,
        "innovation": np.array([innovations.get(number, np.nan) for number in numbers]),
        "signal_to_noise_ratio": unknown,
        "existence_probability": unknown,
        "ambiguous": np.full(len(numbers), bearings.kind is AngleKind.CONE),
        "angle_kind": bearings.kind,
        "elevation": told,
        "elevation_variance": of_heard(bearings.elevation_deviation) ** 2 if elevations else told,
    }


def _lines(
    bearings: SensorBearings,
    heard: dict[int, int],
    known: dict[int, list[tuple[int, float]]],
    stamps: tuple[int, int],
    sensor: Sensor,
) -> FrequencyLines | None:
    """Return the lines of the tracks heard, each with the identity it had before."""
    if not any(bearings.frequencies):
        return None
    entries = [
        (number, _line_identity(known, number, frequency), frequency, deviation)
        for number, row in heard.items()
        for frequency, deviation in bearings.frequencies[row]
    ]
    unknown = np.full(len(entries), np.nan)
    return FrequencyLines(
        stamp=stamps[0],
        track_id=np.array([entry[0] for entry in entries], np.uint64),
        arrival_angle=unknown,
        arrival_angle_variance=unknown,
        line_id=np.array([entry[1] for entry in entries], np.uint64),
        frequency=np.array([entry[2] for entry in entries]),
        standard_deviation=np.array([entry[3] for entry in entries]),
        signal_to_noise_ratio=unknown,
        integration_time=unknown,
        next_stamp=stamps[1],
        sensor=sensor,
    )


def _line_identity(known: dict[int, list[tuple[int, float]]], number: int, frequency: float) -> int:
    lines = known.setdefault(number, [])
    for index, (identity, before) in enumerate(lines):
        if abs(frequency / before - 1.0) < SAME_LINE:
            lines[index] = (identity, frequency)
            return identity
    identity = 1 + sum(len(each) for each in known.values())
    lines.append((identity, frequency))
    return identity
