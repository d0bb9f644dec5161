"""From element time series to positions: nothing but the samples says where the target is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.metrics.bearing_score import score_bearing_tracks
from sonar_tracking.evaluation.offline.offline_sample_chain import (
    OfflineSampleRun,
    run_offline_sample_chain,
)
from sonar_tracking.motion import emission_times
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

LOCALISED_FROM = 270.0
"""s: the second leg of own ship has lasted long enough."""


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("tonals")


@pytest.fixture(scope="module")
def run(scenario: Scenario) -> OfflineSampleRun:
    return run_offline_sample_chain(scenario)


def received_frequencies(scenario: Scenario, time: float, number: int = 0) -> np.ndarray:
    """Return the frequencies of a target's lines at the array, by the rate of emission times."""
    target, receiver = scenario.targets[number], scenario.receiver()
    assert isinstance(target.motion, KinematicMotion)
    times = time + np.array([-0.01, 0.01])
    places = receiver.trajectory.state(times).position
    emitted = emission_times(target.motion.trajectory, places, times, receiver.sound_speed)
    dilation = np.diff(emitted)[0] / 0.02
    return dilation * np.array([line.frequency for line in target.lines])


def test_bearings_come_from_the_band_of_one_line(run: OfflineSampleRun) -> None:
    score = score_bearing_tracks([block.truth_bearings for block in run.blocks], run.bearings)
    assert score.rmse_deg < 0.25
    assert score.identities.false_tracks == 0 and score.identities.lost_tracks == 0


def test_lines_have_the_frequencies_that_doppler_gives_them(
    scenario: Scenario, run: OfflineSampleRun
) -> None:
    """Errors over claimed deviations have mean square 1; nothing else is taken for a line."""
    squares, heard = [], 0
    for lines in run.lines:
        truth = received_frequencies(scenario, (lines.stamp - scenario.epoch) / 1e9)
        errors = lines.frequency[:, None] - truth
        nearest = np.abs(errors).argmin(axis=1)
        errors = errors[np.arange(len(nearest)), nearest]
        assert (np.abs(errors) < 0.5).all()
        squares.extend((errors / lines.standard_deviation) ** 2)
        heard += len(errors)
    assert np.mean(squares) == pytest.approx(1.0, abs=0.15)
    assert heard > 0.9 * 2.8 * len(run.lines)


def test_a_line_that_pauses_and_those_that_do_not_keep_their_names(
    scenario: Scenario, run: OfflineSampleRun
) -> None:
    """80 s of silence end a line: it comes back under a new name."""
    nominal = np.array([line.frequency for line in scenario.targets[0].lines])
    names: list[set[int]] = [set() for _ in nominal]
    for lines in run.lines:
        nearest = np.abs(lines.frequency[:, None] - nominal).argmin(axis=1)
        for name, index in zip(lines.line_id, nearest, strict=True):
            names[index].add(int(name))
    assert [len(each) for each in names] == [1, 1, 2]


def test_the_target_is_localised_from_samples_alone(run: OfflineSampleRun) -> None:
    """About 3 km away, after one turn of own ship: within 100 m, on the right side."""
    truth = {block.truth_tracks.stamp: block.truth_tracks for block in run.blocks}
    begin = run.blocks[0].samples.stamp
    errors = []
    for tracks in run.positions:
        if tracks.stamp - begin < LOCALISED_FROM * 1e9:
            continue
        assert len(tracks.id) == 1 and tracks.status[0] == TrackStatus.CONFIRMED
        position = truth[tracks.stamp].position[0]
        errors.append(np.linalg.norm(tracks.state[0, :2] - position))
        assert tracks.observability[0] > 0.9
    assert len(errors) > 120
    assert np.median(errors) < 60.0 and np.max(errors) < 200.0


def test_every_frame_has_a_list_and_the_end_is_passed_on(run: OfflineSampleRun) -> None:
    assert len(run.lines) == len(run.rows) + 1
    assert {line.next_stamp - line.stamp for line in run.lines[:-1]} == {1_000_000_000}
    assert run.lines[-1].next_stamp == END_OF_DATA
    assert run.bearings[-1].next_stamp == END_OF_DATA


def test_two_targets_get_their_own_lines(scenario: Scenario) -> None:
    """50 degrees apart, their tonals 1.5 Hz apart in the band that both bearings come from."""
    freighter = scenario.targets[0]
    assert isinstance(freighter.motion, KinematicMotion)
    ferry = replace(
        freighter,
        name="ferry",
        lines=tuple(
            replace(freighter.lines[0], frequency=frequency) for frequency in (215.0, 301.5, 340.0)
        ),
        motion=replace(freighter.motion, position=(3500.0, -500.0), course_deg=340.0, speed=4.0),
    )
    scene = replace(scenario, targets=(freighter, ferry), duration=90.0)
    both = run_offline_sample_chain(scene)
    last = both.bearings[-1]
    first, second = last.id[np.argsort(last.arrival_angle)]  # the freighter is farther aft
    heard = 0
    for lines in both.lines[-40:-1]:
        time = (lines.stamp - scene.epoch) / 1e9
        for number, track in enumerate((first, second)):
            own = lines.frequency[lines.track_id == track]
            error = own[:, None] - received_frequencies(scene, time, number)
            assert (np.min(np.abs(error), axis=1) < 0.5).all()
            heard += len(own)
    assert heard > 0.8 * 6 * 39
