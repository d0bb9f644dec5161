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
from sonar_tracking.evaluation.studies.track_fusion.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.track_fusion.held_rows import NEAR, HeldRows
from sonar_tracking.evaluation.studies.track_fusion.list_rules import RULES
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.fusion_records import FusionUpdate
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import update_together
from sonar_tracking.records.alignments import ArrayAlignments
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


_Estimate = tuple[FloatArray, FloatArray]
"""Error of a state, shape (4,), and its claimed covariance, shape (4, 4); m and m/s, squared."""


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

    _uncounted: dict[str, list[_Estimate]] = field(
        default_factory=lambda: defaultdict(list), repr=False
    )

    def count(self, system: str, truth: FloatArray, mean: FloatArray, spread: FloatArray) -> None:
        """Note an estimate of a ship.

        Parameters
        ----------
        system : str
            Whose.
        truth, mean : ndarray, shape (4,)
            x, y, vx, vy, m and m/s.
        spread : ndarray, shape (4, 4)
            Claimed covariance, in these units squared.
        """
        self._uncounted[system].append((mean - truth, spread))

    def conclude(self) -> None:
        """Count all estimates that have been noted."""
        for system, noted in self._uncounted.items():
            error = np.array([one for one, _ in noted])
            spread = np.array([one for _, one in noted])
            solved = np.linalg.solve(spread, error[..., None])
            place = error[:, None, :2]
            self.squares[system] = (place @ place.swapaxes(-1, -2)).ravel().tolist()
            self.nees[system] = ((error[:, None] @ solved).ravel() / error.shape[1]).tolist()
            self.claimed[system] = (spread[:, 0, 0] + spread[:, 1, 1]).tolist()
        self._uncounted.clear()


def fusion_runs(task: FusionTask) -> tuple[FusionRun, ...]:
    """Simulate runs, fuse them in every way under each condition, and score them."""
    seas = list(dict.fromkeys(CONDITIONS[name].heard for name in task.conditions))
    scenarios = [[sea.scenario(seed) for seed in task.seeds] for sea in seas]
    configuration = make_track_fusion(scenarios[0][0]).configuration
    moments = iter(fused_moments_together([one for own in scenarios for one in own]))
    found = [[_told_moments(next(moments), configuration) for _ in own] for own in scenarios]
    places = [seas.index(CONDITIONS[name].heard) for name in task.conditions]
    every = [
        [_FollowedRun(name, scenario) for scenario in scenarios[place]]
        for name, place in zip(task.conditions, places, strict=True)
    ]
    fed = [one for runs in every for one in runs]
    for instant in zip(*(one for place in places for one in found[place]), strict=True):
        _follow(list(zip(fed, instant, strict=True)))
    for runs in _reporting_alike(fed):
        _follow_as_told(runs, configuration)
    for run in fed:
        run.conclude()
    return tuple(one.run for one in fed)


def _reporting_alike(every: Sequence[_FollowedRun]) -> list[list[_FollowedRun]]:
    """Return runs together in which the same stations report at the same stamps."""
    alike: dict[tuple[tuple[int, tuple[int, ...]], ...], list[_FollowedRun]] = {}
    for run in every:
        alike.setdefault(tuple((one.stamp, one.arrays) for one in run.moments), []).append(run)
    return list(alike.values())


def _told_moments(
    moments: Iterable[FusedMoment], configuration: TrackFusionConfiguration
) -> list[tuple[FusedMoment, ToldMoment]]:
    """Return what trackers found in a run, each moment with what was received of which ship."""
    arrays: dict[str, int] = {}
    return [(one, told_moment(one, arrays, configuration)) for one in moments]


def _follow(every: Sequence[tuple[_FollowedRun, tuple[FusedMoment, ToldMoment]]]) -> None:
    """Fuse what was found in some runs at one instant, all at once, and score it."""
    heard = [(run, *run.heard_of(*found)) for run, found in every]
    fed = [one for one in heard if one[1].frame.active or one[1].frame.bearings]
    frames = [moment.frame for _, moment, _ in fed]
    updates = update_together([run.stage for run, _, _ in fed], frames)
    for (run, moment, told), update in zip(fed, updates, strict=True):
        run.count(moment, told, update)


def _follow_as_told(runs: Sequence[_FollowedRun], configuration: TrackFusionConfiguration) -> None:
    """Score the filters that are told whose all is, in runs that report alike."""
    for system, exact in ((CENTRAL, False), (BOUND, True)):
        filters = CentralFilters(configuration, len(runs), exact)
        for place, moments in enumerate(zip(*(one.moments for one in runs), strict=True)):
            filters.update(moments)
            for number, one in enumerate(runs):
                true = one.counted[place]
                states = filters.states(number) if true else {}
                for ship in set(true) & set(states):
                    one.run.count(system, true[ship], *states[ship])


class _FollowedRun:
    """A run as it is fused.

    Parameters
    ----------
    name : str
        Of the condition.
    scenario : Scenario
        Of the run.

    Attributes
    ----------
    run : FusionRun
        What was counted so far.
    stage : TrackFusionStage
        That fuses it.
    moments : list of ToldMoment
        What the filters that are told whose all is take in, stamp by stamp.
    counted : list of dict of int to ndarray, shape (4,)
        True states of the ships that count at each of these stamps, x, y, vx, vy, m and m/s.
    """

    def __init__(self, name: str, scenario: Scenario) -> None:
        self.run = FusionRun(name)
        self.stage = make_track_fusion(scenario)
        self.moments: list[ToldMoment] = []
        self.counted: list[dict[int, FloatArray]] = []
        self._epoch = scenario.epoch
        self._held = HeldRows()
        self._latest: PositionTracks | None = None
        self._alignments: ArrayAlignments | None = None

    def heard_of(self, moment: FusedMoment, told: ToldMoment) -> tuple[FusedMoment, ToldMoment]:
        """Return a moment without the source that is lost then."""
        condition = CONDITIONS[self.run.condition]
        time = seconds(moment.frame.stamp - self._epoch)
        frame = moment.frame
        if condition.silent_sonar[0] <= time < condition.silent_sonar[1]:
            frame, told = replace(frame, active={}), replace(told, echoes=())
        if condition.silent_array[0] <= time < condition.silent_array[1]:
            frame = replace(frame, bearings=(), passive={})
            told = replace(told, heard=(), arrays=())
        return (moment if frame is moment.frame else replace(moment, frame=frame)), told

    def count(self, heard: FusedMoment, told: ToldMoment, update: FusionUpdate) -> None:
        """Score a moment but for the filters that are told whose all is."""
        self.moments.append(told)
        self.counted.append({})
        self._latest = heard.frame.passive.get(POSITIONS, self._latest)
        self._alignments = update.alignments
        time = seconds(heard.frame.stamp - self._epoch)
        if heard.contacts is None:
            return
        seen = _count_fused(self.run, update.tracks, heard.truth, time, self._held)
        if time >= SETTLED:
            true = _true_states(heard.truth)
            self.counted[-1].update((ship, true[ship]) for ship in seen)
            _count_lists(self.run, heard, self._latest)

    def conclude(self) -> None:
        """Score what is known at the end of the run."""
        run, known = self.run, self._alignments
        run.conclude()
        assert known is not None
        run.doubled = self._held.doubled
        run.names = sum(len(own) - 1 for own in self._held.names.values())
        place = known.sensor_id.index("array")
        turned = np.radians(CONDITIONS[run.condition].misalignment_deg)
        run.alignment_error = float(known.misalignment[place] - turned)
        run.alignment_deviation = float(known.misalignment_standard_deviation[place])


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
