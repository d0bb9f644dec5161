"""Protects the limit that documents state: when the ideal detector notices a turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.mismatch_positions.motions import TURN_START, turning_scene
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaScene, simulate_runs, true_states
from sonar_tracking.tma.performance.ideal_turn_detector import turn_deflection

PRIOR = np.diag([1e4, 1e4, 11.5, 11.5]) ** 2
ALARM = 4.0


def deflection(scene: TmaScene, turns: bool = True) -> FloatArray:
    """Return that of the scene's turn, seen by its own sensor."""
    commanded = scene.commanded if turns else np.zeros_like(scene.commanded)
    exact = replace(scene, azimuth_deviation=0.0, frequency_deviation=0.0, acceleration=0.0)
    runs = simulate_runs(replace(exact, commanded=commanded), [np.random.SeedSequence(1)])
    still = replace(exact, commanded=np.zeros_like(scene.commanded))
    straight = true_states(still, np.zeros((len(scene.times), 2)))
    frames = replace(runs, scene=scene).frames()
    return turn_deflection(straight, scene.line_frequency, frames, PRIOR, scene.acceleration)


@pytest.mark.parametrize(("rate", "after"), [(3.0, 31), (-3.0, 60), (1.0, 60), (-1.0, 91)])
def test_turns_without_tonals_are_noticed_as_late_as_documents_say(rate: float, after: int) -> None:
    found = deflection(turning_scene(own_ship_turns=True, rate_deg=rate, lines=0))
    assert np.all(found[: TURN_START + 1] < 1e-3)
    assert np.all(np.diff(found) >= 0.0)
    noticed = int(np.argmax(found > ALARM)) - TURN_START
    assert noticed == pytest.approx(after, abs=1)


def test_a_tonal_tells_of_a_turn_within_half_a_minute() -> None:
    found = deflection(turning_scene(own_ship_turns=True, rate_deg=1.0, lines=1))
    assert np.argmax(found > ALARM) < TURN_START + 30


def test_without_a_turn_there_is_nothing_to_notice() -> None:
    scene = turning_scene(own_ship_turns=True, rate_deg=3.0, lines=1)
    assert np.max(deflection(scene, turns=False)) < 1e-3
