"""The amplitudes that false contacts have: exponential in noise, heavier tails in reverberation.

What lies above a high threshold follows a generalized Pareto law nearly whatever the law of the
whole is, with the density of the excess x

    p(x) = 1/s (1 + k x / s)^(-1 - 1/k),

exponential for a shape k of zero. Its two parameters follow from two L-moments in closed form.

References
----------
J. Pickands, "Statistical inference using extreme order statistics", Annals of Statistics 3(1),
1975; J. R. M. Hosking, J. R. Wallis, "Parameter and quantile estimation for the generalized Pareto
distribution", Technometrics 29(3), 1987, for the L-moments.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.detection.gate_association import amplitude_likelihood_ratio
from sonar_tracking.records.arrays import FloatArray

LARGEST_SHAPE = 0.9
"""With a shape of one there is no mean from which to estimate."""

SMALLEST_SHAPE = 1e-6
"""Below it the law is exponential."""


@dataclass(frozen=True)
class ExcessLaw:
    """Law of what false contacts have above the threshold of the detector.

    Attributes
    ----------
    scale : float
        s, linear power, noise mean 1.
    shape : float
        k, pure number from 0 on: the weight of the tail.
    """

    scale: float
    shape: float

    def likelihood_ratio(
        self,
        excess: FloatArray,
        raised: FloatArray,
        signal_to_noise_ratio_linear: float | FloatArray,
    ) -> FloatArray:
        """Return e, target against false contact, of contacts above a threshold.

        It grows with the amplitude: past its maximum, where only a heavy tail has contacts, it
        stays what it is there, since targets may be stronger than they were thought.

        Parameters
        ----------
        excess : ndarray, shape (n,)
            Of the contacts above the threshold in force, linear powers.
        raised : ndarray, shape (n,)
            Of that threshold above the detector's, linear powers.
        signal_to_noise_ratio_linear : float or ndarray, shape (m, 1)
            Of the target, power ratio; several of them give a row each.

        Returns
        -------
        ndarray, shape (n,) or (m, n)
            Pure numbers.
        """
        if self == IN_NOISE:
            return amplitude_likelihood_ratio(excess, 0.0, signal_to_noise_ratio_linear)
        mean = 1.0 + signal_to_noise_ratio_linear
        # Above a higher threshold the law is of the same kind, with another scale.
        scale = self.scale + self.shape * np.maximum(raised, 0.0)
        if self.shape < SMALLEST_SHAPE:
            slope = np.maximum(1.0 / scale - 1.0 / mean, 0.0)
            return np.asarray(np.exp(slope * excess) * scale / mean)
        largest = np.maximum(((1.0 + self.shape) * mean - scale) / self.shape, 0.0)
        counted = np.minimum(excess, largest)
        tail = (1.0 + 1.0 / self.shape) * np.log1p(self.shape * counted / scale)
        return np.asarray(np.exp(tail - counted / mean) * scale / mean)


IN_NOISE = ExcessLaw(1.0, 0.0)
"""As detectors claim: exponential noise of mean 1."""


def fit_excess_law(excess: FloatArray) -> ExcessLaw:
    """Return the law of excesses by their first two L-moments.

    Parameters
    ----------
    excess : ndarray, shape (n,)
        Of false contacts above the threshold, linear powers; at least two.
    """
    ascending = np.sort(excess)
    count = len(ascending)
    mean = float(np.mean(ascending))
    ranked = float(np.arange(count) @ ascending) / (count * (count - 1))
    difference = 2.0 * ranked - mean
    if not difference > 0.0:
        return ExcessLaw(max(mean, math.ulp(1.0)), 0.0)
    shape = min(max(2.0 - mean / difference, 0.0), LARGEST_SHAPE)
    return ExcessLaw((1.0 - shape) * mean, shape)
