"""Stacked dots of one track of a list: bearings and lines of all its sensors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sonar_tracking.display.page.hearing_log import HearingLog
from sonar_tracking.display.page.stacked_dots import (
    DotStack,
    Hearing,
    bearing_dots,
    frequency_dots,
)
from sonar_tracking.records.positions import PositionTracks, TrackSource

FEWEST = 2
"""A stack of fewer dots tells nothing."""


def solution_dots(tracks: PositionTracks, row: int, log: HearingLog) -> tuple[DotStack, ...]:
    """Return the stacks of a track: one a sensor of its bearings, then one a line.

    What was heard later than the list is left out: nobody knew it then.

    Parameters
    ----------
    tracks : PositionTracks
        The list.
    row : int
        Which of its tracks.
    log : HearingLog
        What was heard.
    """
    state = tracks.state[row]
    if not np.isfinite(state).all():
        return ()
    stacks = []
    for sensor_id, track_id in _heard_by(tracks, row, log):
        heard = _until(tracks.stamp, log.bearings(sensor_id, track_id))
        if heard is not None:
            label = f"{sensor_id} {track_id}"
            stacks.append(bearing_dots(state, tracks.stamp, heard, label))
    stacks += _line_stacks(tracks, row, log)
    return tuple(stack for stack in stacks if len(stack.stamps) >= FEWEST)


def _heard_by(tracks: PositionTracks, row: int, log: HearingLog) -> list[tuple[str, int]]:
    """Return sensor and bearing track of everything the track was heard by.

    A list without contributors names one bearing track, of the first sensor that has it.
    """
    named = [
        (tracks.contributor_sensor[index], int(tracks.contributor_id[index]))
        for index in np.flatnonzero(tracks.contributor_track == row)
        if tracks.contributor_source[index] == TrackSource.TMA
    ]
    track_id = int(tracks.bearing_track_id[row])
    if named or not track_id:
        return named
    return [(sensor_id, track_id) for sensor_id in log.sensors_of(track_id)[:1]]


def _line_stacks(tracks: PositionTracks, row: int, log: HearingLog) -> Iterator[DotStack]:
    """Yield the stacks of the lines the track names; of those it was heard by, if it names none."""
    heard_by = _heard_by(tracks, row, log)
    named = [
        (sensor_id, track_id, int(tracks.line_id[index]), float(tracks.line_frequency[index]))
        for index in np.flatnonzero(tracks.line_track == row)
        for sensor_id, track_id in heard_by
    ]
    lines = named or [
        (sensor_id, track_id, line_id, np.nan)
        for sensor_id, track_id in heard_by
        for line_id in log.lines_of(sensor_id, track_id)
    ]
    for sensor_id, track_id, line_id, frequency in lines:
        heard = _until(tracks.stamp, log.line(sensor_id, track_id, line_id))
        if heard is not None:
            stack = frequency_dots(tracks.state[row], tracks.stamp, frequency, heard, "")
            label = f"{sensor_id} {stack.frequency:.1f} Hz"
            yield replace(stack, label=label)


def _until(stamp: int, heard: Hearing | None) -> Hearing | None:
    """Return what was heard up to a stamp, ns; None = nothing."""
    if heard is None or heard.stamps[-1] <= stamp:
        return heard
    count = int(np.searchsorted(heard.stamps, stamp, side="right"))
    rows = ("stamps", "position", "velocity", "axis_azimuth", "value", "deviation")
    kept = {name: getattr(heard, name)[:count] for name in rows}
    return replace(heard, **kept) if count else None
