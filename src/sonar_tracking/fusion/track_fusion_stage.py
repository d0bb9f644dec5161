"""The stage that makes one picture of all others: one row a target, whatever hears it.

Targets that return echoes are followed by filters that take in what each update of their tracks
measured, and the bearings of the bearing tracks that are found to be of them. Finished tracks are
not taken in as if they were measurements: they tell the same again and again. Targets that are only
heard are shown as target motion analysis finds them, until an echo tells which they are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.alignment.shared_alignment import SharedAlignment
from sonar_tracking.errors import Notice
from sonar_tracking.fusion.alignment_notices import beyond_prior, measured_alignments
from sonar_tracking.fusion.echo_association import met_targets
from sonar_tracking.fusion.echo_checks import unusable_rows, usable_measurements, usable_states
from sonar_tracking.fusion.foreign_tracks import ForeignTracks
from sonar_tracking.fusion.fused_rows import (
    FusedRow,
    OwnPicture,
    row_of_target,
    turned_by_heading,
)
from sonar_tracking.fusion.fused_target import FusedTarget, moves
from sonar_tracking.fusion.fused_targets import SAME_PLACE, FusedTargets
from sonar_tracking.fusion.fusion_records import (
    FusionFrame,
    FusionUpdate,
    HeardBearing,
    ListKey,
)
from sonar_tracking.fusion.meetings import meetings_of_bearings, meetings_of_echoes
from sonar_tracking.fusion.new_trials import new_trials
from sonar_tracking.fusion.station_bearings import (
    StationBearings,
    station_bearings,
    with_names_of_their_own,
)
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.unresolved_bearings import UnresolvedBearings
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import (
    NANOSECONDS,
    UNKNOWN_STAMP,
    common_watermark,
    seconds,
)


class TrackFusionStage(FusedTargets):
    """Keeps one target for whatever other lists tell of it.

    Parameters
    ----------
    configuration : TrackFusionConfiguration
        Its parameters.
    n_sources : int
        Track lists and stations that report.
    """

    def __init__(
        self, configuration: TrackFusionConfiguration | None = None, n_sources: int = 1
    ) -> None:
        settings = configuration or TrackFusionConfiguration()
        self._n_sources = n_sources
        self._foreign = ForeignTracks(settings)
        super().__init__(settings)

    def reset(self) -> None:
        """Forget all targets; identifiers go on."""
        super().reset()
        self._foreign.forget()
        self._stations: dict[str, FloatArray] = {}
        self._own_ship: KinematicState | None = None
        self._watermarks: dict[str, int] = {}
        self._unresolved: dict[str, UnresolvedBearings] = {}

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        super().continue_from(first_id)
        again = replace(self.configuration, first_id=first_id)
        self._foreign.configuration = again
        self._foreign.names.continue_from(again.first_of_all)

    def end_track(self, number: int) -> None:
        """End a row of own sensors since an operator says so; see :class:`FusedTargets`."""
        super().end_track(self._foreign.names.own_row_called(number))

    def merge_tracks(self, number: int, other: int) -> None:
        """Let two rows be one target since an operator says so; see :class:`FusedTargets`."""
        own_row = self._foreign.names.own_row_called
        super().merge_tracks(own_row(number), own_row(other))

    def update(self, frame: FusionFrame) -> FusionUpdate:
        """Take in everything of one instant.

        Parameters
        ----------
        frame : FusionFrame
            Later than the one before.

        Raises
        ------
        InputError
            If the frame is not later; nothing has changed then.
        """
        own = self.own_picture(frame)
        tracks, notices = self.with_foreign(own, frame.foreign)
        return FusionUpdate(tracks, own.tracks, own.alignments, (*own.notices, *notices))

    def own_picture(self, frame: FusionFrame) -> OwnPicture:
        """Take in everything of one instant but what other ships tell.

        Parameters
        ----------
        frame : FusionFrame
            Later than the one before.

        Raises
        ------
        InputError
            If the frame is not later; nothing has changed then.
        """
        frame.check_later_than(self._stamp)
        if self._stamp != UNKNOWN_STAMP:
            interval = seconds(frame.stamp - self._stamp)
            self._filters.predict(interval)
            self._links.predict(interval)
        self._stamp, self._own_ship = frame.stamp, frame.own_ship
        notices: list[Notice] = []
        for topic, tracks in frame.active.items():
            self._watermarks[topic] = tracks.next_stamp
            notices += unusable_rows(tracks, topic, usable_states(tracks))
            self._take_echoes(topic, tracks)
        for bearings in with_names_of_their_own(frame.bearings, notices):
            self._watermarks[f"bearings of {bearings.sensor.sensor_id}"] = bearings.next_stamp
            notices += self._take_bearings(bearings, frame.own_ship)
        for topic, tracks in frame.passive.items():
            self._watermarks[topic] = tracks.next_stamp
            self._copies.take(topic, tracks)
        self._decide()
        self._end_orphans()
        watermark = common_watermark(self._watermarks.values(), self._n_sources, self._stamp)
        seen = self._filters.picture()
        alignments = self._filters.alignments(seen, self._stamp, watermark)
        notices += beyond_prior(alignments, self.configuration.alignment_deviation_deg)
        rows = self._own_rows(seen, alignments)
        tracks = self._own_rows_shown.listed(rows, self._stamp, watermark)
        return OwnPicture(tuple(rows), tracks, alignments, tuple(notices))

    def with_foreign(
        self, own: OwnPicture, foreign: Mapping[str, PositionTracks]
    ) -> tuple[PositionTracks, tuple[Notice, ...]]:
        """Return a picture of own sensors with what other ships tell, and what is wrong with that.

        Parameters
        ----------
        own : OwnPicture
            At a stamp after that of the picture before.
        foreign : mapping of str to PositionTracks
            By their topic: fused tracks of other ships that have come since then.
        """
        stamp = own.tracks.stamp
        notices: list[Notice] = []
        for topic, told in foreign.items():
            notices += self._foreign.take(topic, told, stamp)
        if not self._foreign.heard_of:
            return own.tracks, tuple(notices)
        tracks = self._foreign.listed(own.rows, stamp, own.tracks.next_stamp)
        return tracks, tuple(notices)

    def _take_echoes(self, topic: str, tracks: PositionTracks) -> None:
        self._copies.take(topic, tracks)
        going_on = {
            (topic, int(number)): row
            for row, number in enumerate(tracks.id)
            if tracks.status[row] != TrackStatus.TERMINATED
        }
        self._target_of.end_others(topic, going_on)
        self._take_for_targets(topic, tracks)
        sound, told = usable_states(tracks), usable_measurements(tracks)
        measured: list[tuple[FusedTarget, int]] = []
        for key, row in going_on.items():
            target = self._target_of.get(key)
            if target is None:
                continue
            target.note(key, tracks, row)
            if told[row] and all(one is not target for one, _ in measured):
                measured.append((target, row))
        rows = [row for _, row in measured]
        targets = [target for target, _ in measured]
        noise = tracks.measurement_covariance[rows]
        gain = self._filters.take_positions(targets, tracks.measurement[rows], noise)
        self._links.weigh_positions(targets, gain)
        self._filters.consider(meetings_of_echoes(targets, noise, self._filters))
        new = {
            key: row
            for key, row in going_on.items()
            if key not in self._target_of
            and key not in self._dismissed
            and sound[row]
            and moves(tracks, row)
        }
        self._meet(topic, tracks, new)

    def _take_for_targets(self, topic: str, tracks: PositionTracks) -> None:
        """Find what is told to be fixed, and may be a target that is heard and has lost its echoes.

        A tracker of echoes does not know of a new track for a while that it moves.
        """
        self._not_fixed = {key for key in self._not_fixed if key[0] != topic}
        targets = self._filters.targets
        lost = [row for row, one in enumerate(targets) if one.heard and not one.echoes]
        fixed = np.flatnonzero((tracks.source == TrackSource.STATIC) & usable_states(tracks))
        if not lost or not len(fixed):
            return
        seen = self._filters.picture()
        apart = tracks.state[fixed, None, :2] - seen.mean[lost, :2]
        spread = tracks.covariance[fixed, None, :2, :2] + seen.covariance[lost, :2, :2]
        solved = np.linalg.solve(spread, apart[..., None])[..., 0]
        same = np.any(np.sum(apart * solved, axis=-1) < SAME_PLACE, axis=1)
        self._not_fixed |= {(topic, int(tracks.id[row])) for row in fixed[same]}

    def _meet(self, topic: str, tracks: PositionTracks, new: dict[ListKey, int]) -> None:
        """Find out whose new confirmed tracks are: of a target whose echoes were lost, or new."""
        if not new:
            return
        rows = list(new.values())
        lost = [one for one in self._filters.targets if all(key[0] != topic for key in one.echoes)]
        met = met_targets(
            tracks.state[rows], tracks.covariance[rows], lost, self._filters, self.configuration
        )
        for (key, row), whose in zip(new.items(), met, strict=True):
            target = whose.target if whose.sure else None
            if target is None:
                target = FusedTarget(self._copies.name(key), float(tracks.initiated[row]))
                if whose.target is not None and whose.target.heard:
                    target.begin_doubt(whose.target, self._stamp / NANOSECONDS)
                self._filters.begin(target, tracks.state[row], tracks.covariance[row])
            elif usable_measurements(tracks)[row]:
                one = slice(row, row + 1)
                self._filters.take_positions(
                    [target], tracks.measurement[one], tracks.measurement_covariance[one]
                )
            self._target_of[key] = target
            target.note(key, tracks, row)

    def _take_bearings(
        self, bearings: BearingTracks, own_ship: KinematicState | None
    ) -> tuple[Notice, ...]:
        sensor = bearings.sensor.sensor_id
        array = self._filters.array_of(sensor)
        told = station_bearings(bearings, own_ship, array, self.configuration)
        self._alive[sensor] = told.alive
        for key in [key for key in self._links.of_station(sensor) if key not in told.alive]:
            self._unlink(key)
        tried = {one.key for one in self._filters.trials.trials if one.key[0] == sensor}
        self._filters.trials.end(set(), tried - set(told.alive))
        if told.found:
            self._stations[sensor] = told.found[0].station
            found, notices = self._resolved(sensor, self._filters.widened(told.found))
            self._take_linked(self._once_a_target(found))
            free = [one for one in found if self._may_be_tried(one.key, told)]
            begun = new_trials(free, self._filters, self._paused, self._stamp)
            self._filters.begin_trials(begun)
            self._filters.try_bearings(free)
            return (*told.notices, *notices)
        return told.notices

    def _resolved(
        self, sensor: str, found: list[HeardBearing]
    ) -> tuple[list[HeardBearing], tuple[Notice, ...]]:
        """Return the bearings of a station that are of one target each, and what to tell of it."""
        targets = self._filters.targets
        if sensor not in self._unresolved:
            resolution = self.configuration.bearing_resolution
            self._unresolved[sensor] = UnresolvedBearings(sensor, resolution)
        unresolved = self._unresolved[sensor]
        notices = unresolved.take(
            found, targets, lambda: self._filters.expected(found[0])[0], self._stamp
        )
        for target in targets:
            if not unresolved.keys.isdisjoint(target.heard):
                target.updated = self._stamp / NANOSECONDS
        return [one for one in found if one.key not in unresolved.keys], notices

    def _once_a_target(self, found: list[HeardBearing]) -> list[HeardBearing]:
        """Return the bearings that are of targets; of two that an operator has merged, one."""
        first: dict[FusedTarget, HeardBearing] = {}
        for one in found:
            owner = self._links.target_of(one.key)
            if owner is not None:
                first.setdefault(owner, one)
        return list(first.values())

    def _take_linked(self, found: list[HeardBearing]) -> None:
        if not found:
            return
        targets = [self._links.target_of(one.key) for one in found]
        owners = [one for one in targets if one is not None]
        self._links.weigh(found, *self._filters.take_bearings(owners, found))
        self._filters.consider(meetings_of_bearings(owners, found, self._filters))
        for target, one in zip(owners, found, strict=True):
            target.heard[one.key] = self._alive[one.key[0]][one.key]
            target.updated = self._stamp / NANOSECONDS

    def _may_be_tried(self, key: BearingKey, told: StationBearings) -> bool:
        """Return whether it is open of which target a bearing track is."""
        target = self._links.target_of(key)
        if key in self._dismissed or (target is not None and target.echoes):
            return False
        return told.alive[key].status == TrackStatus.CONFIRMED

    def _own_rows(self, seen: SharedAlignment, known: ArrayAlignments) -> list[FusedRow]:
        """Return what own sensors tell, at the stamp of the last frame."""
        settings = self.configuration
        rows = [
            row_of_target(target, state, covariance)
            for target, state, covariance in zip(
                self._filters.targets, seen.mean[:, :4], seen.covariance[:, :4, :4], strict=True
            )
        ]
        alignments = measured_alignments(known, math.sqrt(settings.alignment_variance))
        taken = {row.id for row in rows}
        odds, n_targets = settings.association_odds, len(self._filters.targets)
        self._spoken_for = self._filters.trials.spoken_for(odds, n_targets)
        for unresolved in self._unresolved.values():
            self._spoken_for |= unresolved.keys
        rows += self._copies.rows(self._stamp, self._stands_for, self._stations, alignments, taken)
        heading = settings.heading_variance
        return [turned_by_heading(row, self._own_ship, heading) for row in rows]
