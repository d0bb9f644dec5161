"""Most probable path of one target from all that any station measured of it.

Iterated Kalman smoother on [x, y, vx, vy], errors of the stations' directions that last, and the
source frequency of each line. Each pass linearises at the path of the last one, and learns from it
what nobody can tell beforehand:

- outliers: every row is weighed by how well the path explains it, (nu + 1) / (nu + t^2) with t its
  residual in standard deviations, as noise with Student's t distribution asks for;
- errors that are larger than told: the variance of the rows of each station and of each line;
- errors of directions that last (Gauss-Markov): their variance; their correlation time is that of
  the most probable of a few;
- turns: the process noise of each minute, not below that of a target that moves straight.

A target that goes straight but for a deviation that comes back (it weaves), whose size is learnt,
is another explanation: the path is the mean of both, weighed by their likelihoods.

A variance is learnt by the fixed point of its evidence: the sum of the squares of what was smoothed
over how much of it the data determine.

References
----------
Bell, "The iterated Kalman smoother as a Gauss-Newton method", SIAM J. Optimization 4(3), 1994.
Aravkin, Burke, Pillonetto, "Robust and trend-following Student's t Kalman smoothers", SIAM J.
Control and Optimization 52(5), 2014.
MacKay, "Bayesian interpolation", Neural Computation 4(3), 1992, eq. 4.10.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.learnt_variances import Learnt, learn, unit_noise
from sonar_tracking.tma.batch.linear_smoother import LinearSystem, SmoothedStates, smooth_linear
from sonar_tracking.tma.batch.target_history import (
    LINES,
    MINIMUM_RANGE,
    HistoryRows,
    TargetHistory,
    rows_at,
)
from sonar_tracking.tma.batch.weaving_system import learn_weave, weaving_system
from sonar_tracking.tma.estimators.hypothesis_bank import SOURCE_FREQUENCY_SPREAD
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC
from sonar_tracking.tma.estimators.weaving import Weave

WIDENING = (4.0, 2.0)
"""Factors of the deviations in the first passes, so that the start need not be good."""

CORRELATION_TIMES = (5.0, 20.0, 80.0)
"""Of the faster errors of directions, one of which is chosen, s."""

STIFF_TIME = 20.0
"""Correlation time where nothing but a straight path is looked for at first, s."""

WEAVE_DAMPING = 1.0
"""Of a deviation whose size is learnt, but not its period."""

SMALLEST = 1e-8
"""Deviation of errors that are not there, rad: no covariance is singular."""


@dataclass(frozen=True)
class TargetSmootherConfiguration:
    """Parameters of the smoother."""

    acceleration: float = parameter(
        0.01, "Process noise of a target that moves straight", unit="m/s^2", minimum=1e-6
    )
    manoeuvre_acceleration: float = parameter(
        0.1, "Process noise that turns are looked for with", unit="m/s^2", minimum=1e-6
    )
    systematic_deviation_deg: float = parameter(
        0.5,
        "Of errors of a station's directions that do not average out; they widen the covariance",
        unit="deg",
        minimum=0.0,
        maximum=90.0,
    )
    degrees_of_freedom: float = parameter(
        4.0, "Of Student's t distribution; fewer = more outliers", minimum=1.0
    )
    weave_speed: float = parameter(
        0.8,
        "Least of a target that weaves about its mean course: standard deviation of the velocity, "
        "each axis",
        unit="m/s",
        minimum=0.0,
    )
    weave_period: float = parameter(
        130.0, "And how long a turn to port and one to starboard take", unit="s", minimum=1.0
    )
    weave_probability: float = parameter(
        0.005,
        "That a target weaves: small, since a deviation explains large errors, too",
        minimum=1e-9,
        maximum=0.99,
    )
    passes: int = parameter(15, "Passes, the widened ones included", minimum=4)

    @property
    def weave(self) -> Weave:
        """How targets weave."""
        return Weave(self.weave_speed, self.weave_period, WEAVE_DAMPING)


@dataclass(frozen=True)
class TargetPath:
    """States of one target in order of time.

    Attributes
    ----------
    mean : ndarray, shape (n, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n, 4, 4)
        m^2, m^2/s, m^2/s^2.
    """

    mean: FloatArray
    covariance: FloatArray


def smooth_target(
    history: TargetHistory,
    start: FloatArray,
    prior: KalmanState,
    configuration: TargetSmootherConfiguration | None = None,
) -> TargetPath:
    """Return the most probable path.

    Parameters
    ----------
    history : TargetHistory
        All that was measured.
    start : ndarray, shape (n, 4)
        Path to start from, at the times of the history, m and m/s.
    prior : KalmanState
        Of [x, y, vx, vy] before the first time, shapes (4,) and (4, 4).
    configuration : TargetSmootherConfiguration, optional
        Parameters.

    Raises
    ------
    numpy.linalg.LinAlgError
        If any path found is far less likely than the start, by a factor e for each time.
    """
    parameters = configuration or TargetSmootherConfiguration()
    stiff = replace(parameters, manoeuvre_acceleration=parameters.acceleration)
    tried = [(time, parameters) for time in CORRELATION_TIMES] + [(STIFF_TIME, stiff)]
    path = _full_path(history, start)
    begun = path, rows_at(history, path)
    candidates = [_smooth(history, begun, prior, time, each) for time, each in tried]
    best, system = max(candidates, key=lambda one: one[0].log_likelihood)
    weaving, other = _smooth(history, begun, prior, STIFF_TIME, stiff, parameters.weave)
    least = _likelihood_of_start(history, begun, prior, parameters) - len(history.times)
    if max(best.log_likelihood, weaving.log_likelihood) < least:
        raise np.linalg.LinAlgError("Any path that was found is far less likely than the start.")
    odds = np.log(parameters.weave_probability) - np.log1p(-parameters.weave_probability)
    odds += weaving.log_likelihood - best.log_likelihood
    mean, covariance = _mixed(best, weaving, float(1.0 / (1.0 + np.exp(-np.clip(odds, -40, 40)))))
    system = other if odds > 0.0 else system
    deviation = float(np.radians(parameters.systematic_deviation_deg))
    if deviation > 0.0 or history.bending > 0.0:
        lasting = _lasting_deviations(history, mean, deviation)
        covariance = covariance + _systematic(history, system, lasting)
    return TargetPath(mean, covariance)


def _mixed(
    one: SmoothedStates, other: SmoothedStates, share: float
) -> tuple[FloatArray, FloatArray]:
    """Return the moments of the motion, of which the second has this probability."""
    apart = other.mean[:, :KINEMATIC] - one.mean[:, :KINEMATIC]
    motion = np.s_[:, :KINEMATIC, :KINEMATIC]
    within = (1.0 - share) * one.covariance[motion] + share * other.covariance[motion]
    between = share * (1.0 - share) * apart[:, :, None] * apart[:, None, :]
    return one.mean[:, :KINEMATIC] + share * apart, within + between


def _likelihood_of_start(
    history: TargetHistory,
    begun: tuple[FloatArray, HistoryRows],
    prior: KalmanState,
    parameters: TargetSmootherConfiguration,
) -> float:
    """Return the log likelihood where the measurements are linearised at the start."""
    path, rows = begun
    learnt = Learnt.of(history, parameters.acceleration, parameters.manoeuvre_acceleration)
    first = _first(history, prior, path, learnt)
    system = _system(history, first, path, rows, learnt, 1.0, STIFF_TIME, parameters)
    return smooth_linear(system).log_likelihood


def _lasting_deviations(
    history: TargetHistory, path: FloatArray, deviation: float
) -> tuple[FloatArray, FloatArray]:
    """Return those of azimuths and elevations, shape (n,) each, rad: rays are bent besides."""
    distance = np.hypot(*(path[:, :2] - history.position).T)
    slope = history.height / np.maximum(distance, MINIMUM_RANGE)
    bent = 0.5 * history.bending / np.sqrt(slope**2 + max(history.bending, SMALLEST))
    return np.full(len(distance), deviation), np.hypot(deviation, bent)


def _systematic(
    history: TargetHistory, system: LinearSystem, deviations: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return what lasting errors of directions do to the covariance, shape (n, 4, 4).

    They are no part of the estimate, which cannot tell them from another path.
    """
    start = KalmanState(np.zeros_like(system.start.mean), system.start.covariance)
    added = np.zeros((len(history.times), KINEMATIC, KINEMATIC))
    for number, column in enumerate(history.slow):
        error = deviations[number // history.n_stations][:, None]
        response = replace(system, start=start, measured=error * system.matrix[:, :, column])
        moved = smooth_linear(response).mean[:, :KINEMATIC]
        added += moved[:, :, None] * moved[:, None, :]
    return added


def _smooth(
    history: TargetHistory,
    begun: tuple[FloatArray, HistoryRows],
    prior: KalmanState,
    correlation_time: float,
    parameters: TargetSmootherConfiguration,
    weave: Weave | None = None,
) -> tuple[SmoothedStates, LinearSystem]:
    """Return all states if the faster errors have a correlation time, s, and their system.

    It is begun with a whole path and the rows there. A target that weaves otherwise goes straight.
    """
    path, rows = begun
    intervals = np.diff(history.times, prepend=history.times[0])
    learnt = Learnt.of(history, parameters.acceleration, parameters.manoeuvre_acceleration)
    for number in range(parameters.passes):
        widening = WIDENING[number] if number < len(WIDENING) else 1.0
        first = _first(history, prior, path, learnt)
        system = _system(history, first, path, rows, learnt, widening, correlation_time, parameters)
        if weave is not None:
            system = weaving_system(system, intervals, weave)
        states = smooth_linear(system)
        if number == parameters.passes - 1:
            break
        path = states.mean[:, : history.size]
        rows = rows_at(history, path)
        if number < len(WIDENING):
            continue
        taught = learn(
            *(history, states, rows, learnt, correlation_time),
            *(parameters.acceleration, parameters.degrees_of_freedom),
        )
        if weave is not None:
            weave = learn_weave(states, intervals, weave, parameters.weave)
            taught = replace(taught, acceleration=learnt.acceleration)
        learnt = taught
    return states, system


def _full_path(history: TargetHistory, start: FloatArray) -> FloatArray:
    """Return the start with no lasting errors and the source frequencies it implies."""
    path = np.zeros((len(history.times), history.size))
    path[:, :KINEMATIC] = start
    if history.n_lines:
        path[:, history.lines] = 1.0
        factor = history.frequency - rows_at(history, path).residual[:, LINES:]
        path[:, history.lines] = np.nanmedian(history.frequency / factor, axis=0)
    return path


def _first(
    history: TargetHistory,
    prior: KalmanState,
    path: FloatArray,
    learnt: Learnt,
) -> KalmanState:
    """Return the distribution of the whole state before the first time."""
    first = np.zeros((history.size, history.size))
    first[:KINEMATIC, :KINEMATIC] = prior.covariance
    slow, fast, lines = history.slow, history.fast, history.lines
    first[slow, slow] = SMALLEST**2
    first[fast, fast] = learnt.fast**2 + SMALLEST**2
    first[lines, lines] = (SOURCE_FREQUENCY_SPREAD * path[0, lines]) ** 2
    mean = np.zeros(history.size)
    mean[:KINEMATIC] = prior.mean
    mean[lines] = path[0, lines]
    return KalmanState(mean, first)


def _system(
    history: TargetHistory,
    first: KalmanState,
    path: FloatArray,
    rows: HistoryRows,
    learnt: Learnt,
    widening: float,
    correlation_time: float,
    parameters: TargetSmootherConfiguration,
) -> LinearSystem:
    """Return the system linearised at a path, its rows weighed."""
    ratio = learnt.ratio[history.groups]
    variance = np.where(rows.present, widening**2 * ratio * history.deviations**2, 1.0)
    freedom = parameters.degrees_of_freedom
    weight = (freedom + 1.0) / (freedom + rows.residual**2 / variance) / variance
    # What was measured, referred to the state instead of to errors of the last path.
    measured = rows.residual + np.einsum("nri,ni->nr", rows.derivative, path)
    intervals = np.diff(history.times, prepend=history.times[0])
    transition = np.tile(np.eye(history.size), (len(path), 1, 1))
    transition[:, 0, 2] = transition[:, 1, 3] = intervals
    noise = np.zeros_like(transition)
    noise[:, :KINEMATIC, :KINEMATIC] = learnt.acceleration[:, None, None] ** 2 * unit_noise(
        intervals
    )
    kept = np.exp(-intervals / correlation_time)[:, None]
    transition[:, history.fast, history.fast] = kept
    noise[:, history.fast, history.fast] = learnt.fast**2 * (1.0 - kept**2)
    return LinearSystem(
        start=first,
        transition=transition,
        noise=noise,
        matrix=rows.derivative,
        measured=measured,
        weight=np.where(rows.present, weight, 0.0),
        variance=variance,
        degrees_of_freedom=freedom,
    )
