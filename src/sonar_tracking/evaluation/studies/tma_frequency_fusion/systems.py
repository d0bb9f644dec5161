"""The estimators that the tma-frequency-fusion study compares."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from sonar_tracking.evaluation.monte_carlo.compared_methods import compared_methods
from sonar_tracking.tma.estimators.estimator import Estimator
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement
from sonar_tracking.tma.targets.tma_method_registry import TMA_METHODS
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

PROPOSED = "PROPOSED"
CHAN = "CHAN"
JAUFFRET = "JAUFFRET"
STACKED = "stacked, never restarted"
RANGE_BANK = "range bank (default)"
BEARINGS_ONLY = "range bank, bearings only"


class BearingsOnly:
    """The default estimator with bearings only: what the bearings alone would have done."""

    def __init__(self) -> None:
        self._bank = RangeBank()

    def update(self, measurement: TmaMeasurement) -> TmaEstimate:
        """Take the azimuth of one measurement in and return where the target is."""
        deaf = replace(
            measurement,
            frequency=measurement.frequency[..., :0],
            frequency_deviation=measurement.frequency_deviation[..., :0],
        )
        return self._bank.update(deaf)


METHODS = compared_methods(
    TMA_METHODS,
    {
        PROPOSED: "fused_line",
        CHAN: "summed_lines",
        JAUFFRET: "stacked_lines_restarted",
        STACKED: "stacked_lines",
        RANGE_BANK: "range_bank",
    },
)
"""Method of each estimator, by its name."""

SYSTEMS: dict[str, Callable[[], Estimator]] = {
    name: partial(TMA_METHODS[method].make, TmaTrackerConfiguration())
    for name, method in METHODS.items()
} | {BEARINGS_ONLY: BearingsOnly}
"""How each is made, in the order of the report."""
