"""Stacked lines in one extended Kalman filter: every line a row, every source frequency a state.

This is Jauffret's filter as the paper describes it. The paper restarts it whenever a line appears,
"since the dimension changes"; the policy is a parameter here, so that the effect of the restart
can be told from that of the model.

References
----------
Cheong (2011), eqs. 3-13, 24, 25.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import (
    SOURCE_FREQUENCY_SPREAD,
    HypothesisBank,
    start_bank,
)
from sonar_tracking.tma.estimators.recursion import elapsed, estimate_of, extended_step
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaEstimate, TmaMeasurement

NEVER, FULL, COVARIANCE, SOURCE_FREQUENCY = "never", "full", "covariance", "source_frequency"


@dataclass(frozen=True)
class SingleFilterConfiguration:
    """Parameters of the filters with one hypothesis."""

    maximum_range: float = parameter(
        20_000.0, "The initial range is uniform up to this", unit="m", minimum=1.0
    )
    maximum_speed: float = parameter(20.0, "Of the target, per axis", unit="m/s", minimum=0.1)
    acceleration: float = parameter(0.01, "Process noise", unit="m/s^2", minimum=0.0)
    restart: str = parameter(
        NEVER,
        "What a line that appears restarts",
        choices=(NEVER, FULL, COVARIANCE, SOURCE_FREQUENCY),
    )

    def start(self, measurement: TmaMeasurement) -> HypothesisBank:
        """Return the paper's prior (24), (25) around the measured azimuth."""
        edges = np.array([0.0, self.maximum_range])
        return start_bank(measurement, edges, self.maximum_speed)


class StackedLines:
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
            self._bank = restarted(self._bank, fresh, appeared, policy)
        self._heard = heard
        interval = elapsed(self._stamp, measurement.stamp)
        acceleration = self._configuration.acceleration
        self._bank = extended_step(self._bank, measurement, interval, acceleration)
        self._stamp = measurement.stamp
        return estimate_of(self._bank, measurement)


def restarted(
    bank: HypothesisBank, fresh: HypothesisBank, which: BoolArray, policy: str
) -> HypothesisBank:
    """Return the bank with some of its runs restarted.

    Parameters
    ----------
    bank : HypothesisBank
        Posterior of the previous frame.
    fresh : HypothesisBank
        A start at the present frame, without lines.
    which : ndarray of bool, shape (...)
        Runs to restart.
    policy : str
        ``full``: motion and all source frequencies. ``covariance``: the covariance, not the
        estimate. ``source_frequency``: the source frequencies only.
    """
    known = bank.known & ~which[..., None]
    if policy == SOURCE_FREQUENCY:
        return replace(bank, known=known)
    diffuse = fresh.covariance.copy()
    if policy == COVARIANCE:
        lines = np.arange(KINEMATIC, bank.mean.shape[-1])
        diffuse[..., lines, lines] = (SOURCE_FREQUENCY_SPREAD * bank.mean[..., KINEMATIC:]) ** 2
        return replace(bank, covariance=_chosen(which, diffuse, bank.covariance))
    covariance = _chosen(which, diffuse, bank.covariance)
    mean = _chosen(which, fresh.mean, bank.mean)
    weight = _chosen(which, fresh.log_weight, bank.log_weight)
    return HypothesisBank(mean, covariance, weight, known)


def _chosen(which: BoolArray, one: FloatArray, other: FloatArray) -> FloatArray:
    shape = which.shape + (1,) * (other.ndim - which.ndim)
    return np.where(which.reshape(shape), one, other)
