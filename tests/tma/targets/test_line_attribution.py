"""Protects to which track a line goes that names none: the nearest in angle; to none in doubt."""

import numpy as np
import pytest

from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.tma.targets.line_attribution import LineAttribution, TrackAngle

VARIANCE = np.radians(1.0) ** 2
TRACKS = {3: TrackAngle(np.radians(10.0), VARIANCE), 8: TrackAngle(np.radians(20.0), VARIANCE)}


def lines(*angles_deg: float, track: int = 0, variance: float = VARIANCE) -> FrequencyLines:
    count = len(angles_deg)
    unknown = np.full(count, np.nan)
    return FrequencyLines(
        stamp=10**18,
        track_id=np.full(count, track, np.uint64),
        arrival_angle=np.radians(angles_deg),
        arrival_angle_variance=np.full(count, variance),
        line_id=np.arange(1, count + 1, dtype=np.uint64),
        frequency=np.full(count, 200.0),
        standard_deviation=np.full(count, 0.1),
        signal_to_noise_ratio=unknown,
        integration_time=unknown,
    )


def test_each_line_goes_to_the_track_in_its_direction() -> None:
    assert LineAttribution(4.0).update(lines(10.5, 19.5), TRACKS) == [3, 8]


def test_a_line_from_elsewhere_or_of_unknown_direction_is_unassociated() -> None:
    assert LineAttribution(4.0).update(lines(40.0, np.nan), TRACKS) == [0, 0]
    assert LineAttribution(4.0).update(lines(10.0, variance=-1.0), TRACKS) == [0]
    assert LineAttribution(4.0).update(lines(10.0), {}) == [0]


def test_a_line_that_names_its_track_keeps_it() -> None:
    assert LineAttribution(4.0).update(lines(10.0, track=8), TRACKS) == [8]


def test_between_two_tracks_time_decides() -> None:
    """A line midway is unassociated; a slight preference adds up over frames."""
    midway, nearer = LineAttribution(4.0), LineAttribution(4.0)
    for _ in range(30):
        assert midway.update(lines(15.0), TRACKS) == [0]
    found = [nearer.update(lines(14.5), TRACKS)[0] for _ in range(30)]
    assert found[0] == 0 and found[-1] == 3


def test_one_wild_angle_does_not_move_a_line_to_another_track() -> None:
    attribution = LineAttribution(4.0)
    for _ in range(10):
        assert attribution.update(lines(10.0), TRACKS) == [3]
    assert attribution.update(lines(20.0), TRACKS) == [0]
    assert attribution.update(lines(10.0), TRACKS) == [3]


@pytest.mark.parametrize("sensor_frames", [1, 12])
def test_a_track_that_is_new_is_judged_by_its_own_frames(sensor_frames: int) -> None:
    attribution = LineAttribution(4.0)
    for _ in range(sensor_frames):
        attribution.update(lines(10.0), {3: TRACKS[3]})
    assert attribution.update(lines(10.0), TRACKS) == [3]
