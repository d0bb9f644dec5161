"""Truth beside recorded samples: bearings as surveyed, or where targets were, by tables or AIS.

Of positions the bearings follow, as the array hears them: the sound left a target while it was
where it no longer is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sonar_tracking.bags.importers.array_geometry_file import RecordedArray
from sonar_tracking.bags.importers.audio_recording import TRUTH_TOPIC, Message, truth_messages
from sonar_tracking.bags.importers.bearing_truth_file import (
    SurveyedBearings,
    holds_true_bearings,
    read_surveyed_bearings,
)
from sonar_tracking.bags.importers.contact_messages import TRACKS_TYPE, truth_tracks_cdr
from sonar_tracking.bags.importers.import_contacts import TRUTH_TOPIC as POSITIONS_TOPIC
from sonar_tracking.bags.importers.recorded_messages import truth_cdr
from sonar_tracking.bags.positions.given_files import Files, files_text
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLogs
from sonar_tracking.bags.positions.own_ship_track import check_overlap, own_ship_at
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.bags.positions.true_tracks import TrueTargets, read_true_targets
from sonar_tracking.bags.storage.bag_records import BEARING_TRACKS_TYPE
from sonar_tracking.motion import lever_arm, swing_velocity
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import NANOSECONDS

PERIOD = NANOSECONDS
"""Between two pictures of the targets, ns."""

_AT_ONCE = 1024
"""Instants at which own ship is held at once."""


@dataclass(frozen=True)
class RecordingTruth:
    """What is known of the targets of a recording.

    Attributes
    ----------
    topics : dict of str to str
        Topic and message type of what there is.
    array : RecordedArray
        That hears them.
    bearings : list of SurveyedBearings
        As surveyed.
    targets : TrueTargets, optional
        Where they were.
    own_ship : SurveyedPositions, optional
        Goes with the targets.
    end : int
        Instant at which the recording ends, ns.
    """

    topics: dict[str, str]
    array: RecordedArray
    bearings: list[SurveyedBearings]
    targets: TrueTargets | None = None
    own_ship: SurveyedPositions | None = None
    end: int = 0

    def messages(self) -> Iterator[Message]:
        """Yield the messages by rising stamp."""
        if self.targets is None or self.own_ship is None:
            return truth_messages(self.bearings, self.array)
        return self._of_positions(self.targets, self.own_ship)

    def _of_positions(self, targets: TrueTargets, own_ship: SurveyedPositions) -> Iterator[Message]:
        stamps = np.arange(self.array.epoch, self.end + 1, PERIOD, dtype=np.int64)
        pictures = targets.pictures(stamps)
        for begin in range(0, len(stamps), _AT_ONCE):
            motion = own_ship_at(own_ship, stamps[begin : begin + _AT_ONCE])
            for index, stamp in enumerate(motion.stamp.tolist()):
                picture = next(pictures)
                turn_rate = float(motion.turn_rate[index])
                arm = lever_arm(float(motion.azimuth[index]), *self.array.mounting)
                heard = _heard(
                    picture,
                    motion.position[index] + arm,
                    motion.velocity[index] + swing_velocity(turn_rate, arm),
                    (float(motion.azimuth[index]) + self.array.mounting_yaw, turn_rate),
                    self.array.sound_speed,
                )
                bearings = truth_cdr(self.array, stamp, picture.next_stamp, heard)
                yield stamp, POSITIONS_TOPIC, truth_tracks_cdr(picture), 0
                yield stamp, TRUTH_TOPIC, bearings, 0


def read_recording_truth(
    given: Files | None,
    array: RecordedArray,
    end: int,
    own_ship: SurveyedPositions,
    notes: list[str],
    origin: MapOrigin,
    logs: NmeaLogs,
) -> RecordingTruth:
    """Read the truth of a recording.

    Parameters
    ----------
    given : Path, str, or sequence of them, optional
        A table of true bearings; or tables of positions, or logs of NMEA 0183 with AIS.
    array : RecordedArray
        Its epoch is that of the recording, of ``time_s`` = 0 and of the date of logs without one.
    end : int
        Instant at which the recording ends, ns.
    own_ship : SurveyedPositions
        Own ship.
    notes : list of str
        Told what was left out or assumed.
    origin : MapOrigin
        The datum.
    logs : NmeaLogs
        Logs that were read already.

    Raises
    ------
    ConfigurationError
        If a file cannot be used, or has no instant in common with the recording.
    """
    if given is None:
        return RecordingTruth({}, array, [])
    if holds_true_bearings(given):
        bearings, told = read_surveyed_bearings(given, array.epoch)
        notes.extend(told)
        return RecordingTruth({TRUTH_TOPIC: BEARING_TRACKS_TYPE}, array, bearings)
    targets = read_true_targets(given, array.epoch, notes, origin, logs)
    check_overlap(files_text(given), targets.known(), np.array([array.epoch, end]))
    topics = {POSITIONS_TOPIC: TRACKS_TYPE, TRUTH_TOPIC: BEARING_TRACKS_TYPE}
    return RecordingTruth(topics, array, [], targets, own_ship, end)


def _heard(
    picture: TruthTracks,
    position: FloatArray,
    velocity: FloatArray,
    axis: tuple[float, float],
    sound_speed: float,
) -> SurveyedBearings:
    """Return the arrival angles of targets at an array.

    Its place and velocity are in m and m/s, shape (2,); its axis is told by azimuth and turn rate,
    rad and rad/s.
    """
    known = np.nan_to_num(picture.velocity)
    away = picture.position - position
    late = np.hypot(away[:, 0], away[:, 1]) / sound_speed
    away = away - late[:, None] * known
    distance = np.maximum(np.hypot(away[:, 0], away[:, 1]), 1e-6)
    towards = away / distance[:, None]
    moving = known - velocity
    across = moving - np.sum(moving * towards, axis=1)[:, None] * towards
    azimuth, turn_rate = axis
    along = np.array([np.cos(azimuth), np.sin(azimuth)])
    turning = turn_rate * np.array([-along[1], along[0]])
    sine = np.clip(towards @ along, -1.0, 1.0)
    rate = (across @ along) / distance + towards @ turning
    cosine = np.sqrt(np.maximum(1.0 - sine**2, 1e-6))
    return SurveyedBearings(0.0, picture.id, np.arcsin(sine), rate / cosine)
