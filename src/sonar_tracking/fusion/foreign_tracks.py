"""Tracks of other ships, fused with own ones without knowing what both have in common.

Another ship may have heard the same sound or been told the same by a third one, so that its tracks
are fused by inverse covariance intersection, for the list alone: what own sensors tell is never
mixed with it. Only what a ship has found itself is taken; a row that is made of somebody's fused
tracks may hold what own ship has told before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.copied_rows import moved_state
from sonar_tracking.fusion.echo_association import log_odds_of_one_target
from sonar_tracking.fusion.echo_checks import unusable_rows, usable_states
from sonar_tracking.fusion.fused_rows import Contribution, FusedRow, ShownRows
from sonar_tracking.fusion.fusion_records import ListKey
from sonar_tracking.fusion.inverse_covariance_intersection import inverse_covariance_intersection
from sonar_tracking.fusion.shared_names import SharedNames, Source
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import seconds
from sonar_tracking.tma.stations.station_association import FREE, associate

SHARPEST = 0.01
"""No ship knows where a target is to less than this standard deviation, m."""

LATEST_AGE = 60.0
"""A list that is older says nothing any more, s."""


class ForeignTracks:
    """The last list of each other ship, and which of its rows are of targets known already.

    Parameters
    ----------
    configuration : TrackFusionConfiguration
        Odds, the area in which tracks begin, identifiers.
    """

    def __init__(self, configuration: TrackFusionConfiguration) -> None:
        self.configuration = configuration
        self.names = SharedNames(configuration.first_of_all)
        self.forget()

    def forget(self) -> None:
        """Forget all lists; identifiers go on."""
        self.names.forget()
        self._lists: dict[str, PositionTracks] = {}
        self._shown = ShownRows()

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
        going_on = tracks.status != TrackStatus.TERMINATED
        self.names.keep(topic, set(tracks.id[going_on].tolist()))
        return unusable_rows(tracks, topic, possible)

    def listed(self, own: Sequence[FusedRow], stamp: int, next_stamp: int) -> PositionTracks:
        """Return own rows, fused with those of other ships, and what only these have.

        Parameters
        ----------
        own : sequence of FusedRow
            Of own targets.
        stamp, next_stamp : int
            Of the list, ns.
        """
        sources: list[Source] = [row.id for row in own]
        rows = [replace(row, id=self.names.name_of(row.id)) for row in own]
        for topic, tracks in self._lists.items():
            age = seconds(stamp - tracks.stamp)
            if 0.0 <= age <= LATEST_AGE and len(tracks):
                self._add(topic, tracks, age, sources, rows)
        self.names.keep_own({row.id for row in own})
        return self._shown.listed(rows, stamp, next_stamp)

    def _add(
        self,
        topic: str,
        tracks: PositionTracks,
        age: float,
        sources: list[Source],
        rows: list[FusedRow],
    ) -> None:
        """Add the list of a ship, some seconds old, to the rows known before and who tells them."""
        told = [
            moved_state(KalmanState(tracks.state[row], tracks.covariance[row]), age)
            for row in range(len(tracks))
        ]
        keys: list[ListKey] = [(topic, int(number)) for number in tracks.id]
        known, before = tuple(sources), [self.names.partner_of(key) for key in keys]
        partners = self._partners(before, told, known, rows)
        alone = {key for key, place in zip(keys, partners, strict=True) if place is None}
        self.names.settle(keys, alone, known)
        for number, source in enumerate(known):
            rows[number] = replace(rows[number], id=self.names.name_of(source))
        for row, (key, place) in enumerate(zip(keys, partners, strict=True)):
            if place is None:
                name = self.names.alone(key, {one.id for one in rows})
                sources.append(key)
                rows.append(_foreign_row(tracks, row, key, name, told[row]))
                continue
            others = {one.id for one in rows if one is not rows[place]}
            name = self.names.join(key, known[place], self._shown.confirmed_since, others)
            rows[place] = _joint_row(rows[place], tracks, row, key, name, told[row])

    def _partners(
        self,
        before: Sequence[Source | None],
        told: Sequence[KalmanState],
        sources: Sequence[Source],
        rows: Sequence[FusedRow],
    ) -> list[int | None]:
        """Return which known row each row of another ship is of; None = of none.

        A pair stays one for as long as it is likelier than not.
        """
        known = [place for place, row in enumerate(rows) if np.all(np.isfinite(row.covariance))]
        if not known:
            return [None] * len(told)
        odds = log_odds_of_one_target(
            np.array([one.mean for one in told]),
            np.array([one.covariance for one in told]),
            np.array([rows[place].state for place in known]),
            np.array([rows[place].covariance for place in known]),
            self.configuration.clutter_area,
        )
        needed = np.log(self.configuration.association_odds * len(known))
        were_one = np.array([[one == sources[place] for one in before] for place in known])
        chosen = associate(odds - np.where(were_one, 0.0, needed), 1.0)
        return [None if row == FREE else known[row] for row in chosen]


def _joint_row(
    known: FusedRow,
    tracks: PositionTracks,
    row: int,
    key: ListKey,
    number: int,
    told: KalmanState,
) -> FusedRow:
    """Return a row known before with what another ship tells of the target, as ``number``."""
    both = inverse_covariance_intersection(KalmanState(known.state, known.covariance), told)
    return replace(
        known,
        id=number,
        status=_surer(known.status, TrackStatus(tracks.status[row])),
        state=both.mean,
        covariance=both.covariance,
        existence=float(np.fmax(known.existence, tracks.existence_probability[row])),
        initiated=float(np.fmin(known.initiated, tracks.initiated[row])),
        updated=float(np.fmax(known.updated, tracks.updated[row])),
        contributors=(*known.contributors, *_contributions(tracks, row, key)),
    )


def _surer(one: TrackStatus, other: TrackStatus) -> TrackStatus:
    """Return the status of a target of which two ships tell."""
    order = (TrackStatus.CONFIRMED, TrackStatus.COASTED, TrackStatus.TENTATIVE)
    return min(one, other, key=order.index)


def _foreign_row(
    tracks: PositionTracks, row: int, key: ListKey, number: int, told: KalmanState
) -> FusedRow:
    """Return a row of another ship of what nobody else knows, as ``number``."""
    static = tracks.source[row] == TrackSource.STATIC
    return FusedRow(
        id=number,
        status=TrackStatus(tracks.status[row]),
        source=TrackSource.STATIC if static else TrackSource.FUSED,
        state=told.mean,
        covariance=told.covariance,
        existence=float(tracks.existence_probability[row]),
        initiated=float(tracks.initiated[row]),
        updated=float(tracks.updated[row]),
        contributors=_contributions(tracks, row, key),
    )


def _possible(tracks: PositionTracks) -> BoolArray:
    """Return which rows, shape (n,), do not claim to know a position better than anybody can."""
    return np.asarray(np.all(tracks.covariance[:, (0, 1), (0, 1)] >= SHARPEST**2, axis=1))


def _found_by_itself(tracks: PositionTracks) -> BoolArray:
    """Return which rows, shape (n,), are not made of the fused tracks of others."""
    others = tracks.contributor_track[tracks.contributor_source == TrackSource.FUSED]
    return np.isin(np.arange(len(tracks)), others, invert=True)


def _contributions(tracks: PositionTracks, row: int, key: ListKey) -> tuple[Contribution, ...]:
    """Return the row itself and what it is made of."""
    made_of = tuple(
        (
            TrackSource(tracks.contributor_source[one]),
            tracks.contributor_sensor[one],
            int(tracks.contributor_id[one]),
        )
        for one in np.flatnonzero(tracks.contributor_track == row)
    )
    return ((TrackSource.FUSED, *key), *made_of)
