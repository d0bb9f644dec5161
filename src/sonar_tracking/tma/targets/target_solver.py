"""One target followed from whatever its sensors measure: the stage a node holds per bearing track.

Observations of several stations go into the same filter (cross-fix). An azimuth from a line array
has two sides: both are followed, with one set of weights, until own ship's turn or a second station
tells them apart. Every solution says how observable the motion is.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.errors import InputError, shown
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.bank_splitting import split_bank, without_unlikely
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, mixture_moments
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement
from sonar_tracking.tma.targets.line_columns import LineColumns, plan_columns, with_columns
from sonar_tracking.tma.targets.measurement_log import MeasurementLog
from sonar_tracking.tma.targets.observability import OBSERVABLE
from sonar_tracking.tma.targets.station_association import azimuth_log_likelihood
from sonar_tracking.tma.targets.target_records import (
    TargetObservation,
    TargetSolution,
    check_observation,
)

SIDE_PROBABILITY = 0.99
SIDE_TURN = float(np.radians(20.0))
"""One side is dropped when the other is this probable and own ship has turned by this much."""

SINGLE, LEFT, RIGHT = "single", "left", "right"


@dataclass
class _Progress:
    """What the stage remembers beside the filter."""

    sides: tuple[str, ...] = ()
    first_sensor: str = ""
    first_course: float = 0.0
    resolvable: bool = False
    columns: LineColumns = field(default_factory=LineColumns)
    last_stamp_of: dict[str, int] = field(default_factory=dict)


class TargetSolver:
    """Solutions of one target.

    Parameters
    ----------
    configuration : RangeBankConfiguration
        Of the filter.
    """

    def __init__(self, configuration: RangeBankConfiguration | None = None) -> None:
        self._configuration = configuration or RangeBankConfiguration()
        self._bank = RangeBank(self._configuration)
        self._progress = _Progress()
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
        check_observation(observation)
        self._check_order(observation)
        if self._bank.state is None and not observation.azimuths:
            return ()
        self.expect(observation)
        measurement = self._measurement(observation)
        new = self._bank.state is None
        estimate = self._bank.update(measurement)
        if new or bool(estimate.restarted):
            self._begin(observation)
            self._log = self._new_log(measurement)
        self._log.append(measurement)
        self._progress.last_stamp_of[observation.sensor_id] = observation.stamp
        self._decide_side(observation)
        return self._solutions(measurement, bool(estimate.manoeuvre))

    def expect(self, observation: TargetObservation) -> None:
        """Prepare for the first azimuths of another station, which cut across the hypotheses.

        Parameters
        ----------
        observation : TargetObservation
            That comes next; nothing is done unless it is a station's first.
        """
        state = self._bank.state
        known = observation.sensor_id in self._progress.last_stamp_of
        if state is not None and observation.azimuths and not known:
            bank = split_bank(state.bank, np.array(observation.position))
            self._bank.state = replace(state, bank=bank)

    def copy(self) -> TargetSolver:
        """Return a solver that goes on from here independently."""
        return copy.deepcopy(self)

    def log_likelihood(self, observation: TargetObservation) -> float:
        """Return how well the azimuths of an observation fit, before they are taken in.

        Parameters
        ----------
        observation : TargetObservation
            Of whatever sensor, not older than the last one, with azimuths.

        Returns
        -------
        float
            Log of their density, rad^-1; -inf = outside the gate of every hypothesis.
        """
        state, parameters = self._bank.state, self._configuration
        assert state is not None
        azimuths = np.array(observation.azimuths)
        density = azimuth_log_likelihood(
            state.bank,
            elapsed(state.stamp, observation.stamp),
            parameters.acceleration,
            np.array(observation.position),
            azimuths,
            np.full(azimuths.shape, observation.azimuth_variance),
            parameters.gate,
            observation.propagation_speed,
        )
        return float(np.logaddexp.reduce(density))

    def _check_order(self, observation: TargetObservation) -> None:
        state, sensor = self._bank.state, observation.sensor_id
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

    def _measurement(self, observation: TargetObservation) -> TmaMeasurement:
        progress, state = self._progress, self._bank.state
        lines = tuple((observation.sensor_id, number) for number in observation.line_ids)
        plan = plan_columns(progress.columns, lines, observation.stamp)
        progress.columns = plan.columns
        count = len(plan.columns.lines)
        if state is not None:
            self._bank.state = with_columns(state, count, plan.freed)
            self._log.forget_lines(plan.freed)
        frequency, deviation = np.full(count, np.nan), np.full(count, np.nan)
        frequency[list(plan.column_of)] = observation.frequencies
        deviation[list(plan.column_of)] = observation.frequency_deviations
        return TmaMeasurement(
            stamp=observation.stamp,
            position=np.array(observation.position),
            velocity=np.array(observation.velocity),
            azimuth=np.array(observation.azimuths or (np.nan,)),
            azimuth_variance=np.array(observation.azimuth_variance),
            frequency=frequency,
            frequency_deviation=deviation,
            elevation=np.array(observation.elevation),
            elevation_variance=np.array(observation.elevation_variance),
            height=observation.height,
            sound_speed=observation.sound_speed,
            propagation_speed=observation.propagation_speed,
        )

    def _decide_side(self, observation: TargetObservation) -> None:
        progress, state = self._progress, self._bank.state
        assert state is not None
        turned = abs(float(wrap_angle(_course(observation) - progress.first_course)))
        other = observation.sensor_id != progress.first_sensor and bool(observation.azimuths)
        progress.resolvable |= other or turned > SIDE_TURN
        if len(progress.sides) == 1 and len(state.bank.log_weight) > self._configuration.n_ranges:
            self._bank.state = replace(state, bank=without_unlikely(state.bank))
        if len(progress.sides) == 1 or not progress.resolvable:
            return
        halves = _side_weights(state.bank, 2)
        if np.max(halves) > SIDE_PROBABILITY:
            winner = int(np.argmax(halves))
            progress.sides = (progress.sides[winner],)
            self._bank.state = replace(state, bank=_side_of(state.bank, winner, 2))

    def _solutions(
        self, measurement: TmaMeasurement, manoeuvre: bool
    ) -> tuple[TargetSolution, ...]:
        state, sides = self._bank.state, self._progress.sides
        assert state is not None
        weights = _side_weights(state.bank, len(sides))
        solutions = []
        for index, (side, probability) in enumerate(zip(sides, weights, strict=True)):
            mean, covariance = mixture_moments(_side_of(state.bank, index, len(sides)))
            lines = np.arange(KINEMATIC, len(mean))
            figure = self._log.observability(mean, int(side == RIGHT))
            solutions.append(
                TargetSolution(
                    stamp=measurement.stamp,
                    side=side,
                    probability=float(probability),
                    mean=mean[:KINEMATIC],
                    covariance=covariance[:KINEMATIC, :KINEMATIC],
                    observability=figure,
                    observable=figure >= OBSERVABLE,
                    line_ids=self._progress.columns.lines,
                    source_frequency=mean[KINEMATIC:],
                    source_frequency_deviation=np.sqrt(covariance[lines, lines]),
                    manoeuvre=manoeuvre,
                )
            )
        return tuple(solutions)

    def _new_log(self, first: TmaMeasurement) -> MeasurementLog:
        parameters = self._configuration
        return MeasurementLog(first, parameters.maximum_range, parameters.maximum_speed)


def _course(observation: TargetObservation) -> float:
    return float(np.arctan2(observation.velocity[1], observation.velocity[0]))


def _side_weights(bank: HypothesisBank, n_sides: int) -> FloatArray:
    return np.asarray(np.exp(bank.log_weight).reshape(n_sides, -1).sum(axis=-1))


def _side_of(bank: HypothesisBank, side: int, n_sides: int) -> HypothesisBank:
    """Return the hypotheses of one side, their weights normalised."""
    count = len(bank.log_weight) // n_sides
    own = slice(side * count, (side + 1) * count)
    weight = bank.log_weight[own] - np.logaddexp.reduce(bank.log_weight[own])
    return HypothesisBank(bank.mean[own], bank.covariance[own], weight, bank.known)
