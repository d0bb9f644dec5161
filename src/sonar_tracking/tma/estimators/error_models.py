"""How large and how lasting the errors of a measurement really are, learnt from its innovations.

A sensor says of each value how large its error is, as if errors of successive frames had nothing
in common. Real ones are larger than told, or last: a bearing that is off now is off in the same
direction ten seconds later. The innovations of a filter show both. Each row (the azimuth of a
station, a line) has a few models of its error in units of the told variance R,

    e_k = w_k + b_k,   b_k = phi b_(k-1) + g_k,   phi = exp(-dt / tau),   var b = c R,  var w = d R,

weighed by the likelihood of the innovations under each: the scalar Kalman filter of b_k, one a
model, no matter how many hypotheses the bank has (multiple-model adaptive estimation). What is
told is by far the most probable one at first, and stays it if the innovations bear it out.

An error that lasts is averaged out only as fast as independent ones arrive. What changes slowly,
the motion, is therefore estimated as well as if the errors were white with the spectral density at
frequency zero, which is the variance that the filter takes:

    R_k = R (d + c (1 + phi) / (1 - phi) / (1 + (tau / T)^2)),

averaged geometrically over the models. The last factor takes the spectral density not at zero but
at the lowest frequency that matters to the motion, 1 / T. ``compiled_errors``, which is there if a
compiler was when the package was installed, gives the bits of what is here in numpy.

References
----------
Magill, "Optimal adaptive estimation of sampled stochastic processes", IEEE Trans. Automatic Control
10(4), 1965.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.time import NANOSECONDS

COMPILED = compiled_module("tma.estimators.compiled_errors")

LASTING, TIME_CONSTANT, WHITE, _LINE, _AZIMUTH = np.array(
    [
        (0.0, 1.0, 1.0, 1000.0, 1000.0),
        *[(0.0, 1.0, 2.0**power, 1.0, 1.0) for power in (-6, -4, -3, -2, -1)],
        *[(0.0, 1.0, 2.0**power, 10.0, 10.0) for power in (1, 2, 3, 4, 5)],
        *[(1.0, tau, 0.03, 3.0, 0.1) for tau in (3.0, 10.0, 30.0, 100.0)],
        *[(4.0, tau, 0.4, 3.0, 0.0) for tau in (3.0, 10.0, 30.0, 100.0)],
        *[(c, tau, 1.0, 3.0, 0.0) for c in (1.0, 4.0, 16.0) for tau in (10.0, 30.0, 100.0, 300.0)],
    ]
).T.copy()
"""Of each model: c and tau of the part that lasts (pure number, s), d of the other, prior odds for
a line and for an azimuth. Where the range is still wrong the predicted azimuth drifts away for
minutes, with the white errors of the bearings upon it: models of azimuths have no such part that
lasts beside a white one, lest the drift pass for an error. Errors smaller than told are taken to be
as told; without their models small ones would pass for lasting ones, which are therefore less
probable at first: a filter that is told too large deviations lags behind, and lasting ones show it
as well."""

N_MODELS = len(WHITE)

PHI, LOGS, FADED = slice(N_MODELS), slice(N_MODELS, 2 * N_MODELS), slice(2 * N_MODELS, None)
"""Places in what a time does."""

NOTHING_BEFORE = -(2**62)
"""Taken for the time since the last value where there was none, ns."""

with np.errstate(divide="ignore"):
    LOG_PRIOR = np.log(np.stack([_AZIMUTH, _LINE]))
"""Log of the prior odds of each model, for an azimuth and for a line."""

HORIZON = 100.0
"""Time scale of the motion that is estimated, s: errors that last longer shift the estimate as a
whole, and count less."""

QUICK = np.where(LASTING > 0.0, WHITE, np.maximum(WHITE, 1.0))
SLOW = LASTING / (1.0 + (TIME_CONSTANT / HORIZON) ** 2)
"""What of each model's two parts counts."""

MEMORY = 300.0
"""How long an innovation counts, s: errors need not be what they were."""

FIRST_INTERVAL = 1.0
"""Taken to have passed before the first value of a row, s."""

SHORTEST_INTERVAL = 0.01
"""Values that follow each other sooner are taken to be so far apart, s."""

WILD = 9.0
"""A normalised innovation squared counts at most this much: a few outliers are no larger errors."""


@dataclass(frozen=True)
class ErrorEvidence:
    """What the innovations of the azimuth, row 0, and of the lines, one row each, have said so far.

    Attributes
    ----------
    table : ndarray, shape (..., 1 + n_lines, 3, N_MODELS)
        Of each model: its log likelihood relative to the best one; the part of the error that
        lasts, in told standard deviations; and the variance of this.
    stamp : ndarray of int64, shape (..., 1 + n_lines)
        Of the last value, ns; 0 = there was none.
    """

    table: FloatArray
    stamp: IntArray

    @property
    def n_rows(self) -> int:
        """Azimuth and lines."""
        return self.stamp.shape[-1]


def no_evidence(batch: tuple[int, ...], n_lines: int) -> ErrorEvidence:
    """Return what is known of rows before their first value."""
    table = np.zeros((*batch, 1 + n_lines, 3, N_MODELS))
    table[..., 2, :] = LASTING
    return ErrorEvidence(table, np.zeros((*batch, 1 + n_lines), dtype=np.int64))


def azimuth_evidence(evidence: ErrorEvidence) -> ErrorEvidence:
    """Return the evidence on the azimuth alone."""
    return ErrorEvidence(evidence.table[..., :1, :, :], evidence.stamp[..., :1])


def with_azimuth_evidence(evidence: ErrorEvidence, azimuth: ErrorEvidence) -> ErrorEvidence:
    """Return the evidence with that on the azimuth of another station in its place."""
    return ErrorEvidence(
        np.concatenate([azimuth.table, evidence.table[..., 1:, :, :]], axis=-3),
        np.concatenate([azimuth.stamp, evidence.stamp[..., 1:]], axis=-1),
    )


def with_lines(evidence: ErrorEvidence, n_lines: int, freed: tuple[int, ...]) -> ErrorEvidence:
    """Return the evidence of a single run with more lines, and without what those freed have said.

    Parameters
    ----------
    evidence : ErrorEvidence
        Before.
    n_lines : int
        Lines there shall be, not fewer than there are.
    freed : tuple of int
        Lines to forget.
    """
    more = no_evidence((), n_lines)
    kept = [row for row in range(evidence.n_rows) if row - 1 not in freed]
    more.table[kept], more.stamp[kept] = evidence.table[kept], evidence.stamp[kept]
    return more


def variance_factor(evidence: ErrorEvidence, stamp: int) -> FloatArray:
    """Return what the told variances of values at a stamp, ns, are to be multiplied by.

    Returns
    -------
    ndarray, shape (..., 1 + n_lines)
        Pure numbers.
    """
    passed, place = _passed(evidence, stamp)
    logs = passed[0, LOGS] if len(passed) == 1 else passed[:, LOGS][place]
    weight = evidence.table[..., 0, :] + _log_prior(evidence.n_rows)
    weight = np.exp(weight - weight.max(axis=-1, keepdims=True))
    return np.asarray(np.exp((weight * logs).sum(axis=-1) / weight.sum(axis=-1)))


def learn_errors(
    evidence: ErrorEvidence,
    innovation: FloatArray,
    own_variance: FloatArray,
    telling: BoolArray,
    stamp: int,
) -> ErrorEvidence:
    """Return the evidence after the innovations of a frame.

    Parameters
    ----------
    evidence : ErrorEvidence
        Before.
    innovation : ndarray, shape (..., 1 + n_lines)
        Measured minus predicted, in told standard deviations: a pure number.
    own_variance : ndarray, shape (..., 1 + n_lines)
        Of the prediction, in told variances: a pure number.
    telling : ndarray of bool, shape (..., 1 + n_lines)
        Which rows there are and say something of their errors.
    stamp : int
        Of the frame, ns.
    """
    passed, place = _passed(evidence, stamp)
    phi, faded = passed[:, PHI], passed[:, FADED][place, 0]
    if COMPILED is None:
        table = _learnt(evidence.table, phi[place], faded[..., None], innovation, own_variance)
        table = np.where(telling[..., None, None], table, evidence.table)
    else:
        table = np.empty(evidence.table.shape)
        spread = np.empty((*place.shape, N_MODELS))
        before, told, faded = (np.ascontiguousarray(o) for o in (evidence.table, telling, faded))
        COMPILED.learn(
            *(before, np.ascontiguousarray(phi), place),
            *(np.ascontiguousarray(innovation), np.ascontiguousarray(own_variance), told),
            *(LASTING, WHITE, table, spread, WILD, (place.size, N_MODELS, len(phi))),
        )
        log_spread = np.log(spread, out=spread)
        COMPILED.weigh(before, faded, log_spread, told, table, (place.size, N_MODELS))
    return ErrorEvidence(table, np.where(telling, stamp, evidence.stamp))


def _learnt(
    before: FloatArray,
    phi: FloatArray,
    faded: FloatArray,
    innovation: FloatArray,
    own_variance: FloatArray,
) -> FloatArray:
    """Return the table after an innovation of every row."""
    table = np.empty_like(before)
    lasting = phi * before[..., 1, :]
    variance = LASTING + phi**2 * (before[..., 2, :] - LASTING)
    spread = variance + WHITE + own_variance[..., None]
    left = innovation[..., None] - lasting
    squared = left**2 / spread
    gain = np.where(squared > WILD, 0.0, variance / spread)
    likelihood = faded * before[..., 0, :] - 0.5 * (np.minimum(squared, WILD) + np.log(spread))
    table[..., 0, :] = likelihood - np.max(likelihood, axis=-1, keepdims=True)
    table[..., 1, :] = lasting + gain * left
    table[..., 2, :] = (1.0 - gain) * variance
    return table


def _passed(evidence: ErrorEvidence, stamp: int) -> tuple[FloatArray, IntArray]:
    """Return what different times since the last value do, and which that is for each row."""
    passed = np.where(evidence.stamp > 0, stamp - evidence.stamp, NOTHING_BEFORE)
    times, place = np.unique(passed, return_inverse=True)
    return np.array([_after(time) for time in times.tolist()]), place.reshape(passed.shape)


@lru_cache(maxsize=1024)
def _after(passed: int) -> FloatArray:
    """Return what a time since the last value of a row, ns, does: most values come regularly.

    Of each model phi and the log of what the told variance is to be multiplied by, and how much
    what was learnt still counts.
    """
    shortest = SHORTEST_INTERVAL if passed != NOTHING_BEFORE else FIRST_INTERVAL
    interval = np.array([max(passed / NANOSECONDS, shortest)])
    phi = np.exp(-interval / TIME_CONSTANT)
    logs = np.log(QUICK + SLOW * (1.0 + phi) / (1.0 - phi))
    after = np.concatenate([phi, logs, np.exp(-interval / MEMORY)])
    after.setflags(write=False)
    return after


@lru_cache(maxsize=64)
def _log_prior(n_rows: int) -> FloatArray:
    """Return the log of the prior odds of each model for the azimuth and the lines."""
    return LOG_PRIOR[np.minimum(np.arange(n_rows), 1)]
