"""How likely the target's contact is the l-th strongest of m.

With exponential amplitudes, noise mean 1 and target mean 1 + SNR, above any common threshold the
rank of the target's amplitude among m - 1 clutter amplitudes has the distribution

    P(rank l) = gamma(l) PA(m),    PA(m) = s B(s, m),    gamma(l) = Gamma(l - 1 + s)
                                                                    / (Gamma(s) Gamma(l)),
    s = 1 / (1 + SNR),

free of the threshold. The published alternating sum loses all digits from m = 80 on; this form,
in logarithms, does not.

References
----------
Kim, Song (2007), equations 6-10.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from sonar_tracking.records.arrays import FloatArray


@lru_cache(maxsize=1024)  # of the few numbers that gates hold
def rank_probabilities(count: int, signal_to_noise_ratio_linear: float) -> FloatArray:
    """Return the probability of each rank of the target among the contacts in a gate.

    Parameters
    ----------
    count : int
        m, contacts in the gate, the target's among them.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.

    Returns
    -------
    ndarray, shape (count,)
        Entry l - 1 belongs to the l-th strongest; the sum is 1. Not to be written to.
    """
    # It takes half as long to load as a whole node to start: see load_rank_probabilities.
    from scipy.special import betaln, gammaln

    shape = 1.0 / (1.0 + signal_to_noise_ratio_linear)
    rank = np.arange(1, count + 1)
    logarithm = np.log(shape) + betaln(shape, count)
    logarithm = logarithm + gammaln(rank - 1 + shape) - gammaln(shape) - gammaln(rank)
    probabilities = np.asarray(np.exp(logarithm))
    probabilities.flags.writeable = False
    return probabilities


def load_rank_probabilities() -> None:
    """Load the special functions now, so that the first gate need not wait for them."""
    rank_probabilities(1, 1.0)


def rank_probabilities_of(
    amplitudes: FloatArray, signal_to_noise_ratio_linear: float
) -> FloatArray:
    """Return for each contact in a gate the probability that the target has its rank.

    Parameters
    ----------
    amplitudes : ndarray, shape (m,)
        Linear powers; empty or NaN where not measured: all ranks are then equally likely.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.

    Returns
    -------
    ndarray, shape (m,)
        Probabilities, sum 1.
    """
    count = len(amplitudes)
    if not np.all(np.isfinite(amplitudes)):
        return np.full(count, 1.0 / max(count, 1))
    probabilities = np.empty(count)
    strongest_first = np.argsort(-amplitudes, kind="stable")
    probabilities[strongest_first] = rank_probabilities(count, signal_to_noise_ratio_linear)
    return probabilities
