"""For how long a target of target motion analysis may turn without a row of the list showing it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.records.time import NANOSECONDS, nanoseconds
from sonar_tracking.tma.performance.unseen_turn import LEAST_STEP, Watch, unseen_for
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution

LOST = nanoseconds(60.0)
"""What a station has not measured for so long it does not go on to measure, ns."""


KEPT = nanoseconds(10.0)
"""How long what was found stands, ns: it changes as slowly as the geometry."""


@dataclass(frozen=True)
class _Last:
    """The last observation of a kind, and the time since the one before, s."""

    observation: TargetObservation
    interval: float


@dataclass
class Watches:
    """What each station measures of a target, and goes on to: azimuths, and lines."""

    azimuths: dict[str, _Last] = field(default_factory=dict)
    lines: dict[str, _Last] = field(default_factory=dict)
    found: tuple[int, float] | None = None

    def take(self, observation: TargetObservation) -> None:
        """Take an observation for what the next ones will be like."""
        if observation.azimuths:
            _take(self.azimuths, observation)
        if observation.line_ids:
            _take(self.lines, observation)

    def unseen(self, solution: TargetSolution) -> float:
        """Return how long a turn stays unseen, s; inf = nobody looks."""
        if self.found is None or not 0 <= solution.stamp - self.found[0] < KEPT:
            self.found = solution.stamp, self._unseen(solution)
        return self.found[1]

    def _unseen(self, solution: TargetSolution) -> float:
        since = solution.stamp - LOST
        watches = [
            _watch(last, self.lines.get(sensor), since)
            for sensor, last in self.azimuths.items()
            if last.observation.stamp >= since
        ]
        return unseen_for(solution.mean, solution.covariance, watches) if watches else np.inf


def _take(known: dict[str, _Last], observation: TargetObservation) -> None:
    before = known.get(observation.sensor_id)
    interval = LEAST_STEP
    if before is not None:
        passed = observation.stamp - before.observation.stamp
        interval = passed / NANOSECONDS if passed > 0 else before.interval
    known[observation.sensor_id] = _Last(observation, interval)


def _watch(last: _Last, lines: _Last | None, since: int) -> Watch:
    seen = last.observation
    frequencies: tuple[float, ...] = ()
    deviations: tuple[float, ...] = ()
    if lines is not None and lines.observation.stamp >= since:
        frequencies = lines.observation.frequencies
        # Lines that come less often than bearings count as so much worse ones.
        seldom = float(np.sqrt(lines.interval / last.interval))
        deviations = tuple(seldom * one for one in lines.observation.frequency_deviations)
    raised = np.isfinite(seen.elevation_variance) and seen.height_deviation == 0.0
    return Watch(
        position=seen.position,
        velocity=seen.velocity,
        azimuth_deviation=float(np.sqrt(seen.azimuth_variance)),
        interval=last.interval,
        frequencies=frequencies,
        frequency_deviations=deviations,
        sound_speed=seen.sound_speed,
        height=seen.height,
        elevation_deviation=float(np.sqrt(seen.elevation_variance)) if raised else np.inf,
    )
