"""Rows of other lists that are shown as they are."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict
from sonar_tracking.fusion.fused_rows import FusedRow, row_of_copy
from sonar_tracking.fusion.fused_target import CopiedRow
from sonar_tracking.fusion.fusion_records import BearingKey
from sonar_tracking.fusion.rotation import rotated
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource
from sonar_tracking.records.time import seconds

DRIFT = 1e-4
"""Density of the white acceleration between two lists, m^2/s^3."""


def copied_row(tracks: PositionTracks, row: int, topic: str, number: int) -> CopiedRow:
    """Return one row of a list as it is to be shown.

    Parameters
    ----------
    tracks : PositionTracks
        The list.
    row : int
        Which.
    topic : str
        Where the list comes from.
    number : int
        Identifier in the fused list.
    """
    return CopiedRow(
        id=number,
        key=(topic, int(tracks.id[row])),
        source=TrackSource(tracks.source[row]),
        status=TrackStatus(tracks.status[row]),
        state=tracks.state[row],
        covariance=tracks.covariance[row],
        stamp=tracks.stamp,
        existence=float(tracks.existence_probability[row]),
        initiated=float(tracks.initiated[row]),
        updated=float(tracks.updated[row]),
        observability=float(tracks.observability[row]),
        z=float(tracks.z[row]),
        z_standard_deviation=float(tracks.z_standard_deviation[row]),
        hypothesis=TrackHypothesis(tracks.hypothesis[row]),
        hypothesis_probability=float(tracks.hypothesis_probability[row]),
        heard=bearing_keys(tracks, row),
    )


def moved_copy(
    copy: CopiedRow,
    stamp: int,
    stations: Mapping[str, FloatArray],
    alignments: Mapping[str, tuple[float, float]],
) -> FusedRow:
    """Return the row of a copy at a stamp, its array being aligned as others tell.

    Parameters
    ----------
    copy : CopiedRow
        What its list tells.
    stamp : int
        Not before that of its list, ns.
    stations : mapping of str to ndarray, shape (2,)
        Where each array is, m.
    alignments : mapping of str to tuple of two float
        The misalignment of those of which it has been measured, rad, and its variance, rad^2.
    """
    interval = seconds(stamp - copy.stamp)
    state = moved_state(KalmanState(copy.state, copy.covariance), interval)
    for sensor in {key[0] for key in copy.heard}:
        if sensor in alignments and len(copy.heard) == 1:
            state = rotated(state, stations[sensor], *alignments[sensor])
    return row_of_copy(copy, state.mean, state.covariance)


def moved_state(state: KalmanState, interval: float) -> KalmanState:
    """Return a target an interval (s) after its list: on its course, as far as the sea lets it."""
    if interval > 0.0:
        transition = np.asarray(np.kron(transition_matrix(interval), np.eye(2)))
        noise = np.asarray(np.kron(process_noise_matrix(DRIFT, interval), np.eye(2)))
        return predict(state, transition, noise)
    return state


def bearing_keys(tracks: PositionTracks, row: int) -> tuple[BearingKey, ...]:
    """Return the bearing tracks that a row of a list is made of."""
    own = np.flatnonzero(tracks.contributor_track == row)
    return tuple(
        (tracks.contributor_sensor[one], int(tracks.contributor_id[one]))
        for one in own
        if tracks.contributor_source[one] == TrackSource.TMA
    )
