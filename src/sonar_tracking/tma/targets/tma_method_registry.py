"""The methods of target motion analysis."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.method_registry import MethodEntry, MethodRegistry, trait

_BASELINES = "sonar_tracking.tma.baselines.baseline_estimators"


@dataclass(frozen=True)
class TmaMethodEntry(MethodEntry):
    """A method of target motion analysis.

    Its factory takes a :class:`~sonar_tracking.tma.targets.tma_tracker_configuration.\
TmaTrackerConfiguration` and returns an estimator of one target:
    :class:`~sonar_tracking.tma.estimators.estimator.Estimator`.

    Attributes
    ----------
    weighs_hypotheses : bool
        It is a :class:`~sonar_tracking.tma.estimators.range_bank.RangeBank`, whose hypotheses have
        likelihoods: they decide the side of a line array, and whether the bearings of several
        stations are of one target.
    names_lines : bool
        Estimates the source frequency of each line.
    """

    weighs_hypotheses: bool = trait("decides the side of a line array; joins stations")
    names_lines: bool = trait("estimates the source frequency of each line")


TMA_METHODS = MethodRegistry(
    "tma_tracker.method",
    TmaMethodEntry(
        "range_bank",
        "sonar_tracking.tma.estimators.range_bank:RangeBank",
        "stacked lines in a bank of range hypotheses, never restarted",
        label="range bank",
        weighs_hypotheses=True,
        names_lines=True,
    ),
    TmaMethodEntry(
        "fused_line",
        f"{_BASELINES}:fused_line",
        "all lines fused into one, for comparison",
        label="fused line",
        paper="Cheong 2011",
    ),
    TmaMethodEntry(
        "summed_lines",
        f"{_BASELINES}:summed_lines",
        "the sum of all lines that are received, for comparison",
        label="summed lines",
        paper="Chan, as in Cheong 2011",
    ),
    TmaMethodEntry(
        "stacked_lines",
        f"{_BASELINES}:stacked_lines",
        "every line a row in one filter, for comparison",
        label="stacked lines",
        paper="Jauffret, as in Cheong 2011",
        names_lines=True,
    ),
    TmaMethodEntry(
        "stacked_lines_restarted",
        f"{_BASELINES}:restarted_stacked_lines",
        "the same, restarted when a line appears, for comparison",
        label="stacked lines, restarted",
        paper="Jauffret, as in Cheong 2011",
        names_lines=True,
    ),
)
