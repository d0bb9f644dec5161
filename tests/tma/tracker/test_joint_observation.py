"""Protects that targets observed together are what they would be alone, and what is counted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.tma.stations.station_pairing import StationPairing
from sonar_tracking.tma.targets.followed_target import FollowedTarget, new_solver
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.joint_observation import Outcome, observe_together

AHEAD = TargetObservation(0, "bow", (0.0, 0.0), (6.0, 0.0), (0.6,), 1e-4)


def at(second: int, target: int) -> TargetObservation:
    """Return what is seen of targets with none, one or two sides and lines, and a wild azimuth."""
    made = replace(AHEAD, stamp=second * 10**9 + 1)
    wild = 1.0 if second in (7, 8, 9) else 0.0
    return [
        replace(made, azimuths=(0.6 + 0.001 * second,)),
        replace(made, azimuths=(1.2, -1.2)),
        replace(made, line_ids=(3, 5), frequencies=(300.0, 200.0), frequency_deviations=(0.1, 0.2)),
        replace(made, azimuths=() if second > 4 else (2.0,), line_ids=(3,), frequencies=(90.0,),
                frequency_deviations=(0.1,)),
        replace(made, azimuths=(-0.4 + wild,)),
    ][target]  # fmt: skip


def another(second: int) -> TargetObservation:
    return replace(AHEAD, stamp=second * 10**9 + 1, sensor_id="stern", position=(4000.0, 500.0),
                   velocity=(0.0, 0.0), azimuths=(2.6,))  # fmt: skip


def observed_by(
    seen: list[tuple[FollowedTarget, TargetObservation]], pairing: StationPairing
) -> list[Outcome]:
    """Return the outcomes in one scene."""
    (outcomes,) = observe_together([(seen, pairing)])
    return outcomes


def alone(*members: str) -> FollowedTarget:
    return FollowedTarget(TargetSolver(), dict.fromkeys(members or ("bow",), 1), 0, 0, 1)


def test_what_is_taken_in_together_is_to_the_last_bit_what_each_takes_in_alone() -> None:
    """Different numbers of sides, hypotheses, lines and stations; one that is lost on the way."""
    together, pairing = [alone() for _ in range(5)], StationPairing(100.0)
    single = [TargetSolver() for _ in range(5)]
    for second in range(12):
        seen = [(target, at(second, index)) for index, target in enumerate(together)]
        if second == 6:
            # Another station splits the hypotheses of the first target.
            observed_by([(together[0], another(6))], pairing)
            single[0].update(another(6))
        outcomes = observed_by(seen, pairing)
        for index, outcome in enumerate(outcomes):
            expected = single[index].update(at(second, index))
            assert isinstance(outcome, tuple)
            assert [one.side for one in outcome] == [one.side for one in expected]
            for found, other in zip(outcome, expected, strict=True):
                np.testing.assert_array_equal(found.mean, other.mean)
                np.testing.assert_array_equal(found.covariance, other.covariance)
                np.testing.assert_array_equal(found.source_frequency, other.source_frequency)
                assert found.probability == other.probability
                assert found.observability == other.observability


def test_scenes_together_are_to_the_last_bit_what_each_is_by_itself() -> None:
    rows = ([0, 2, 4], [1], [3, 1, 0, 2])
    together, apart = ([[alone() for _ in own] for own in rows] for _ in range(2))
    pairings = [[StationPairing(100.0) for _ in rows] for _ in range(2)]
    for second in range(10):
        scenes = [
            ([(one, at(second, row)) for one, row in zip(targets, own, strict=True)], pairing)
            for targets, own, pairing in zip(together, rows, pairings[0], strict=True)
        ]
        found = observe_together(scenes)
        for own, targets, pairing, outcomes in zip(rows, apart, pairings[1], found, strict=True):
            seen = [(one, at(second, row)) for one, row in zip(targets, own, strict=True)]
            for outcome, other in zip(outcomes, observed_by(seen, pairing), strict=True):
                assert isinstance(outcome, tuple) and isinstance(other, tuple)
                for one, expected in zip(outcome, other, strict=True):
                    np.testing.assert_array_equal(one.mean, expected.mean)
                    np.testing.assert_array_equal(one.covariance, expected.covariance)


def test_an_observation_that_is_refused_concerns_its_own_target_only() -> None:
    good, bad = alone(), alone()
    pairing = StationPairing(100.0)
    first, second = observed_by(
        [(bad, replace(AHEAD, azimuth_variance=-1.0)), (good, AHEAD)], pairing
    )
    assert isinstance(first, InputError)
    assert isinstance(second, tuple)
    assert len(second) == 1
    assert (bad.solver.solutions(), bad.updated) == ((), 0)


def test_azimuths_that_nothing_explains_are_counted_where_there_are_several_stations() -> None:
    joined, lone = alone("bow", "stern"), alone()
    pairing = StationPairing(100.0)
    for second in range(3):
        seen = replace(AHEAD, stamp=second * 10**9)
        for target in (joined, lone):
            target.solver.update(seen)
    elsewhere = replace(AHEAD, azimuths=(-2.0,))
    for second, expected in ((4, 1), (5, 2)):
        seen = replace(elsewhere, stamp=second * 10**9)
        observed_by([(joined, seen), (lone, seen)], pairing)
        assert joined.misfits == {"bow": expected}
    silent = replace(AHEAD, stamp=6 * 10**9, azimuths=(), line_ids=(1,), frequencies=(300.0,),
                     frequency_deviations=(1.0,))  # fmt: skip
    observed_by([(joined, silent)], pairing)
    assert joined.misfits == {"bow": 2}, "without an azimuth nothing is judged"
    observed_by([(joined, replace(AHEAD, stamp=7 * 10**9))], pairing)
    assert joined.misfits == {"bow": 0}
    assert lone.misfits == {}


def test_a_station_that_sees_both_targets_of_a_trial_tells_them_apart() -> None:
    old, new = alone("bow"), alone("stern")
    pairing = StationPairing(1.0)
    old.solutions = old.solver.update(AHEAD)
    pairing.begin(new, [old])
    (outcome,) = observed_by([(new, another(1))], pairing)
    assert isinstance(outcome, tuple)
    observed_by([(old, replace(AHEAD, stamp=2 * 10**9)), (new, another(2))], pairing)
    assert pairing.decide(10**9) == ()


@pytest.mark.parametrize("method", ["fused_line", "stacked_lines"])
def test_methods_without_a_bank_take_their_observations_in_one_by_one(method: str) -> None:
    solver = new_solver(TmaTrackerConfiguration(method=method))
    beside, banked = FollowedTarget(solver, {"bow": 1}, 0, 0, 1), alone()
    seen = replace(AHEAD, stamp=1)
    outcomes = observed_by([(beside, seen), (banked, seen)], StationPairing(100.0))
    assert [len(one) for one in outcomes if isinstance(one, tuple)] == [1, 1]


def test_a_refusal_is_told_of_its_own_target_where_trials_take_part_too() -> None:
    old, new, bad = alone("bow"), alone("stern"), alone("keel")
    pairing = StationPairing(1.0)
    old.solutions = old.solver.update(AHEAD)
    pairing.begin(new, [old])
    refused = replace(another(1), azimuth_variance=-1.0)
    first, second = observed_by([(bad, refused), (new, another(1))], pairing)
    assert isinstance(first, InputError)
    assert isinstance(second, tuple)
