"""Chan's summed lines: the sum of all lines present is one line, restarted when their set changes.

The sum of frequencies obeys the Doppler equation with the sum of the source frequencies, which
means something else whenever a line comes or goes; hence the restarts.

References
----------
Cheong (2011), "A robust target motion analysis algorithm for discontinuous frequency
measurements" (in Korean), eqs. 14-16, after Y. T. Chan.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.tma.estimators.bank_restart import FULL, restart_bank
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.recursion import elapsed, estimate_of, extended_step
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration


class ChanSummedLines:
    """Chan's filter: one line that is the sum, a full restart at any change of the set.

    Parameters
    ----------
    configuration : SingleFilterConfiguration
        Its parameters; the restart is always full.
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
        summed = sum_of_lines(measurement)
        if self._bank is None:
            self._bank, self._stamp = self._configuration.start(summed), measurement.stamp
        else:
            changed = np.any(heard != self._heard, axis=-1)
            self._bank = restart_bank(self._bank, self._configuration.start(summed), changed, FULL)
        self._heard = heard
        interval = elapsed(self._stamp, measurement.stamp)
        self._bank = extended_step(self._bank, summed, interval, self._configuration.acceleration)
        self._stamp = measurement.stamp
        return estimate_of(self._bank, summed)


def sum_of_lines(measurement: TmaMeasurement) -> TmaMeasurement:
    """Return the measurement with one line, the sum of those present (eqs. 14, 15).

    Parameters
    ----------
    measurement : TmaMeasurement
        Any number of lines; where none is present there is no sum either.
    """
    heard = measurement.heard
    some = np.any(heard, axis=-1)
    total = np.sum(np.where(heard, measurement.frequency, 0.0), axis=-1)
    variance = np.sum(np.where(heard, measurement.frequency_deviation**2, 0.0), axis=-1)
    return replace(
        measurement,
        frequency=np.where(some, total, np.nan)[..., None],
        frequency_deviation=np.sqrt(variance)[..., None],
    )
