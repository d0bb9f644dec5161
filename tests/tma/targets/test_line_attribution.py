"""Protects to which track a line goes that names none: the nearest in angle; to none in doubt."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.records.bearings import Sensor
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


def test_scores_fade_and_the_lead_must_be_twenty_to_one_over_the_frames() -> None:
    """The log likelihood by hand: 0.9 of the past and 0.1 of the frame, times frames up to ten."""
    sequence = [14.5, 14.8, 14.2, 15.1, 14.6, 14.4, 14.9, 14.3, 14.7, 14.5, 14.4, 14.6, 14.2, 14.9]
    attribution, means = LineAttribution(4.0), {3: 0.0, 8: 0.0}
    for number, angle in enumerate(sequence, start=1):
        fits = {}
        for track, place in ((3, 10.0), (8, 20.0)):
            squared = min((angle - place) ** 2 / 2.0, 26.0)
            fits[track] = -0.5 * squared
            fresh = fits[track] if number == 1 else means[track]
            means[track] = 0.9 * fresh + 0.1 * fits[track]
        lead = min(number, 10) * (means[3] - means[8])
        near = (angle - 10.0) ** 2 / 2.0 <= 16.0
        expected = 3 if lead >= np.log(20.0) and near else 0
        assert attribution.update(lines(angle), TRACKS) == [expected]


def test_the_gate_is_that_of_the_difference() -> None:
    """Two errors of a degree: four deviations are 5.66 deg."""
    only = {3: TRACKS[3]}
    assert LineAttribution(4.0).update(lines(15.6), only) == [3]
    assert LineAttribution(4.0).update(lines(4.4), only) == [3]
    assert LineAttribution(4.0).update(lines(15.7), only) == [0]


@pytest.mark.parametrize(("variance", "used"), [(9.9, True), (10.0, False), (0.0, False)])
def test_an_angle_that_says_nothing_is_not_used(variance: float, used: bool) -> None:
    found = LineAttribution(4.0).update(lines(10.0, variance=variance), {3: TRACKS[3]})
    assert found == [3 if used else 0]
    turn = lines(10.0 + 360.0 * 1.01)
    assert LineAttribution(4.0).update(turn, {3: TRACKS[3]}) == [0]


@pytest.mark.parametrize(("silence", "remembered"), [(600, True), (601, False)])
def test_a_line_silent_for_ten_minutes_is_forgotten(silence: int, remembered: bool) -> None:
    attribution = LineAttribution(4.0)
    for _ in range(10):
        attribution.update(lines(10.0), TRACKS)
    later = replace(lines(11.0, 20.0), line_id=np.array([2, 5], dtype=np.uint64))
    stamp = lines(10.0).stamp + silence * 10**9
    attribution.update(replace(later, stamp=stamp), TRACKS)
    # A wild angle does not move a line that is remembered, and is all that is known of another.
    assert attribution.update(replace(lines(20.0), stamp=stamp), TRACKS) == [0 if remembered else 8]


def test_stations_do_not_share_their_lines() -> None:
    attribution = LineAttribution(4.0)
    for _ in range(10):
        attribution.update(lines(10.0), TRACKS)
    other = replace(lines(20.0), sensor=Sensor("stern"))
    assert attribution.update(other, TRACKS) == [8]


def test_of_two_tracks_in_one_direction_the_one_known_better_gets_the_line() -> None:
    """The density of an angle is higher where the track is sharper: ln(17 / 2) / 2 a frame."""
    blurred = TrackAngle(TRACKS[3].angle, 16.0 * VARIANCE)
    attribution = LineAttribution(4.0)
    found = [attribution.update(lines(10.0), {3: TRACKS[3], 8: blurred})[0] for _ in range(4)]
    assert found == [0, 0, 3, 3]


def test_an_angle_far_from_all_tracks_prefers_none() -> None:
    """Both squares, 153 and 28, count as 4^2 + 10: then 10 deg leads by 1.3 and by 2.47 a frame.

    Of 20 deg they are 50, and count as 26, too: 2 x 1.3 is below ln 20 = 3.0, 3 x 2.47 above.
    """
    attribution = LineAttribution(4.0)
    found = [attribution.update(lines(angle), TRACKS)[0] for angle in (27.5, 10.0, 10.0)]
    assert found == [0, 0, 3]
