"""Runs under one condition: the same measurements for every system, and what it made of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.evaluation.offline.offline_fusion_chain import (
    FusedMoment,
    fused_moments_together,
    make_track_fusion,
)
from sonar_tracking.evaluation.offline.place_tracks import ECHOES, POSITIONS
from sonar_tracking.evaluation.studies.track_fusion.central_filter import (
    CentralFilters,
    ToldMoment,
    told_moment,
)
from sonar_tracking.evaluation.studies.track_fusion.conditions import CONDITIONS, Condition
from sonar_tracking.evaluation.studies.track_fusion.held_rows import NEAR, HeldRows
from sonar_tracking.evaluation.studies.track_fusion.list_rules import RULES
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import established
from sonar_tracking.records.positions import PositionTracks, TruthTracks
from sonar_tracking.records.time import seconds
from sonar_tracking.simulation.scenarios.scenario import Scenario

FUSED, CENTRAL, BOUND = "track_fusion", "central filter, told whose all is", "bound"
ECHOES_ALONE, BEARINGS_ALONE = "echoes alone", "bearings alone"
SYSTEMS = (CENTRAL, FUSED, *RULES, ECHOES_ALONE, BEARINGS_ALONE, BOUND)

SETTLED = 100.0
"""Rows count from here on, s."""


@dataclass(frozen=True)
class FusionTask:
    """Runs that are computed together.

    Attributes
    ----------
    conditions : tuple of str
        Names of conditions of the same sea.
    seeds : tuple of numpy.random.SeedSequence
        One a run.
    """

    conditions: tuple[str, ...]
    seeds: tuple[np.random.SeedSequence, ...]


@dataclass
class FusionRun:
    """What the systems did in one run.

    Attributes
    ----------
    condition : str
        Name of the condition.
    squares, nees, claimed : dict of str to list of float
        Of each system: squared position errors, m^2; normalised errors of the state, per
        dimension; claimed variances of the position, m^2.
    doubled : bool
        Whether a ship had two confirmed rows of the fused list for too long.
    names : int
        Identifiers that the ships had in the fused list, beyond one each.
    missing, rows : int
        Ships without a row, and ships, over all pings.
    alignment_error, alignment_deviation : float
        Of the array on own ship at the end, rad.
    """

    condition: str
    squares: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    nees: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    claimed: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    doubled: bool = False
    names: int = 0
    missing: int = 0
    rows: int = 0
    alignment_error: float = np.nan
    alignment_deviation: float = np.nan

    def count(self, system: str, truth: FloatArray, mean: FloatArray, spread: FloatArray) -> None:
        """Count an estimate of a ship: true state, mean, shapes (4,), covariance, shape (4, 4)."""
        error = mean - truth
        self.squares[system].append(float(error[:2] @ error[:2]))
        self.nees[system].append(float(error @ np.linalg.solve(spread, error)) / len(error))
        self.claimed[system].append(float(np.trace(spread[:2, :2])))


@dataclass(frozen=True)
class _FollowedRun:
    """A run as it was fused.

    Attributes
    ----------
    run : FusionRun
        What was counted so far.
    moments : list of ToldMoment
        What the filters that are told whose all is take in, stamp by stamp.
    counted : list of dict of int to ndarray, shape (4,)
        True states of the ships that count at each of these stamps, x, y, vx, vy, m and m/s.
    """

    run: FusionRun
    moments: list[ToldMoment]
    counted: list[dict[int, FloatArray]]


def fusion_runs(task: FusionTask) -> tuple[FusionRun, ...]:
    """Simulate runs, fuse them in every way under each condition, and score them."""
    sea = CONDITIONS[task.conditions[0]]
    scenarios = [sea.scenario(seed) for seed in task.seeds]
    found = [list(moments) for moments in fused_moments_together(scenarios)]
    return tuple(run for name in task.conditions for run in _fused_runs(name, scenarios, found))


def _fused_runs(
    name: str, scenarios: Sequence[Scenario], found: Sequence[Sequence[FusedMoment]]
) -> list[FusionRun]:
    """Return what the systems did under one condition, from what the trackers found."""
    every = zip(scenarios, found, strict=True)
    followed = [_followed_run(name, *each) for each in every]
    configuration = make_track_fusion(scenarios[0]).configuration
    for system, exact in ((CENTRAL, False), (BOUND, True)):
        filters = CentralFilters(configuration, len(followed), exact)
        for place, moments in enumerate(zip(*(one.moments for one in followed), strict=True)):
            filters.update(moments)
            for number, one in enumerate(followed):
                true = one.counted[place]
                states = filters.states(number) if true else {}
                for ship in set(true) & set(states):
                    one.run.count(system, true[ship], *states[ship])
    return [one.run for one in followed]


def _followed_run(name: str, scenario: Scenario, moments: Iterable[FusedMoment]) -> _FollowedRun:
    """Fuse a run, and score it but for the filters that are told whose all is.

    Parameters
    ----------
    name : str
        Of the condition.
    scenario : Scenario
        Of the run.
    moments : iterable of FusedMoment
        What its trackers found.
    """
    condition = CONDITIONS[name]
    stage = make_track_fusion(scenario)
    run = FusionRun(name)
    followed = _FollowedRun(run, [], [])
    held = HeldRows()
    arrays: dict[str, int] = {}
    latest: PositionTracks | None = None
    for moment in moments:
        heard = _without_lost(moment, condition, seconds(moment.frame.stamp - scenario.epoch))
        if not (heard.frame.active or heard.frame.bearings):
            continue
        update = stage.update(heard.frame)
        followed.moments.append(told_moment(heard, arrays, stage.configuration))
        followed.counted.append({})
        latest = heard.frame.passive.get(POSITIONS, latest)
        time = seconds(moment.frame.stamp - scenario.epoch)
        if moment.contacts is None:
            continue
        seen = _count_fused(run, update.tracks, heard.truth, time, held)
        if time >= SETTLED:
            true = _true_states(heard.truth)
            followed.counted[-1].update((ship, true[ship]) for ship in seen)
            _count_lists(run, heard, latest)
    run.names, run.doubled = sum(len(own) - 1 for own in held.names.values()), held.doubled
    known = update.alignments
    place = known.sensor_id.index("array")
    turned = np.radians(condition.misalignment_deg)
    run.alignment_error = float(known.misalignment[place] - turned)
    run.alignment_deviation = float(known.misalignment_standard_deviation[place])
    return followed


def _without_lost(moment: FusedMoment, condition: Condition, time: float) -> FusedMoment:
    """Return a moment without the source that is lost then."""
    frame = moment.frame
    if condition.silent_sonar[0] <= time < condition.silent_sonar[1]:
        frame = replace(frame, active={})
    if condition.silent_array[0] <= time < condition.silent_array[1]:
        frame = replace(frame, bearings=(), passive={})
    return moment if frame is moment.frame else replace(moment, frame=frame)


def _true_states(truth: TruthTracks) -> dict[int, FloatArray]:
    states = np.concatenate([truth.position, truth.velocity], axis=1)
    return dict(zip(truth.id.tolist(), states, strict=True))


def _count_fused(
    run: FusionRun, tracks: PositionTracks, truth: TruthTracks, time: float, held: HeldRows
) -> set[int]:
    """Count the established rows of the fused list, and return the ships that have one."""
    settled = time >= SETTLED
    pairs = held.take(tracks, truth, time, settled)
    ships = {ship for ship, _ in pairs}
    if settled:
        states = _true_states(truth)
        for ship, row in pairs:
            run.count(FUSED, states[ship], tracks.state[row], tracks.covariance[row])
        run.rows += len(truth.id)
        run.missing += len(truth.id) - len(ships)
    return ships


def _count_lists(run: FusionRun, moment: FusedMoment, passive: PositionTracks | None) -> None:
    """Count the finished tracks of both lists, and what rules make of two of one ship."""
    states = _true_states(moment.truth)
    active = moment.frame.active.get(ECHOES)
    echoes: dict[int, KalmanState] = {}
    if active is not None:
        for row in np.flatnonzero(established(active.status)):
            ship = _nearest(active.state[row], moment.truth)
            if ship is not None:
                echoes[ship] = KalmanState(active.state[row], active.covariance[row])
    heard: dict[int, KalmanState] = {}
    if passive is not None and passive.stamp == moment.frame.stamp:
        for row in np.flatnonzero(established(passive.status)):
            ship = int(passive.bearing_track_id[row])
            heard[ship] = KalmanState(passive.state[row], passive.covariance[row])
    for ship, true in states.items():
        for system, own in ((ECHOES_ALONE, echoes), (BEARINGS_ALONE, heard)):
            if ship in own:
                run.count(system, true, own[ship].mean, own[ship].covariance)
        if ship not in echoes:
            continue
        for system, rule in RULES.items():
            fused = rule(echoes[ship], heard[ship]) if ship in heard else echoes[ship]
            run.count(system, true, fused.mean, fused.covariance)


def _nearest(state: FloatArray, truth: TruthTracks) -> int | None:
    """Return the number of the ship that a state is of."""
    apart = truth.position - state[:2]
    distance = np.hypot(apart[:, 0], apart[:, 1])
    nearest = int(np.argmin(distance))
    return int(truth.id[nearest]) if distance[nearest] < NEAR else None
