"""The constant error of the azimuths of a station, as a trial of several stations finds it.

No array is aligned exactly. A station alone does not show it: the target is taken to be where it
is seen. Stations that look at one target go on to disagree by it, bearing after bearing, and that
must count once, not once a bearing. So a trial takes the innovation of a station for

    nu = b + e,   var e = S,   b = 0, or, with some probability, b ~ N(0, s^2) and constant,

with S the variance without b. In the second case b is followed by a scalar Kalman filter, and the
likelihoods of the innovations decide between the two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class LastingError:
    """What is known of it.

    Attributes
    ----------
    mean, variance : float
        If there is one, rad and rad^2.
    log_odds : float
        That there is one.
    """

    mean: float
    variance: float
    log_odds: float

    def density(self, without: float, with_error: float) -> float:
        """Return the log density of an azimuth from those without an error and with one."""
        none = -np.logaddexp(0.0, self.log_odds)
        return float(np.logaddexp(none + without, none + self.log_odds + with_error))

    def learnt(
        self, without: float, with_error: float, innovation: float, spread: float
    ) -> LastingError:
        """Return what is known after an azimuth.

        Parameters
        ----------
        without, with_error : float
            Log densities of the azimuth.
        innovation : float
            Measured less expected with the mean of the error, rad.
        spread : float
            Its variance, that of the error included, rad^2; 0 = nothing was learnt.
        """
        odds = self.log_odds + with_error - without
        if spread <= 0.0:
            return LastingError(self.mean, self.variance, odds)
        gain = self.variance / spread
        return LastingError(self.mean + gain * innovation, (1.0 - gain) * self.variance, odds)


NO_ERROR = LastingError(0.0, 0.0, -np.inf)
"""There is none."""
