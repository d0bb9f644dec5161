"""Protects how targets of two stations are found to be one: evidence, rivals, decisions, ends."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.tma.stations.solver_likelihoods import log_likelihoods
from sonar_tracking.tma.stations.station_pairing import StationPairing
from sonar_tracking.tma.stations.station_trials import Trial
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver
from sonar_tracking.tma.tracker.joint_observation import observe_together

PLACES = {"bow": np.array([0.0, 0.0]), "stern": np.array([3000.0, 0.0])}
SHIPS = (np.array([1500.0, 3000.0]), np.array([3500.0, 4000.0]))
SECOND = NOW = 10**9
DEVIATION = np.radians(0.5)
HEIGHT = 500.0
"""Of the ships above the stations: the first one measures elevations, and knows where they are."""


def observation(number: int, sensor: str, ship: int, off: float = 0.0) -> TargetObservation:
    offset = SHIPS[ship] - PLACES[sensor]
    azimuth = float(np.arctan2(offset[1], offset[0])) + off * DEVIATION
    return TargetObservation(
        stamp=number * 10**9,
        sensor_id=sensor,
        position=tuple(PLACES[sensor]),
        velocity=(0.0, 0.0),
        azimuths=(azimuth,),
        azimuth_variance=float(DEVIATION**2),
        elevation=float(np.arctan2(HEIGHT, np.hypot(*offset))) if sensor == "bow" else np.nan,
        elevation_variance=float(DEVIATION**2),
        height=HEIGHT,
    )


def followed(sensor: str, ship: int, frames: int = 5) -> FollowedTarget:
    """Return a target that one station has followed for some seconds."""
    made = FollowedTarget(TargetSolver(), {sensor: ship}, 0, 0, ship)
    for number in range(frames):
        made.solutions = made.solver.update(observation(number, sensor, ship))
    return made


def take_in(pairing: StationPairing, target: FollowedTarget, seen: TargetObservation) -> None:
    ((outcome,),) = observe_together([([(target, seen)], pairing)])
    assert isinstance(outcome, tuple)
    target.solutions = outcome


def watch(
    pairing: StationPairing, target: FollowedTarget, sensor: str, ship: int, frames: range
) -> None:
    for number in frames:
        take_in(pairing, target, observation(number, sensor, ship))


def born(sensor: str = "stern") -> FollowedTarget:
    return FollowedTarget(TargetSolver(), {sensor: 9}, 0, 0, 9)


def test_bearings_of_the_same_ship_make_a_pair_and_a_solution_at_the_crossing() -> None:
    pairing, old, new = StationPairing(10.0), followed("bow", 0), born()
    pairing.begin(new, [old])
    assert pairing.decide(NOW) == ()
    watch(pairing, new, "stern", 0, range(5, 25))
    (pair,) = pairing.decide(NOW)
    assert (pair.first, pair.second) == (old, new)
    (solution,) = pair.solver.solutions()
    assert np.hypot(*(solution.mean[:2] - SHIPS[0])) < 150.0
    pairing.join(pair)
    assert pairing.decide(NOW) == (), "a pair that was made is not made again"


def test_bearings_of_another_ship_give_the_trial_up() -> None:
    """Behind the line of sight of the first no range explains them."""
    pairing, old, new = StationPairing(10.0), followed("bow", 0), born()
    pairing.begin(new, [old])
    for number in range(5, 12):
        seen = TargetObservation(
            number * 10**9, "stern", (3000.0, 0.0), (0.0, 0.0), (-1.5,), float(DEVIATION**2)
        )
        take_in(pairing, new, seen)
    assert pairing.decide(NOW) == ()
    watch(pairing, new, "stern", 0, range(12, 40))
    assert pairing.decide(NOW) == (), "given up"
    assert pairing.decide(NOW + 59 * SECOND) == ()


def test_a_trial_that_failed_is_begun_again_after_longer_pauses_of_90_s_at_most() -> None:
    pairing, old, new = StationPairing(10.0), followed("bow", 0), born()
    pairing.begin(new, [old])
    stamp = NOW
    begun: list[tuple[Trial, int]] = []
    for number in range(5, 350):
        stamp += SECOND
        wrong = TargetObservation(
            number * SECOND, "stern", (3000.0, 0.0), (0.0, 0.0), (-1.5,), float(DEVIATION**2)
        )
        for trial, _ in pairing.concerned([(new, wrong)]):
            trial.evidence -= 1.0
            if trial not in [one for one, _ in begun]:
                begun.append((trial, number))
        assert pairing.decide(stamp) == ()
    agile = [set(trial.alone) == {old, new} for trial, _ in begun]
    assert agile == [False, *[True] * 9]
    pauses = np.diff([number for _, number in begun])
    # Three frames until one fails, then the pause; then one that remembers, and one that does not.
    assert pauses[::2] == pytest.approx(np.zeros(5))
    assert pauses[1::2] == pytest.approx([33.0, 63.0, 93.0, 93.0], abs=2.0)
    pairing.end(old)
    assert not pairing.concerned([(new, wrong)])


def test_errors_that_last_are_no_evidence_while_the_other_is_silent() -> None:
    """Bearings of one target alone say nothing of whether another one is it."""
    pairing = StationPairing(100.0, deviation=float(np.radians(0.5)))
    old, new = followed("bow", 0), born()
    pairing.begin(new, [old])
    for number in range(5, 200):
        off = 1.5 * np.sin(number / 40.0)
        seen = observation(number, "bow", 0, off)
        take_in(pairing, old, seen)
        tried = [trial for trial, _ in pairing.concerned([(old, seen)])]
        assert [trial.evidence for trial in tried] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_trial_that_is_begun_again_forgets_what_one_station_believed() -> None:
    """Of a station at rest alone the range is what is assumed of the motion."""
    pairing, old, new = StationPairing(10.0), followed("bow", 0), born()
    pairing.begin(new, [old])
    for trial, _ in pairing.concerned([(new, observation(5, "stern", 0))]):
        assert trial.solver.state is not None
        trial.evidence = -10.0
    assert pairing.decide(5 * SECOND) == ()
    assert pairing.decide(60 * SECOND) == ()
    again = [one for one, _ in pairing.concerned([(new, observation(60, "stern", 0))])]
    assert [one.solver.state is None for one in again] == [False, True]
    assert all(set(one.alone) == {old, new} for one in again)
    watch(pairing, old, "bow", 0, range(60, 61))
    watch(pairing, new, "stern", 0, range(60, 61))
    (pair,) = pairing.decide(60 * SECOND)
    (solution,) = pair.solver.solutions()
    assert np.hypot(*(solution.mean[:2] - SHIPS[0])) < 150.0


def test_what_a_station_tells_apart_is_not_tried_again() -> None:
    pairing, old, new = StationPairing(10.0), followed("bow", 0), born()
    pairing.begin(new, [old])
    seen = observation(5, "bow", 0)
    pairing.concerned([(old, seen), (new, seen)])
    for number in range(200):
        assert pairing.decide(NOW + number * SECOND) == ()
    assert not pairing.concerned([(new, seen)])


def test_of_two_rivals_the_better_one_must_lead_by_the_odds() -> None:
    pairing, new = StationPairing(10.0), born()
    olds = [followed("bow", 0), followed("bow", 0)]
    pairing.begin(new, olds)
    watch(pairing, new, "stern", 0, range(5, 25))
    assert pairing.decide(NOW) == (), "both fit equally well"
    pairing.end(olds[1])
    (pair,) = pairing.decide(NOW)
    assert pair.first is olds[0]


def test_targets_that_share_a_station_are_never_tried() -> None:
    pairing, old, new = StationPairing(10.0), followed("bow", 0), born("bow")
    pairing.begin(new, [old])
    silent = born()
    pairing.begin(silent, [born("bow")])  # nothing is known of it yet
    watch(pairing, new, "bow", 0, range(5, 25))
    watch(pairing, silent, "stern", 0, range(25, 45))
    assert pairing.decide(NOW) == ()


@pytest.mark.slow
@pytest.mark.parametrize("odds", [10.0, 1e4])
def test_evidence_is_the_ratio_of_densities_with_a_hundredth_of_wild_bearings(odds: float) -> None:
    """Decided as soon as the sum of its logarithms exceeds the odds, by hand."""
    pairing, old, new = StationPairing(odds), followed("bow", 0), born()
    pairing.begin(new, [old])
    together, evidence = old.solver, 0.0
    assert isinstance(together, TargetSolver)
    together = together.copy()
    chance = np.log(1.0 / (2.0 * np.pi))

    def density(solver: TargetSolver, seen: TargetObservation) -> float:
        likely = np.log(0.99) + log_likelihoods([(solver, seen)])[0]
        return float(np.logaddexp(likely, np.log(0.01) + chance))

    decided = False
    for number in range(5, 30):
        seen = observation(number, "stern", 0)
        together.expect(seen)
        own = chance if not new.solutions else density(new.solver, seen)  # type: ignore[arg-type]
        evidence += density(together, seen) - own
        together.update(seen)
        take_in(pairing, new, seen)
        decided = bool(pairing.decide(NOW))
        assert decided == (evidence >= np.log(odds))
        if decided:
            break
    assert decided or odds > 100.0
