"""Tracks of other ships, fused with own ones without knowing what both have in common.

Another ship may have heard the same sound or been told the same by a third one, so that its tracks
are fused by inverse covariance intersection, for the list alone: what own sensors tell is never
mixed with it. Only what a ship has found itself is taken; a row that is made of somebody's fused
tracks may hold what own ship has told before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.copied_rows import moved_state
from sonar_tracking.fusion.echo_association import log_odds_of_one_target
from sonar_tracking.fusion.echo_checks import unusable_rows, usable_states
from sonar_tracking.fusion.fused_rows import Contribution, FusedRow
from sonar_tracking.fusion.fusion_records import ListKey
from sonar_tracking.fusion.inverse_covariance_intersection import inverse_covariance_intersection
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import seconds
from sonar_tracking.tma.targets.station_association import FREE, associate

SHARPEST = 0.01
"""No ship knows where a target is to less than this standard deviation, m."""

LATEST_AGE = 60.0
"""A list that is older says nothing any more, s."""


class ForeignTracks:
    """The last list of each other ship, and which of its rows are of own targets.

    Parameters
    ----------
    configuration : TrackFusionConfiguration
        Odds and the area in which tracks begin.
    next_id : callable
        Returns a new identifier.
    """

    def __init__(self, configuration: TrackFusionConfiguration, next_id: Callable[[], int]) -> None:
        self._configuration = configuration
        self._next_id = next_id
        self._lists: dict[str, PositionTracks] = {}
        self._names: dict[ListKey, int] = {}
        self._own: dict[ListKey, int] = {}

    @property
    def heard_of(self) -> bool:
        """Whether any other ship has told anything."""
        return bool(self._lists)

    def take(self, topic: str, tracks: PositionTracks, stamp: int) -> tuple[Notice, ...]:
        """Let a list be the last one of a ship; rows that cannot be used are left out.

        Parameters
        ----------
        topic : str
            Of the ship.
        tracks : PositionTracks
            Its list.
        stamp : int
            Of the frame, ns.

        Returns
        -------
        tuple of Notice
            What is wrong with it.
        """
        apart = seconds(stamp - tracks.stamp)
        if not 0.0 <= apart <= LATEST_AGE:
            text = (
                f"{shown(topic)}: its list has a stamp {abs(apart):.0f} s "
                f"{'before' if apart > 0.0 else 'after'} own data; it was left out: ships that "
                "exchange tracks need clocks and epochs in common."
            )
            return (Notice(Severity.WARN, f"stamps of {shown(topic)}", text),)
        possible = usable_states(tracks) & _possible(tracks)
        usable = possible & tracks.established & _found_by_itself(tracks)
        self._lists[topic] = tracks.selected(usable)
        return unusable_rows(tracks, topic, possible)

    def fused(self, rows: Sequence[FusedRow], stamp: int) -> list[FusedRow]:
        """Return own rows, fused with those of other ships, and what only these have.

        Parameters
        ----------
        rows : sequence of FusedRow
            Of own targets.
        stamp : int
            Of the list, ns.
        """
        result = list(rows)
        for topic, tracks in self._lists.items():
            age = seconds(stamp - tracks.stamp)
            if 0.0 <= age <= LATEST_AGE and len(tracks):
                result = self._with_list(topic, tracks, result, len(rows), age)
        return result

    def _with_list(
        self, topic: str, tracks: PositionTracks, rows: list[FusedRow], n_own: int, age: float
    ) -> list[FusedRow]:
        foreign = [
            moved_state(KalmanState(tracks.state[row], tracks.covariance[row]), age)
            for row in range(len(tracks))
        ]
        keys = [(topic, int(number)) for number in tracks.id]
        partners = self._partners(keys, foreign, rows[:n_own])
        result = list(rows)
        for row, (key, state) in enumerate(zip(keys, foreign, strict=True)):
            place = partners[row]
            made_of = ((TrackSource.FUSED, topic, key[1]), *_contributions(tracks, row))
            if place is None:
                result.append(self._foreign_row(tracks, row, key, state, made_of))
                continue
            own = result[place]
            both = inverse_covariance_intersection(KalmanState(own.state, own.covariance), state)
            contributors = (*own.contributors, *made_of)
            result[place] = replace(
                own, state=both.mean, covariance=both.covariance, contributors=contributors
            )
        return result

    def _partners(
        self, keys: Sequence[ListKey], foreign: Sequence[KalmanState], own: Sequence[FusedRow]
    ) -> list[int | None]:
        """Return the own row of each foreign one; None = there is none.

        A pair stays one for as long as it is likelier than not.
        """
        known = [place for place, row in enumerate(own) if np.all(np.isfinite(row.covariance))]
        if not known:
            return [None] * len(keys)
        odds = log_odds_of_one_target(
            np.array([one.mean for one in foreign]),
            np.array([one.covariance for one in foreign]),
            np.array([own[place].state for place in known]),
            np.array([own[place].covariance for place in known]),
            self._configuration.clutter_area,
        )
        needed = np.log(self._configuration.association_odds * len(known))
        before = np.array(
            [[self._own.get(key) == own[place].id for key in keys] for place in known]
        )
        chosen = associate(odds - np.where(before, 0.0, needed), 1.0)
        partners = [None if row == FREE else known[row] for row in chosen]
        for key, place in zip(keys, partners, strict=True):
            if place is None:
                self._own.pop(key, None)
            else:
                self._own[key] = own[place].id
        return partners

    def _foreign_row(
        self,
        tracks: PositionTracks,
        row: int,
        key: ListKey,
        state: KalmanState,
        contributors: tuple[Contribution, ...],
    ) -> FusedRow:
        if key not in self._names:
            self._names[key] = self._next_id()
        static = tracks.source[row] == TrackSource.STATIC
        return FusedRow(
            id=self._names[key],
            status=tracks.status[row],
            source=TrackSource.STATIC if static else TrackSource.FUSED,
            state=state.mean,
            covariance=state.covariance,
            existence=float(tracks.existence_probability[row]),
            initiated=float(tracks.initiated[row]),
            updated=float(tracks.updated[row]),
            contributors=contributors,
        )


def _possible(tracks: PositionTracks) -> BoolArray:
    """Return which rows, shape (n,), do not claim to know a position better than anybody can."""
    return np.asarray(np.all(tracks.covariance[:, (0, 1), (0, 1)] >= SHARPEST**2, axis=1))


def _found_by_itself(tracks: PositionTracks) -> BoolArray:
    """Return which rows, shape (n,), are not made of the fused tracks of others."""
    others = tracks.contributor_track[tracks.contributor_source == TrackSource.FUSED]
    return np.isin(np.arange(len(tracks)), others, invert=True)


def _contributions(tracks: PositionTracks, row: int) -> tuple[Contribution, ...]:
    return tuple(
        (
            TrackSource(tracks.contributor_source[one]),
            tracks.contributor_sensor[one],
            int(tracks.contributor_id[one]),
        )
        for one in np.flatnonzero(tracks.contributor_track == row)
    )
