"""Protects what is said of turns that are not seen: as the ideal detector finds, frame by frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.performance.ideal_turn_detector import turn_deflection
from sonar_tracking.tma.performance.unseen_turn import LONGEST, NOTICED, Watch, unseen_for

SOUND_SPEED = 1500.0
MEAN = np.array([3000.0, 4000.0, -2.0, 1.0])
PRIOR = np.diag([150.0, 150.0, 0.3, 0.3]) ** 2
OWN = Watch((0.0, 0.0), (5.0, 0.0), float(np.radians(0.5)), 1.0)
TONAL = Watch((0.0, 0.0), (5.0, 0.0), float(np.radians(0.5)), 1.0, (300.0,), (0.1,), SOUND_SPEED)


def by_steps(watch: Watch, side: float) -> float:
    """Return when the sequential detector notices a turn at 60 s, in small steps of motion."""
    lines = np.array(watch.frequencies)
    state, straight, frames, step = MEAN.copy(), [], [], 1.0
    state[:2] -= 60.0 * MEAN[2:]
    for k in range(361):
        own = np.array(watch.position) + np.array(watch.velocity) * (k - 60.0)
        offset = state[:2] - own
        rate = offset @ (state[2:] - watch.velocity) / np.hypot(*offset)
        frames.append(
            TmaMeasurement(
                stamp=(k + 1) * 10**9,
                position=own,
                velocity=np.array(watch.velocity),
                azimuth=np.arctan2(offset[1], offset[0])[None],
                azimuth_variance=np.array(watch.azimuth_deviation**2),
                frequency=lines * (1.0 - rate / SOUND_SPEED),
                frequency_deviation=np.array(watch.frequency_deviations),
                sound_speed=SOUND_SPEED,
            )
        )
        straight.append(np.concatenate([MEAN[:2] + (k - 60.0) * MEAN[2:], MEAN[2:]]))
        for _ in range(20):
            if 60.0 <= k < 90.0:
                angle = side * np.radians(3.0) * step / 20.0
                turn = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
                state[2:] = np.array(turn) @ state[2:]
            state[:2] += step / 20.0 * state[2:]
    back = np.eye(4)
    back[0, 2] = back[1, 3] = -60.0
    found = turn_deflection(
        np.array(straight), lines, frames, back @ PRIOR @ back.T, acceleration=0.0
    )
    noticed = found > NOTICED
    return float(np.argmax(noticed)) - 60.0 if noticed.any() else LONGEST


@pytest.mark.slow
@pytest.mark.parametrize("watch", [OWN, TONAL])
def test_it_is_the_worse_side_of_what_the_sequential_detector_finds(watch: Watch) -> None:
    sides = [by_steps(watch, side) for side in (1.0, -1.0)]
    assert unseen_for(MEAN, PRIOR, [watch]) == pytest.approx(max(sides), abs=4.0)


def test_a_tonal_a_second_station_and_elevations_tell_sooner_and_what_rests_cannot_turn() -> None:
    alone = unseen_for(MEAN, PRIOR, [OWN])
    assert 20.0 < alone < LONGEST
    assert unseen_for(MEAN, PRIOR, [TONAL]) < 0.6 * alone
    beside = Watch((6000.0, 4000.0), (0.0, 0.0), float(np.radians(0.5)), 4.0)
    assert unseen_for(MEAN, PRIOR, [OWN, beside]) < alone
    raised = replace(OWN, height=1000.0, elevation_deviation=float(np.radians(0.5)))
    assert unseen_for(MEAN, PRIOR, [raised]) < alone
    resting = np.array([3000.0, 4000.0, 0.0, 0.0])
    assert unseen_for(resting, PRIOR, [OWN]) == LONGEST
