"""The published methods behind the interface of the default solver, for comparison.

Each is a single filter on one side of the array. Both sides of an ambiguous bearing are followed,
but nothing weighs them: these methods have no likelihood of a side. They need an azimuth in every
frame, and know no second station.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.errors import InputError, shown
from sonar_tracking.tma.estimators.estimator import Estimator
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement
from sonar_tracking.tma.targets.array_sides import LEFT, RIGHT, SINGLE
from sonar_tracking.tma.targets.measurement_log import MeasurementLog
from sonar_tracking.tma.targets.observability import OBSERVABLE
from sonar_tracking.tma.targets.target_records import (
    MAXIMUM_LINES,
    TargetObservation,
    TargetSolution,
    check_observation,
)
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration


class BaselineSolver:
    """One target by a method for comparison.

    Parameters
    ----------
    configuration : TmaTrackerConfiguration
        With one of the methods for comparison.
    """

    refused = 0
    """Methods for comparison take whatever comes."""

    def __init__(self, configuration: TmaTrackerConfiguration) -> None:
        self._configuration = configuration
        self._estimators: dict[str, Estimator] = {}
        self._column_of: dict[tuple[str, int], int] = {}
        self._received = np.ones(MAXIMUM_LINES)
        self._log: MeasurementLog
        self._last_stamp = 0
        self._solutions: tuple[TargetSolution, ...] = ()

    def update(self, observation: TargetObservation) -> tuple[TargetSolution, ...]:
        """Take one observation in and return the solutions that stand.

        Parameters
        ----------
        observation : TargetObservation
            Later than the one before. One without an azimuth changes nothing, nor do lines beyond
            the first :data:`MAXIMUM_LINES`.

        Raises
        ------
        InputError
            If the observation cannot be used; nothing has changed then.
        """
        check_observation(observation)
        if observation.stamp <= self._last_stamp:
            raise InputError(
                f"observation of {shown(observation.sensor_id)} is not later than the last one; "
                "methods for comparison follow one station, in order."
            )
        if not observation.azimuths:
            return ()
        measurements = [self._measurement(observation, azimuth) for azimuth in observation.azimuths]
        if not self._estimators:
            self._begin(measurements)
        self._log.append(measurements[0])
        self._last_stamp = observation.stamp
        solutions = []
        for side, one in self._estimators.items():
            measurement = measurements[-1 if side == RIGHT else 0]
            solutions.append(self._solution(side, one.update(measurement)))
        self._solutions = tuple(solutions)
        return self._solutions

    def solutions(self) -> tuple[TargetSolution, ...]:
        """Return the solutions after the last azimuth."""
        return self._solutions

    def choose_side(self, side: str) -> None:
        """Let one side of the line array, ``left`` or ``right``, be certain, if both are open."""
        if side in self._estimators:
            self._estimators = {side: self._estimators[side]}
            own = [one for one in self._solutions if one.side == side]
            self._solutions = tuple(replace(one, probability=1.0) for one in own)

    def _begin(self, measurements: list[TmaMeasurement]) -> None:
        sides = (LEFT, RIGHT) if len(measurements) == 2 else (SINGLE,)
        method, configuration = self._configuration.entry, self._configuration
        self._estimators = {side: method.make(configuration) for side in sides}
        azimuths = np.concatenate([one.azimuth for one in measurements])
        self._log = MeasurementLog(
            replace(measurements[0], azimuth=azimuths),
            configuration.maximum_range,
            configuration.maximum_speed,
        )

    def _measurement(self, observation: TargetObservation, azimuth: float) -> TmaMeasurement:
        frequency = np.full(MAXIMUM_LINES, np.nan)
        deviation = np.full(MAXIMUM_LINES, np.nan)
        heard = zip(
            observation.line_ids,
            observation.frequencies,
            observation.frequency_deviations,
            strict=True,
        )
        for number, received, spread in heard:
            line = (observation.sensor_id, number)
            column = self._column_of.setdefault(line, len(self._column_of))
            if column < MAXIMUM_LINES:
                frequency[column], deviation[column] = received, spread
                self._received[column] = received
        return TmaMeasurement(
            stamp=observation.stamp,
            position=np.array(observation.position),
            velocity=np.array(observation.velocity),
            azimuth=np.array([azimuth]),
            azimuth_variance=np.array(observation.azimuth_variance),
            frequency=frequency,
            frequency_deviation=deviation,
            sound_speed=observation.sound_speed,
            propagation_speed=observation.propagation_speed,
        )

    def _solution(self, side: str, estimate: TmaEstimate) -> TargetSolution:
        # Received and source frequencies differ by v/c: the figure does not feel it.
        figure = self._log.observability(
            np.concatenate([estimate.mean, self._received]), int(side == RIGHT)
        )
        lines: list[tuple[str, int]] = []
        if self._configuration.entry.names_lines:
            lines = list(self._column_of)[:MAXIMUM_LINES]
        return TargetSolution(
            stamp=estimate.stamp,
            side=side,
            probability=1.0 / len(self._estimators),
            mean=estimate.mean,
            covariance=estimate.covariance,
            observability=figure,
            observable=figure >= OBSERVABLE,
            line_ids=tuple(lines),
            source_frequency=estimate.source_frequency[: len(lines)],
            source_frequency_deviation=estimate.source_frequency_deviation[: len(lines)],
            manoeuvre=False,
        )
