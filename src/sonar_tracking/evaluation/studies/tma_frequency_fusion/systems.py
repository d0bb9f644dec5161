"""The estimators that the tma-frequency-fusion study compares."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from sonar_tracking.tma.estimators.chan_summed_lines import SummedLines
from sonar_tracking.tma.estimators.cheong_fused_line import FusedLine
from sonar_tracking.tma.estimators.jauffret_stacked_lines import (
    FULL,
    SingleFilterConfiguration,
    StackedLines,
)
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement

PROPOSED = "PROPOSED"
CHAN = "CHAN"
JAUFFRET = "JAUFFRET"
STACKED = "stacked, never restarted"
RANGE_BANK = "range bank (default)"
BEARINGS_ONLY = "range bank, bearings only"


class Estimator(Protocol):
    """What all estimators have in common."""

    def update(self, measurement: TmaMeasurement) -> TmaEstimate:
        """Take one measurement in and return where the target is."""


class BearingsOnly:
    """The default estimator without ears for lines: what the bearings alone would have done."""

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


SYSTEMS: dict[str, Callable[[], Estimator]] = {
    PROPOSED: FusedLine,
    CHAN: SummedLines,
    JAUFFRET: lambda: StackedLines(SingleFilterConfiguration(restart=FULL)),
    STACKED: StackedLines,
    RANGE_BANK: RangeBank,
    BEARINGS_ONLY: BearingsOnly,
}
"""How each is made, in the order of the report."""
