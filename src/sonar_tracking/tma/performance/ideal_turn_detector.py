"""How soon a turn of a target can be noticed at all: the ideal detector of a turn that is known.

A filter that believes in a straight path has innovations of mean zero and known covariance S while
the target goes straight, and of mean m once it turns. A detector that knows when, where to and how
the target turns, and only asks whether, compares the two with the likelihood ratio. What it has to
go by is the deflection d,

    d^2 = sum of m^T S^-1 m,

the distance of the two hypotheses in standard deviations: no other detector finds the turn sooner
at the same rate of false alarms (one in an hour, asked every second: d = 4 and more).

References
----------
Van Trees, "Detection, Estimation, and Modulation Theory, Part I", Wiley, 1968, section 4.2.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import (
    SOURCE_FREQUENCY_SPREAD,
    HypothesisBank,
    predict_bank,
)
from sonar_tracking.tma.estimators.measurement_model import linearise
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement


def turn_deflection(
    straight: FloatArray,
    source_frequency: FloatArray,
    frames: Iterable[TmaMeasurement],
    prior: FloatArray,
    acceleration: float,
) -> FloatArray:
    """Return how many standard deviations a turn stands out after each frame.

    Parameters
    ----------
    straight : ndarray, shape (n_frames, 4)
        Path of the target if it does not turn, m and m/s; the filter is linearised there.
    source_frequency : ndarray, shape (n_lines,)
        Hz.
    frames : iterable of TmaMeasurement
        What is measured, without errors, of the target that turns; one run.
    prior : ndarray, shape (4, 4)
        Covariance of the motion before the first frame, m^2, m^2/s, m^2/s^2.
    acceleration : float
        Process noise of the filter, m/s^2.

    Returns
    -------
    ndarray, shape (n_frames,)
        d, a pure number.
    """
    size = KINEMATIC + len(source_frequency)
    covariance = np.zeros((1, size, size))
    covariance[0, :KINEMATIC, :KINEMATIC] = prior
    lines = np.arange(KINEMATIC, size)
    covariance[0, lines, lines] = (SOURCE_FREQUENCY_SPREAD * source_frequency) ** 2
    known = np.ones((1, len(source_frequency)), dtype=bool)
    # The mean is what the turn shifts the estimate by.
    bank = HypothesisBank(np.zeros((1, size)), covariance, np.zeros(1), known)
    squared, stamp = [0.0], None
    for state, frame in zip(straight, frames, strict=True):
        bank = predict_bank(
            bank, elapsed(stamp or frame.stamp, frame.stamp), np.asarray(acceleration)
        )
        stamp = frame.stamp
        at = np.concatenate([state, source_frequency])[None, None]
        rows = linearise(at, frame, known, frame.azimuth[..., :1])
        present = rows.present[0, 0]
        matrix = rows.derivative[0, 0, present]
        mean, spread = bank.mean[0], bank.covariance[0]
        shift = rows.innovation[0, 0, present] - matrix @ mean
        crossed = spread @ matrix.T
        inner = matrix @ crossed + np.diag(rows.variance[0, 0, present])
        gain = np.linalg.solve(inner, crossed.T).T
        squared.append(squared[-1] + float(shift @ np.linalg.solve(inner, shift)))
        bank = HypothesisBank(
            (mean + gain @ shift)[None], (spread - gain @ crossed.T)[None], bank.log_weight, known
        )
    return np.sqrt(squared[1:])
