"""What the bearing tracks and lines of one station say of each target: checked, in ``map``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.tma.targets.line_attribution import VAGUEST
from sonar_tracking.tma.targets.station_view import StationView
from sonar_tracking.tma.targets.target_records import MAXIMUM_LINES, TargetObservation
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

HIGHEST, SHARPEST = 1e7, 1e-9
"""Highest frequency of a line, Hz, and its least relative deviation: no clock is better."""


@dataclass(frozen=True)
class UsableLine:
    """One line that can be used.

    Attributes
    ----------
    line_id : int
        Its identity.
    frequency, deviation : float
        Hz.
    """

    line_id: int
    frequency: float
    deviation: float


class Directions(NamedTuple):
    """In which directions a station hears a target.

    Attributes
    ----------
    azimuths : tuple of float
        As in :class:`TargetObservation`, rad.
    azimuth_variance, elevation, elevation_variance : float
        rad^2, rad, rad^2; NaN = none.
    """

    azimuths: tuple[float, ...]
    azimuth_variance: float
    elevation: float
    elevation_variance: float


NOWHERE = Directions((), math.nan, math.nan, math.nan)
"""Not heard."""


def bare_observation(
    stamp: int,
    view: StationView,
    configuration: TmaTrackerConfiguration,
    directions: Directions = NOWHERE,
) -> TargetObservation:
    """Return an observation without lines, from a station.

    Parameters
    ----------
    stamp : int
        ns.
    view : StationView
        Where the station is.
    configuration : TmaTrackerConfiguration
        What is known of the height of targets and of sound.
    directions : Directions
        In which the target was heard; by default in none.
    """
    return TargetObservation(
        stamp=stamp,
        sensor_id=view.sensor_id,
        position=view.position,
        velocity=view.velocity,
        azimuths=directions.azimuths,
        azimuth_variance=directions.azimuth_variance,
        elevation=directions.elevation,
        elevation_variance=directions.elevation_variance,
        height=configuration.target_height,
        height_deviation=configuration.height_deviation,
        sensor_z=view.z,
        sound_speed=configuration.sound_speed,
        propagation_speed=configuration.propagation_speed,
    )


def observation_of(
    bearings: BearingTracks,
    row: int,
    view: StationView,
    configuration: TmaTrackerConfiguration,
) -> tuple[TargetObservation, str]:
    """Return what a row of a list of bearing tracks says, and what is wrong with it.

    Parameters
    ----------
    bearings : BearingTracks
        The list.
    row : int
        Which track.
    view : StationView
        Where its station is.
    configuration : TmaTrackerConfiguration
        Floors and defaults.

    Returns
    -------
    observation : TargetObservation
        Without azimuths if there is no measurement, or none that can be used.
    problem : str
        Why a measurement cannot be used; empty = nothing is wrong.
    """
    angle, variance = float(bearings.measurement[row]), float(bearings.measurement_variance[row])
    if math.isnan(variance) and configuration.azimuth_deviation > 0.0:
        variance = configuration.azimuth_deviation**2
    problem = _problem_of(bearings, row, angle, variance)
    if problem or not math.isfinite(angle):
        return bare_observation(bearings.stamp, view, configuration), problem
    variance = max(variance, configuration.minimum_azimuth_deviation**2)
    variance += (view.turn_rate * configuration.array_lag) ** 2
    azimuths = view.azimuths(angle, bearings.angle_kind, bool(bearings.ambiguous[row]))
    directions = Directions(azimuths, variance, *_elevation(bearings, row))
    return bare_observation(bearings.stamp, view, configuration, directions), ""


def _problem_of(bearings: BearingTracks, row: int, angle: float, variance: float) -> str:
    """Return why a measurement, rad and rad^2, cannot be used; empty = it can, or there is none."""
    name = f"track {int(bearings.id[row])}"
    if not math.isfinite(angle):
        lost = bearings.status[row] == TrackStatus.CONFIRMED and math.isinf(angle)
        return f"{name} has the angle {angle}" if lost else ""
    if abs(angle) > 2.0 * math.pi:
        return f"{name} has the angle {angle:g} rad, more than a full turn"
    if not 0.0 < variance < VAGUEST:
        allowed = f"which must be positive and below {VAGUEST:g}"
        return f"{name} has the variance {variance:g} rad^2, {allowed}"
    return ""


def lines_of(lines: FrequencyLines, tracks: list[int]) -> tuple[dict[int, list[UsableLine]], str]:
    """Return the usable lines of each track, and what is wrong with the others.

    Parameters
    ----------
    lines : FrequencyLines
        All lines of a station.
    tracks : list of int
        Bearing track of each line; 0 = none.

    Returns
    -------
    heard : dict of int to list of UsableLine
        At most :data:`MAXIMUM_LINES` a track, the best ones.
    problem : str
        Why lines were left out; empty = nothing is wrong.
    """
    heard: dict[int, dict[int, UsableLine]] = {}
    bad, repeated = [], []
    columns = (lines.line_id, lines.frequency, lines.standard_deviation)
    for track, (number, frequency, deviation) in zip(
        tracks, zip(*columns, strict=True), strict=True
    ):
        line = UsableLine(int(number), float(frequency), float(deviation))
        if not _plausible(line):
            bad.append(line.line_id)
        elif track and line.line_id in heard.setdefault(track, {}):
            repeated.append(line.line_id)
        elif track:
            heard[track][line.line_id] = line
    problems = []
    if bad:
        problems.append(f"line {bad[0]} has an impossible frequency or standard deviation")
    if repeated:
        problems.append(f"line {repeated[0]} appears twice")
    best = {track: _best(list(own.values())) for track, own in heard.items()}
    return best, " and ".join(problems)


def _best(lines: list[UsableLine]) -> list[UsableLine]:
    """Return the lines that tell most of the motion, in their order."""
    if len(lines) <= MAXIMUM_LINES:
        return lines
    worst = sorted(line.deviation / line.frequency for line in lines)[MAXIMUM_LINES - 1]
    return [line for line in lines if line.deviation / line.frequency <= worst][:MAXIMUM_LINES]


def with_lines(observation: TargetObservation, lines: list[UsableLine]) -> TargetObservation:
    """Return an observation with the lines heard beside it."""
    return replace(
        observation,
        line_ids=tuple(line.line_id for line in lines),
        frequencies=tuple(line.frequency for line in lines),
        frequency_deviations=tuple(line.deviation for line in lines),
    )


def left_out(sensor_id: str, what: str) -> Notice:
    """Return the notice that something of a station was left out."""
    return Notice(
        Severity.WARN,
        f"data of {sensor_id}",
        f"{shown(sensor_id)}: {what}; it was left out, check the sender.",
    )


def _elevation(bearings: BearingTracks, row: int) -> tuple[float, float]:
    if not (bearings.elevation.size and bearings.elevation_variance.size):
        return np.nan, np.nan
    value, variance = float(bearings.elevation[row]), float(bearings.elevation_variance[row])
    usable = math.isfinite(value) and _positive(variance)
    return (value, variance) if usable else (np.nan, np.nan)


def _plausible(line: UsableLine) -> bool:
    if not (0.0 < line.frequency <= HIGHEST):
        return False
    return SHARPEST * line.frequency < line.deviation < line.frequency


def _positive(value: float) -> bool:
    return math.isfinite(value) and value > 0.0
