"""The stage that makes one picture of all others: one row a target, whatever hears it.

Targets that return echoes are followed by filters that take in what each update of their tracks
measured, and the bearings of the bearing tracks that are found to be of them. Finished tracks are
not taken in as if they were measurements: they tell the same again and again. Targets that are only
heard are shown as target motion analysis finds them, until an echo tells which they are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.alignment.shared_alignment import SharedAlignment
from sonar_tracking.errors import Notice
from sonar_tracking.fusion.alignment_notices import beyond_prior, measured_alignments
from sonar_tracking.fusion.echo_checks import unusable_rows, usable_states
from sonar_tracking.fusion.echo_taking import EchoTaking
from sonar_tracking.fusion.filters_together import (
    LinkedBearings,
    predict_together,
    see_together,
    take_linked_together,
)
from sonar_tracking.fusion.foreign_tracks import ForeignTracks
from sonar_tracking.fusion.fused_rows import (
    FusedRow,
    OwnPicture,
    row_of_target,
    turned_by_heading,
)
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import (
    FusionFrame,
    FusionUpdate,
    HeardBearing,
)
from sonar_tracking.fusion.new_trials import new_trials
from sonar_tracking.fusion.pictures_under_way import HeardOfStation, PictureUnderWay
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
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import (
    NANOSECONDS,
    UNKNOWN_STAMP,
    common_watermark,
    seconds,
)


class TrackFusionStage(EchoTaking):
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
        return update_together([self], [frame])[0]

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
        return own_pictures_together([self], [frame])[0]

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

    def _interval_to(self, frame: FusionFrame) -> float:
        """Return how long after the last frame one is, s; 0 = it is the first one."""
        return seconds(frame.stamp - self._stamp) if self._stamp != UNKNOWN_STAMP else 0.0

    def _begin(self, frame: FusionFrame, interval: float) -> PictureUnderWay:
        """Take in what comes before bearings, the filters being predicted."""
        if interval > 0.0:
            self._links.predict(interval)
        self._stamp, self._own_ship = frame.stamp, frame.own_ship
        notices: list[Notice] = []
        for topic, tracks in frame.active.items():
            self._watermarks[topic] = tracks.next_stamp
            notices += unusable_rows(tracks, topic, usable_states(tracks))
            self._take_echoes(topic, tracks)
        return PictureUnderWay(with_names_of_their_own(frame.bearings, notices), notices)

    def _listen(self, bearings: BearingTracks, notices: list[Notice]) -> HeardOfStation:
        """Find out of which targets the bearings of a station are."""
        sensor = bearings.sensor.sensor_id
        self._watermarks[f"bearings of {sensor}"] = bearings.next_stamp
        array = self._filters.array_of(sensor)
        told = station_bearings(bearings, self._own_ship, array, self.configuration)
        notices += told.notices
        self._alive[sensor] = told.alive
        for key in [key for key in self._links.of_station(sensor) if key not in told.alive]:
            self._unlink(key)
        tried = {one.key for one in self._filters.trials.trials if one.key[0] == sensor}
        self._filters.trials.end(set(), tried - set(told.alive))
        if not told.found:
            return HeardOfStation(told, [], self._linked([]))
        self._stations[sensor] = told.found[0].station
        found, untold = self._resolved(sensor, self._filters.widened(told.found))
        notices += untold
        return HeardOfStation(told, found, self._linked(found))

    def _conclude_hearing(self, heard: HeardOfStation) -> None:
        """Note who was heard, and try whose all other bearings are."""
        for target, one in zip(heard.linked.targets, heard.linked.found, strict=True):
            target.heard[one.key] = self._alive[one.key[0]][one.key]
            target.updated = self._stamp / NANOSECONDS
        if heard.told.found:
            free = [one for one in heard.found if self._may_be_tried(one.key, heard.told)]
            begun = new_trials(free, self._filters, self._paused, self._stamp)
            self._filters.begin_trials(begun)
            self._filters.try_bearings(free)

    def _settle(self, frame: FusionFrame) -> None:
        """Decide what all that came makes likely."""
        for topic, tracks in frame.passive.items():
            self._watermarks[topic] = tracks.next_stamp
            self._copies.take(topic, tracks)
        self._decide()
        self._end_orphans()

    def _shown(self, notices: list[Notice]) -> OwnPicture:
        """Return the picture as it is now."""
        watermark = common_watermark(self._watermarks.values(), self._n_sources, self._stamp)
        seen = self._filters.picture()
        alignments = self._filters.alignments(seen, self._stamp, watermark)
        notices += beyond_prior(alignments, self.configuration.alignment_deviation_deg)
        rows = self._own_rows(seen, alignments)
        tracks = self._own_rows_shown.listed(rows, self._stamp, watermark)
        return OwnPicture(tuple(rows), tracks, alignments, tuple(notices))

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

    def _linked(self, found: Sequence[HeardBearing]) -> LinkedBearings:
        """Return the bearings that are of targets; of two that an operator has merged, one."""
        first: dict[FusedTarget, HeardBearing] = {}
        for one in found:
            owner = self._links.target_of(one.key)
            if owner is not None:
                first.setdefault(owner, one)
        return LinkedBearings(self._filters, self._links, list(first), list(first.values()))

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


def update_together(
    stages: Sequence[TrackFusionStage], frames: Sequence[FusionFrame]
) -> list[FusionUpdate]:
    """Let several independent stages take a frame each in, as each of them would.

    Parameters
    ----------
    stages : sequence of TrackFusionStage
        Their targets are computed at once.
    frames : sequence of FusionFrame
        One a stage, later than the one before.

    Raises
    ------
    InputError
        If a frame is not later; nothing has changed then.
    """
    updates = []
    pictures = own_pictures_together(stages, frames)
    for stage, frame, own in zip(stages, frames, pictures, strict=True):
        tracks, notices = stage.with_foreign(own, frame.foreign)
        every = (*own.notices, *notices)
        updates.append(FusionUpdate(tracks, own.tracks, own.alignments, every))
    return updates


def own_pictures_together(
    stages: Sequence[TrackFusionStage], frames: Sequence[FusionFrame]
) -> list[OwnPicture]:
    """Let several stages take in everything of a frame each but what other ships tell.

    Parameters
    ----------
    stages : sequence of TrackFusionStage
        Their targets are computed at once.
    frames : sequence of FusionFrame
        One a stage, later than the one before.

    Raises
    ------
    InputError
        If a frame is not later; nothing has changed then.
    """
    for stage, frame in zip(stages, frames, strict=True):
        frame.check_later_than(stage._stamp)
    every = [stage._filters for stage in stages]
    intervals = [stage._interval_to(frame) for stage, frame in zip(stages, frames, strict=True)]
    predict_together(every, intervals)
    begun = [
        stage._begin(frame, interval)
        for stage, frame, interval in zip(stages, frames, intervals, strict=True)
    ]
    for number in range(max((len(one.stations) for one in begun), default=0)):
        heard = [
            (stage, stage._listen(one.stations[number], one.notices))
            for stage, one in zip(stages, begun, strict=True)
            if number < len(one.stations)
        ]
        take_linked_together([one.linked for _, one in heard if one.linked.found])
        for stage, one in heard:
            stage._conclude_hearing(one)
    for stage, frame in zip(stages, frames, strict=True):
        stage._settle(frame)
    see_together(every)
    return [stage._shown(one.notices) for stage, one in zip(stages, begun, strict=True)]
