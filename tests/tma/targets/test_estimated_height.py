"""Protects the height of a target that turns and dives, from the elevations of the stations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.direction_reports import reported, seen_from
from tests.tma.passive_scene import SECOND, fed, fed_together, listed

WEST, EAST = np.array([0.0, 0.0, -1300.0]), np.array([1500.0, 0.0, -1250.0])
BOTH = {"west": WEST, "east": EAST}
DEVIATION = float(np.radians(0.5))
CONFIGURATION = TmaTrackerConfiguration(
    minimum_range=50.0,
    maximum_range=3000.0,
    maximum_speed=5.0,
    travel_time=False,
    systematic_deviation_deg=0.0,
    sound_speed_variation=0.0,
    target_size=0.0,
)
FOUND_AFTER = 120
"""Frame from which on rows are compared with the truth."""


class Moment(NamedTuple):
    """Where the target is, m, and what is said of it."""

    place: FloatArray
    tracks: PositionTracks


def diving(generator: np.random.Generator, n_frames: int, turn: range) -> FloatArray:
    """Return the path of a target that sinks and climbs, and turns once by 90 degrees, m."""
    place, vertical = np.array([600.0, 900.0, -600.0]), 0.0
    course, path = generator.uniform(0.0, 2.0 * np.pi), []
    for frame in range(n_frames):
        path.append(place)
        course += np.radians(1.0) * (frame in turn)
        vertical = 0.98 * vertical + 0.15 * generator.standard_normal()
        place = place + np.array([2.0 * np.cos(course), 2.0 * np.sin(course), vertical])
    return np.array(path)


def seen_frames(
    stations: Mapping[str, FloatArray],
    seed: int,
    n_frames: int,
    elevation_error: FloatArray | None = None,
) -> tuple[FloatArray, list[PassiveFrame]]:
    """Return where the target is, m, and what the stations tell of it.

    Parameters
    ----------
    elevation_error : ndarray, shape (n_frames,), optional
        Of the elevations of the first station besides their noise, rad.
    """
    generator = np.random.default_rng(seed)
    path = diving(generator, n_frames, range(150, 240))
    frames = []
    for frame, place in enumerate(path):
        stamp = (1000 + frame) * SECOND
        noise = {name: DEVIATION * generator.standard_normal(2) for name in stations}
        if elevation_error is not None:
            noise[next(iter(stations))][1] += elevation_error[frame]
        lists = []
        for name, station in stations.items():
            azimuth, elevation = (seen_from(station, place) + noise[name]).tolist()
            lists.append(reported(name, station, azimuth, elevation, DEVIATION, stamp))
        frames.append(PassiveFrame(stamp, tuple(lists)))
    return path, frames


def followed(
    stations: Mapping[str, FloatArray],
    seed: int,
    n_frames: int = 300,
    configuration: TmaTrackerConfiguration = CONFIGURATION,
    elevation_error: FloatArray | None = None,
) -> list[Moment]:
    """Return what becomes of the target."""
    path, frames = seen_frames(stations, seed, n_frames, elevation_error)
    updates = fed(TmaTrackerStage(configuration, len(stations)), frames)
    return [Moment(place, listed(one)) for place, one in zip(path, updates, strict=True)]


def joint(tracks: PositionTracks) -> bool:
    """Return whether the list has one confirmed row, of both stations."""
    one = len(tracks) == 1 and len(set(tracks.contributor_sensor)) == 2
    return one and tracks.status.tolist() == [TrackStatus.CONFIRMED]


@pytest.mark.slow
def test_two_stations_find_the_height_of_a_target_that_turns_and_dives() -> None:
    """Joined within five minutes; errors as large as said, of position and of height.

    Three runs see half or twice the deviations as five do: their mean squares are the same.
    """
    on_the_plane, upwards = [], []
    runs = [seen_frames(BOTH, seed, 300) for seed in range(3)]
    stages = [TmaTrackerStage(CONFIGURATION, len(BOTH)) for _ in runs]
    together = fed_together(stages, [frames for _, frames in runs])
    for (path, _), updates in zip(runs, together, strict=True):
        moments = [Moment(place, listed(one)) for place, one in zip(path, updates, strict=True)]
        assert any(joint(tracks) for _, tracks in moments)
        for place, tracks in moments[FOUND_AFTER:]:
            if joint(tracks):
                error = tracks.state[0, :2] - place[:2]
                solved = np.linalg.solve(tracks.covariance[0, :2, :2], error)
                on_the_plane.append(error @ solved / 2.0)
                upwards.append((tracks.z[0] - place[2]) / tracks.z_standard_deviation[0])
    assert len(upwards) > 270
    assert np.mean(np.abs(upwards) < 3.0) > 0.99
    assert 0.4 < np.mean(np.square(upwards)) < 1.5
    assert 0.4 < np.mean(on_the_plane) < 1.8


def test_one_station_says_that_the_height_is_as_open_as_the_range() -> None:
    moments = followed({"west": WEST}, 1, 60)
    place, tracks = moments[-1]
    assert tracks.status.tolist() == [TrackStatus.TENTATIVE]
    assert tracks.z_standard_deviation[0] > 100.0
    assert abs(tracks.z[0] - place[2]) < 3.0 * tracks.z_standard_deviation[0]


def test_one_station_and_a_known_range_give_the_height() -> None:
    """A single range hypothesis 100 m wide about the true range of 1082 m, and z = r tan(e)."""
    at_range = TmaTrackerConfiguration(
        minimum_range=1030.0,
        maximum_range=1130.0,
        n_ranges=1,
        maximum_speed=1.0,
        travel_time=False,
        systematic_deviation_deg=0.0,
        sound_speed_variation=0.0,
        target_size=0.0,
    )
    place, tracks = followed({"west": WEST}, 1, 5, at_range)[-1]
    slope = 700.0 / np.hypot(600.0, 900.0)
    assert tracks.z_standard_deviation[0] == pytest.approx(slope * 100.0 / np.sqrt(12.0), rel=0.2)
    assert abs(tracks.z[0] - place[2]) < 3.0 * tracks.z_standard_deviation[0]


def test_a_known_height_is_assumed_and_none_is_unknown() -> None:
    known = TmaTrackerConfiguration(target_height=700.0, travel_time=False)
    _, tracks = followed({"west": WEST}, 1, 3, known)[-1]
    assert tracks.z.tolist() == [-600.0] and np.isnan(tracks.z_standard_deviation).all()
    nothing = np.full(3, np.nan)
    _, tracks = followed({"west": WEST}, 1, 3, elevation_error=nothing)[-1]
    assert np.isnan(tracks.z).all() and np.isnan(tracks.z_standard_deviation).all()


def test_a_height_told_roughly_is_used_and_corrected() -> None:
    """Told 650 m, known to 100 m, where it is 700 m: the elevation then tells the range."""
    roughly = TmaTrackerConfiguration(
        target_height=650.0, target_height_standard_deviation=100.0, travel_time=False
    )
    place, tracks = followed({"west": WEST}, 1, 20, roughly)[-1]
    distance = np.hypot(*place[:2])
    spread = float(np.sqrt(np.max(np.linalg.eigvalsh(tracks.covariance[0, :2, :2]))))
    assert spread == pytest.approx(distance * 100.0 / 700.0, rel=0.3)
    assert abs(np.hypot(*tracks.state[0, :2]) - distance) < 2.0 * spread


@pytest.mark.slow
def test_elevations_that_contradict_the_other_station_end_the_confirmation() -> None:
    """One station's elevations are off by 30 degrees from some time on: found within a minute."""
    start, n_frames = 280, 345
    error = np.where(np.arange(n_frames) < start, 0.0, np.radians(30.0))
    moments = followed(BOTH, 3, n_frames, elevation_error=error)
    assert joint(moments[start - 1].tracks)
    assert not all(joint(tracks) for _, tracks in moments[start : start + 60])
