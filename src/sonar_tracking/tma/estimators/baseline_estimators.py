"""The published estimators with the parameters of the default one, for comparison."""

from __future__ import annotations

from sonar_tracking.tma.estimators.chan_summed_lines import SummedLines
from sonar_tracking.tma.estimators.cheong_fused_line import FusedLine
from sonar_tracking.tma.estimators.jauffret_stacked_lines import (
    FULL,
    NEVER,
    SingleFilterConfiguration,
    StackedLines,
)
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration


def fused_line(configuration: RangeBankConfiguration) -> FusedLine:
    """Return Cheong's filter: all lines fused into one."""
    return FusedLine(_single_filter(configuration))


def summed_lines(configuration: RangeBankConfiguration) -> SummedLines:
    """Return Chan's filter: the sum of all lines, restarted when their set changes."""
    return SummedLines(_single_filter(configuration))


def stacked_lines(configuration: RangeBankConfiguration) -> StackedLines:
    """Return Jauffret's filter without its restarts: every line a row."""
    return StackedLines(_single_filter(configuration))


def restarted_stacked_lines(configuration: RangeBankConfiguration) -> StackedLines:
    """Return Jauffret's filter, restarted when a line appears."""
    return StackedLines(_single_filter(configuration, FULL))


def _single_filter(
    configuration: RangeBankConfiguration, restart: str = NEVER
) -> SingleFilterConfiguration:
    return SingleFilterConfiguration(
        maximum_range=configuration.maximum_range,
        maximum_speed=configuration.maximum_speed,
        acceleration=configuration.acceleration,
        restart=restart,
    )
