"""How targets take in echoes: what trackers of these measured, and their new tracks."""

from __future__ import annotations

import numpy as np

from sonar_tracking.fusion.echo_association import met_targets
from sonar_tracking.fusion.echo_checks import usable_measurements, usable_states
from sonar_tracking.fusion.fused_target import FusedTarget, moves
from sonar_tracking.fusion.fused_targets import SAME_PLACE, FusedTargets
from sonar_tracking.fusion.fusion_records import ListKey
from sonar_tracking.fusion.meetings import meetings_of_echoes
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS


class EchoTaking(FusedTargets):
    """Targets, and how they take in lists of tracks of what returns echoes."""

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
