"""Jauffret's stacked lines: every line a row, every source frequency a state, one Kalman filter.

The filter is extended, as the paper describes it. The paper restarts it whenever a line appears,
"since the dimension changes"; the policy is a parameter here, so that the effect of the restart
can be told from that of the model.

References
----------
Cheong (2011), "A robust target motion analysis algorithm for discontinuous frequency
measurements" (in Korean), eqs. 3-13, 24, 25,
after C. Jauffret.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.tma.estimators.bank_restart import NEVER, restart_bank
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.recursion import elapsed, estimate_of, extended_step
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration


class JauffretStackedLines:
    """Jauffret's filter with a choice of restarts.

    Parameters
    ----------
    configuration : SingleFilterConfiguration
        Its parameters.
    """

    def __init__(self, configuration: SingleFilterConfiguration | None = None) -> None:
        self._configuration = configuration or SingleFilterConfiguration()
        self._bank: HypothesisBank | None = None
        self._stamp = 0
        self._heard: BoolArray = np.zeros(0, dtype=bool)

    def update(self, measurement: TmaMeasurement) -> TmaEstimate:
        """Take one measurement in and return where the target is.

        Parameters
        ----------
        measurement : TmaMeasurement
            With one finite azimuth.
        """
        heard = measurement.heard
        if self._bank is None:
            self._bank, self._stamp = self._configuration.start(measurement), measurement.stamp
        elif self._configuration.restart != NEVER:
            appeared = np.any(heard & ~self._heard, axis=-1)
            policy = self._configuration.restart
            fresh = self._configuration.start(measurement)
            self._bank = restart_bank(self._bank, fresh, appeared, policy)
        self._heard = heard
        interval = elapsed(self._stamp, measurement.stamp)
        acceleration = self._configuration.acceleration
        self._bank = extended_step(self._bank, measurement, interval, acceleration)
        self._stamp = measurement.stamp
        return estimate_of(self._bank, measurement)
