"""Rows of other lists that are shown as they are."""

from __future__ import annotations

from collections.abc import Mapping

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.filtering.constant_velocity import (
    in_plane,
    process_noise_matrix,
    transition_matrix,
)
from sonar_tracking.filtering.kalman import KalmanState, predict
from sonar_tracking.fusion.fused_rows import FusedRow
from sonar_tracking.fusion.fusion_records import ListKey
from sonar_tracking.fusion.rotation import rotated
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource
from sonar_tracking.records.time import seconds

DRIFT = 1e-4
"""Density of the white acceleration between two lists, m^2/s^3."""


def copied_row(
    tracks: PositionTracks,
    row: int,
    heard: tuple[BearingKey, ...],
    key: ListKey,
    number: int,
    stamp: int,
    stations: Mapping[str, FloatArray],
    alignments: Mapping[str, tuple[float, float]],
) -> FusedRow:
    """Return one row of a list as it is to be shown, its array being aligned as others tell.

    Parameters
    ----------
    tracks : PositionTracks
        The list.
    row : int
        Which.
    heard : tuple of BearingKey
        The bearing tracks it is made of.
    key : ListKey
        Where the list comes from, and the identifier there.
    number : int
        Identifier in the fused list.
    stamp : int
        Of the fused list, not before that of the list, ns.
    stations : mapping of str to ndarray, shape (2,)
        Where each array is, m.
    alignments : mapping of str to tuple of two float
        The misalignment of those of which it has been measured, rad, and its variance, rad^2.
    """
    source = TrackSource(tracks.source[row])
    told = KalmanState(tracks.state[row], tracks.covariance[row])
    state = moved_state(told, seconds(stamp - tracks.stamp))
    if len(heard) == 1 and heard[0][0] in alignments:
        sensor = heard[0][0]
        state = rotated(state, stations[sensor], *alignments[sensor])
    made_of = tuple((TrackSource.TMA, *one) for one in heard)
    return FusedRow(
        id=number,
        status=TrackStatus(tracks.status[row]),
        source=TrackSource.STATIC if source == TrackSource.STATIC else TrackSource.FUSED,
        state=state.mean,
        covariance=state.covariance,
        existence=float(tracks.existence_probability[row]),
        initiated=float(tracks.initiated[row]),
        updated=float(tracks.updated[row]),
        observability=float(tracks.observability[row]),
        z=float(tracks.z[row]),
        z_standard_deviation=float(tracks.z_standard_deviation[row]),
        hypothesis=TrackHypothesis(tracks.hypothesis[row]),
        hypothesis_probability=float(tracks.hypothesis_probability[row]),
        bearing_track_id=heard[0][1] if heard else 0,
        contributors=made_of or ((source, *key),),
    )


def moved_state(state: KalmanState, interval: float) -> KalmanState:
    """Return a target an interval (s) after its list: on its course, as far as the sea lets it."""
    if interval > 0.0:
        noise = in_plane(process_noise_matrix(DRIFT, interval))
        return predict(state, in_plane(transition_matrix(interval)), noise)
    return state


def bearing_keys(tracks: PositionTracks) -> list[tuple[BearingKey, ...]]:
    """Return the bearing tracks that each row of a list is made of."""
    keys: list[tuple[BearingKey, ...]] = [()] * len(tracks.id)
    columns = tracks.contributor_track, tracks.contributor_source, tracks.contributor_id
    told = zip(*(one.tolist() for one in columns), strict=True)
    for place, (row, source, number) in enumerate(told):
        if source == TrackSource.TMA:
            keys[row] = (*keys[row], (tracks.contributor_sensor[place], number))
    return keys
