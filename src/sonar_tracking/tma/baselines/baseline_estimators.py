"""The published estimators with the parameters of the default one, for comparison."""

from __future__ import annotations

from sonar_tracking.tma.baselines.chan_summed_lines import ChanSummedLines
from sonar_tracking.tma.baselines.cheong_fused_line import CheongFusedLine
from sonar_tracking.tma.baselines.jauffret_stacked_lines import JauffretStackedLines
from sonar_tracking.tma.estimators.bank_restart import FULL, NEVER
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration


def fused_line(configuration: RangeBankConfiguration) -> CheongFusedLine:
    """Return Cheong's filter: all lines fused into one."""
    return CheongFusedLine(_single_filter(configuration))


def summed_lines(configuration: RangeBankConfiguration) -> ChanSummedLines:
    """Return Chan's filter: the sum of all lines, restarted when their set changes."""
    return ChanSummedLines(_single_filter(configuration))


def stacked_lines(configuration: RangeBankConfiguration) -> JauffretStackedLines:
    """Return Jauffret's filter without its restarts: every line a row."""
    return JauffretStackedLines(_single_filter(configuration))


def restarted_stacked_lines(configuration: RangeBankConfiguration) -> JauffretStackedLines:
    """Return Jauffret's filter, restarted when a line appears."""
    return JauffretStackedLines(_single_filter(configuration, FULL))


def _single_filter(
    configuration: RangeBankConfiguration, restart: str = NEVER
) -> SingleFilterConfiguration:
    return SingleFilterConfiguration(
        maximum_range=configuration.maximum_range,
        maximum_speed=configuration.maximum_speed,
        acceleration=configuration.acceleration,
        restart=restart,
    )
