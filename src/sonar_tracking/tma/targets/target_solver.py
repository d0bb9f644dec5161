"""One target followed from whatever its sensors measure: the stage a node holds per bearing track.

Observations of several stations go into the same filter (cross-fix). An azimuth from a line array
has two sides: both are followed, with one set of weights, until own ship's turn or a second station
tells them apart. Every solution says how observable the motion is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.errors import InputError, shown
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.motion import wrapped
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.bank_splitting import n_hypotheses, split_bank, without_unlikely
from sonar_tracking.tma.estimators.error_models import (
    ErrorEvidence,
    azimuth_evidence,
    no_evidence,
    with_azimuth_evidence,
)
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.mixture_moments import mixture_moments
from sonar_tracking.tma.estimators.range_bank import RangeBankUpdate, update_range_banks
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, VERTICAL, TmaMeasurement
from sonar_tracking.tma.targets.array_sides import (
    LEFT,
    RIGHT,
    SIDE_PROBABILITY,
    SIDE_TURN,
    SINGLE,
    side_of,
    side_weights,
)
from sonar_tracking.tma.targets.line_columns import LineColumns, plan_columns, with_columns
from sonar_tracking.tma.targets.measurement_log import MeasurementLog
from sonar_tracking.tma.targets.observability import OBSERVABLE
from sonar_tracking.tma.targets.target_records import (
    TargetObservation,
    TargetSolution,
    check_observation,
    measurement_of,
)

PRUNED_EVERY = 4
"""Observations; the hypotheses that do not matter any more are left out then."""

Splits = dict[tuple[int, tuple[float, float]], tuple[HypothesisBank, HypothesisBank]]
"""Banks by identity and position of the station they are split for: before and after."""

Made = dict[tuple[int, tuple[int, ...], int], TmaMeasurement]
"""Measurements by identity of the observation, columns of its lines, and columns there are."""


@dataclass
class _Progress:
    """What the stage remembers beside the filter."""

    sides: tuple[str, ...] = ()
    first_sensor: str = ""
    last_sensor: str = ""
    unpruned: int = 0
    first_course: float = 0.0
    resolvable: bool = False
    manoeuvre: bool = False
    columns: LineColumns = field(default_factory=LineColumns)
    last_stamp_of: dict[str, int] = field(default_factory=dict)
    errors_of: dict[str, ErrorEvidence] = field(default_factory=dict)


class TargetSolver:
    """Solutions of one target.

    Parameters
    ----------
    configuration : RangeBankConfiguration
        Of the filter.
    begins_anew : bool
        Whether it may, after errors that were much larger than told; not one compared with trials.

    Attributes
    ----------
    configuration : RangeBankConfiguration
        Of the filter.
    state : RangeBankState or None
        Of the filter; None = there was no azimuth yet.
    """

    def __init__(
        self, configuration: RangeBankConfiguration | None = None, begins_anew: bool = True
    ) -> None:
        self.configuration = configuration or RangeBankConfiguration()
        self.state: RangeBankState | None = None
        self._progress, self._begins_anew = _Progress(), begins_anew
        self._log: MeasurementLog

    def update(self, observation: TargetObservation) -> tuple[TargetSolution, ...]:
        """Take one observation in and return the solutions that stand.

        Parameters
        ----------
        observation : TargetObservation
            Not older than the one before, of whatever sensor.

        Returns
        -------
        tuple of TargetSolution
            One, or two while the side is open; none before the first azimuth.

        Raises
        ------
        InputError
            If the observation cannot be used; nothing has changed then.
        """
        (problem,) = update_solvers([(self, observation)])
        if problem is not None:
            raise problem
        return self.solutions()

    @property
    def refused(self) -> int:
        """Azimuths in a row that no hypothesis has accepted."""
        return 0 if self.state is None else int(self.state.refused)

    def forgive(self) -> None:
        """Forget the azimuths that were refused."""
        if self.state is not None:
            self.state = replace(self.state, refused=np.array(0))

    def solutions(self) -> tuple[TargetSolution, ...]:
        """Return the solutions that stand: one, two while the side is open, none at first."""
        state, sides = self.state, self._progress.sides
        if state is None:
            return ()
        weights = side_weights(state.bank, len(sides))
        return tuple(
            self._solution(state, index, float(probability))
            for index, probability in enumerate(weights)
        )

    def choose_side(self, side: str) -> None:
        """Let one side of the line array, ``left`` or ``right``, be certain, if both are open."""
        sides = self._progress.sides
        if self.state is not None and len(sides) == 2 and side in sides:
            self._progress.sides = (side,)
            bank = side_of(self.state.bank, sides.index(side), 2)
            self.state = replace(self.state, bank=bank, beginning=None)

    def expect(self, observation: TargetObservation, splits: Splits | None = None) -> None:
        """Prepare for the first azimuths of another station, which cut across the hypotheses.

        Parameters
        ----------
        observation : TargetObservation
            That comes next; nothing is done unless it is a station's first.
        splits : Splits, optional
            Banks split already; those of copied solvers are the same.
        """
        state = self.state
        known = observation.sensor_id in self._progress.last_stamp_of
        if state is None or known or not observation.azimuths:
            return
        splits = {} if splits is None else splits
        key = (id(state.bank), observation.position)
        if key not in splits:
            splits[key] = (state.bank, split_bank(state.bank, np.array(observation.position)))
        self.state = replace(state, bank=splits[key][1])

    def copy(self, configuration: RangeBankConfiguration | None = None) -> TargetSolver:
        """Return a solver that goes on from here independently, with other parameters if given."""
        copied = TargetSolver(configuration or self.configuration, self._begins_anew)
        copied.state = self.state
        stamps, errors = dict(self._progress.last_stamp_of), dict(self._progress.errors_of)
        copied._progress = replace(self._progress, last_stamp_of=stamps, errors_of=errors)
        if self.state is not None:
            copied._log = self._log.copy()
        return copied

    def _check_order(self, observation: TargetObservation) -> None:
        state, sensor = self.state, observation.sensor_id
        if state is not None and observation.stamp < state.stamp:
            raise InputError(
                f"observation of {shown(sensor)} is older than the last one; keep them in order."
            )
        if self._progress.last_stamp_of.get(sensor) == observation.stamp:
            raise InputError(
                f"observation of {shown(sensor)} repeats its stamp; a sensor observes once a stamp."
            )

    def _begin(self, observation: TargetObservation) -> None:
        progress = self._progress
        progress.sides = (LEFT, RIGHT) if len(observation.azimuths) == 2 else (SINGLE,)
        progress.first_sensor = observation.sensor_id
        progress.first_course = _course(observation)
        progress.resolvable = False

    def _measurement(self, observation: TargetObservation, made: Made) -> TmaMeasurement:
        progress = self._progress
        lines = tuple((observation.sensor_id, number) for number in observation.line_ids)
        plan = plan_columns(progress.columns, lines, observation.stamp)
        progress.columns = plan.columns
        count = len(plan.columns.lines)
        if self.state is not None:
            self.state = with_columns(self.state, count, plan.freed)
            self._take_up_errors(observation.sensor_id)
            if plan.freed:
                self._log.forget_lines(plan.freed)
        kind = (id(observation), plan.column_of, count)
        if kind not in made:
            made[kind] = measurement_of(observation, plan.column_of, count)
        return made[kind]

    def _take_up_errors(self, sensor_id: str) -> None:
        """Go on with what is known of the errors of the station that measures."""
        state, known = self.state, self._progress.errors_of
        assert state is not None
        if sensor_id != self._progress.last_sensor:
            own = with_azimuth_evidence(state.errors, known.get(sensor_id) or no_evidence((), 0))
            self.state = replace(state, errors=own, beginning=None)

    def _decide_side(self, observation: TargetObservation) -> None:
        progress, state = self._progress, self.state
        assert state is not None
        if len(progress.sides) == 1:
            progress.unpruned += 1
            if n_hypotheses(state.bank) > 1 and progress.unpruned >= PRUNED_EVERY:
                progress.unpruned = 0
                self.state = replace(state, bank=without_unlikely(state.bank))
            return
        turned = abs(wrapped(_course(observation) - progress.first_course))
        other = observation.sensor_id != progress.first_sensor and bool(observation.azimuths)
        progress.resolvable |= other or turned > SIDE_TURN
        if not progress.resolvable:
            return
        halves = side_weights(state.bank, 2)
        if np.max(halves) > SIDE_PROBABILITY:
            winner = int(np.argmax(halves))
            progress.sides = (progress.sides[winner],)
            self.state = replace(state, bank=side_of(state.bank, winner, 2), beginning=None)

    def _solution(self, state: RangeBankState, index: int, probability: float) -> TargetSolution:
        sides = self._progress.sides
        mean, covariance = mixture_moments(side_of(state.bank, index, len(sides)))
        lines = np.arange(KINEMATIC, state.bank.height)
        figure = self._log.observability(mean[: state.bank.height], int(sides[index] == RIGHT))
        return TargetSolution(
            stamp=state.stamp,
            side=sides[index],
            probability=probability,
            mean=mean[:KINEMATIC],
            covariance=covariance[:KINEMATIC, :KINEMATIC],
            observability=figure,
            observable=figure >= OBSERVABLE,
            line_ids=self._progress.columns.lines,
            source_frequency=mean[lines],
            source_frequency_deviation=np.sqrt(covariance[lines, lines]),
            manoeuvre=self._progress.manoeuvre,
            spatial=_spatial(state.bank, mean, covariance),
        )

    def _prepare(
        self, observation: TargetObservation, splits: Splits, made: Made
    ) -> TmaMeasurement | None:
        """Return what the filter takes; None = nothing is known yet, and no azimuth comes."""
        self._check_order(observation)
        if self.state is None and not observation.azimuths:
            return None
        self.expect(observation, splits)
        return self._measurement(observation, made)

    def _conclude(
        self, observation: TargetObservation, measurement: TmaMeasurement, done: RangeBankUpdate
    ) -> None:
        new = self.state is None
        keeps = self._begins_anew or done.state.beginning is None
        self.state = done.state if keeps else replace(done.state, beginning=None)
        if new or bool(done.restarted):
            self._begin(observation)
            told = self.configuration
            self._log = MeasurementLog(measurement, told.maximum_range, told.maximum_speed)
        self._log.append(measurement)
        self._progress.manoeuvre = bool(done.manoeuvre)
        self._progress.last_stamp_of[observation.sensor_id] = observation.stamp
        self._progress.last_sensor = observation.sensor_id
        self._progress.errors_of[observation.sensor_id] = azimuth_evidence(done.state.errors)
        self._decide_side(observation)


Task = tuple[TargetSolver, TargetObservation]
"""A solver and what it takes in."""

Problem = InputError | np.linalg.LinAlgError
"""Why an observation could not be used."""


def update_solvers(tasks: Sequence[Task]) -> list[Problem | None]:
    """Let many solvers take in an observation each, those of like banks at once.

    Parameters
    ----------
    tasks : sequence of Task
        Of different solvers.

    Returns
    -------
    list of Problem or None
        Of each; an unusable observation has changed nothing. None = there is none.
    """
    problems: list[Problem | None] = [None] * len(tasks)
    splits: Splits = {}
    made: Made = {}
    checked: set[int] = set()
    ready: list[tuple[TargetSolver, TargetObservation, TmaMeasurement]] = []
    for index, (solver, observation) in enumerate(tasks):
        try:
            if id(observation) not in checked:
                check_observation(observation)
                checked.add(id(observation))
            measurement = solver._prepare(observation, splits, made)
        except (InputError, np.linalg.LinAlgError) as error:
            problems[index] = error
            continue
        if measurement is not None:
            ready.append((solver, observation, measurement))
    configurations = {id(one): one for one in (solver.configuration for solver, _, _ in ready)}
    for configuration in configurations.values():
        own = [one for one in ready if one[0].configuration is configuration]
        states, measurements = [one[0].state for one in own], [one[2] for one in own]
        done = update_range_banks(states, measurements, configuration)
        for (solver, observation, measurement), update in zip(own, done, strict=True):
            solver._conclude(observation, measurement, update)
    return problems


def _spatial(bank: HypothesisBank, mean: FloatArray, covariance: FloatArray) -> KalmanState | None:
    """Return the motion with the height; None = it is not estimated, or there was no elevation."""
    if not bank.vertical or covariance[bank.height, bank.height] <= 0.0:
        return None
    own = np.r_[:KINEMATIC, bank.height : bank.height + VERTICAL]
    return KalmanState(mean[own], covariance[np.ix_(own, own)])


def _course(observation: TargetObservation) -> float:
    return float(np.arctan2(observation.velocity[1], observation.velocity[0]))
