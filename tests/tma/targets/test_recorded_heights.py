"""Protects what comes of recorded animals with default parameters: joined, at a depth they have."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.recorded_data import recorded_data
from tests.tma.direction_reports import reported

DEVIATION = float(np.radians(1.0))
BOTTOM, SURFACE = -1322.0, 0.0

EVERY = {3: 2, 4: 2, 7: 2}
"""Of whales that click often, every second click tells enough."""


def whale_frames(label: int) -> tuple[list[PassiveFrame], float]:
    """Return the frames of one whale at both arrays, and the speed of sound, m/s."""
    lists: dict[int, list[BearingTracks]] = {}
    with np.load(recorded_data("whale_click_bearings/encounter_2018_03_27.npz")) as data:
        speed = float(data["sound_speed_m_s"])
        for name in ("EW", "EE"):
            own = (data[f"{name}_label"] == label) & (np.abs(data[f"{name}_norm"] - 1.0) < 0.1)
            times = data[f"{name}_t_s"][own].tolist()
            azimuths = azimuth_from_compass(data[f"{name}_az_deg"][own]).tolist()
            elevations = np.radians(data[f"{name}_el_deg"][own]).tolist()
            for time, azimuth, elevation in zip(times, azimuths, elevations, strict=True):
                stamp = nanoseconds(1000.0 + time)
                of_azimuth = DEVIATION / max(np.cos(elevation), 0.2)
                one = reported(
                    *(name, data[f"{name}_array_enu_m"], azimuth, elevation, DEVIATION),
                    *(stamp, of_azimuth),
                )
                lists.setdefault(stamp, []).append(one)
    return [PassiveFrame(stamp, tuple(lists[stamp])) for stamp in sorted(lists)], speed


class Following:
    """A whale at both arrays, followed as far as somebody has asked."""

    def __init__(self, label: int) -> None:
        frames, speed = whale_frames(label)
        self.frames = frames[:: EVERY.get(label, 1)]
        self._stage = TmaTrackerStage(TmaTrackerConfiguration(sound_speed=speed), n_stations=2)
        self._lists: list[PositionTracks | None] = []

    def tracks(self, number: int) -> PositionTracks | None:
        """Return the list after a frame."""
        while len(self._lists) <= number:
            self._lists.append(self._stage.update(self.frames[len(self._lists)]).tracks)
        return self._lists[number]


following = cache(Following)
"""That of a whale, by its number: its tests go on with what the others have followed."""


@pytest.mark.data
@pytest.mark.slow
@pytest.mark.parametrize("label", [3, 4, 7])
def test_recorded_whales_are_joined_and_between_bottom_and_surface(label: int) -> None:
    whale = following(label)
    heights, deviations = [], []
    for number in range(len(whale.frames)):
        tracks = whale.tracks(number)
        if tracks is None or len(tracks) != 1 or len(set(tracks.contributor_sensor)) < 2:
            continue
        if tracks.status[0] == TrackStatus.CONFIRMED:
            heights.append(tracks.z[0])
            deviations.append(tracks.z_standard_deviation[0])
    assert len(heights) > 0.4 * len(whale.frames)
    assert np.min(heights) > BOTTOM and np.max(heights) < SURFACE
    assert np.median(deviations) < 120.0


@pytest.mark.data
@pytest.mark.slow
@pytest.mark.parametrize("label", [2, 3, 4, 6, 7])
def test_a_recorded_whale_is_one_target_within_five_minutes_of_both_hearing_it(label: int) -> None:
    """Their azimuths disagree by half a degree, click after click.

    Time counts while both have heard it within a minute: number 6 is silent for one for six.
    """
    whale = following(label)
    heard: dict[str, int] = {}
    together, before, last = 0, whale.frames[0].stamp, 0
    for number, frame in enumerate(whale.frames):
        recent = [stamp for stamp in heard.values() if frame.stamp - stamp < nanoseconds(60.0)]
        if len(recent) == 2:
            together += frame.stamp - before
        before = frame.stamp
        if together > nanoseconds(300.0):
            break
        heard |= {one.sensor.sensor_id: frame.stamp for one in frame.bearings}
        last = number
    tracks = whale.tracks(last)
    assert tracks is not None and len(tracks) == 1
    assert set(tracks.contributor_sensor) == {"EE", "EW"}
