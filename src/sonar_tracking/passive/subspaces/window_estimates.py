"""How estimates are made of complete windows: those that are alike together."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.filtering.eigenpairs import Eigenpairs, stacked_eigenpairs
from sonar_tracking.geometry import is_uniform_line
from sonar_tracking.passive.sources.noise_of_windows import common_or_stacked
from sonar_tracking.passive.subspaces.basis_sampling import CapturedSubspace
from sonar_tracking.passive.subspaces.covariance_summary import (
    CovarianceSummary,
    summarise_windows,
)
from sonar_tracking.passive.subspaces.estimation_memory import (
    CompleteWindow,
    EstimationMemory,
    covariance_snapshots,
)
from sonar_tracking.passive.subspaces.sample_schedule import SampleSchedule
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.bearings import SubspaceEstimates

_ENTRIES_AT_ONCE = 1 << 17
"""Snapshots times elements that are summarised at once (2 MB): more do not stay in the cache."""


def estimates_of_windows(
    configuration: SubspaceConfiguration, schedule: SampleSchedule, windows: list[CompleteWindow]
) -> list[SubspaceEstimates]:
    """Return the estimates of several sample times, of one run or of several.

    Parameters
    ----------
    configuration : SubspaceConfiguration
        Parameters of the stage.
    schedule : SampleSchedule
        Sample times.
    windows : list of CompleteWindow
        The window of each sample time.
    """
    summaries = [CovarianceSummary()] * len(windows)
    # Weak sources that no covariance shows by itself are sought in the mean of several.
    alone = configuration.entry.of_covariance and configuration.source_count == 0
    known = [
        row
        for row, each in enumerate(windows)
        if each.subspaces or (alone and each.shows_no_source(configuration.covariance_snapshots))
    ]
    asked = [_Asked.of(windows[row]) for row in known]
    for row, summary in zip(known, _summaries(configuration, asked), strict=True):
        summaries[row] = summary
    return [
        _estimate(configuration, schedule, window, summary)
        for window, summary in zip(windows, summaries, strict=True)
    ]


def _estimate(
    configuration: SubspaceConfiguration,
    schedule: SampleSchedule,
    complete: CompleteWindow,
    summary: CovarianceSummary,
) -> SubspaceEstimates:
    window, memory, subspaces = complete.window, complete.snapshots_from, complete.subspaces
    header, timing = memory.header, memory.timing
    beta = configuration.forgetting_factor
    middle = complete.covariance_end - 0.5 * (summary.n_snapshots - 1)
    offset = timing.time_offset(middle, window.stamp) if summary.n_snapshots else np.nan
    return SubspaceEstimates(
        stamp=window.stamp,
        method=configuration.method,
        basis=_stacked(subspaces, memory),
        time_offsets=np.array([c.timing.time_offset(c.index, window.stamp) for c in subspaces]),
        element_positions=header.element_positions,
        sample_period=header.sample_period,
        center_frequency=header.center_frequency,
        bandwidth=header.bandwidth,
        sound_speed=header.sound_speed,
        effective_snapshots=(1.0 + beta) / (1.0 - beta),
        rank=summary.rank,
        source_count=summary.source_count,
        covariance=summary.covariance,
        covariance_snapshots=summary.n_snapshots,
        covariance_time_offset=offset,
        eigenvalues=summary.eigenvalues,
        eigenvectors=summary.eigenvectors,
        noise_power=summary.noise_power,
        noise_covariance=header.noise_covariance,
        next_stamp=schedule.stamp(window.number + 1),
        sensor=complete.bases_from.sensors.at(window.stamp),
    )


def starting_columns(configuration: SubspaceConfiguration, memory: EstimationMemory) -> int:
    """Return the number of sources by MDL on the newest full covariance, 0 = none seen."""
    (summary,) = _summaries(configuration, [_Asked(memory, memory.timing.last_index)])
    positions = memory.header.element_positions
    count = summary.source_count if is_uniform_line(positions) else summary.rank
    if count == 0 and configuration.entry.of_covariance:
        # The whole array sees weaker sources than the smoothed count does.
        count = summary.rank
    return min(max(count, 0), len(positions) - 1)


def _stacked(subspaces: list[CapturedSubspace], memory: EstimationMemory) -> ComplexArray:
    if subspaces:
        return _without_faults(np.stack([c.basis for c in subspaces], axis=-3), memory)
    batch, n_elements = memory.history.shape[:-2], len(memory.header.element_positions)
    return np.empty((*batch, 0, n_elements, memory.n_columns), dtype=np.complex128)


def _without_faults(bases: ComplexArray, memory: EstimationMemory) -> ComplexArray:
    """Return bases, shape (..., n_used, n_columns), of an array without its faults."""
    if not memory.fit.faults.found:
        return bases
    rows = np.zeros((*bases.shape[:-2], bases.shape[-1], len(memory.used)), dtype=np.complex128)
    rows[..., memory.used] = np.swapaxes(bases, -1, -2)
    return np.swapaxes(memory.fit.undone(rows)[..., memory.used], -1, -2)


@dataclass(frozen=True)
class _Asked:
    """A covariance that is to be summarised.

    Attributes
    ----------
    memory : EstimationMemory
        With its snapshots.
    end : int
        Global index of the last of them.
    covariance : ndarray, shape (n_used, n_used), complex, or None
        The covariance, linear power, if it is known already.
    eigenpairs : Eigenpairs or None
        Of it, if they are known already.
    """

    memory: EstimationMemory
    end: int
    covariance: ComplexArray | None = None
    eigenpairs: Eigenpairs | None = None

    @staticmethod
    def of(window: CompleteWindow) -> _Asked:
        """Return the covariance of a window."""
        memory, end = window.snapshots_from, window.covariance_end
        white = memory.header.noise_covariance is None
        return _Asked(memory, end, window.covariance, window.eigenpairs if white else None)


def _summaries(
    configuration: SubspaceConfiguration, asked: list[_Asked]
) -> list[CovarianceSummary]:
    """Return the summaries of covariances, those alike together."""
    # The columns of the covariance method are no limit to what is in a covariance of its own.
    counted = configuration.entry.of_covariance and configuration.source_count == 0
    windows = [covariance_snapshots(configuration, each.memory, each.end) for each in asked]
    alike: dict[tuple[object, ...], list[int]] = {}
    for row, (each, snapshots) in enumerate(zip(asked, windows, strict=True)):
        n_columns = 0 if counted else each.memory.n_columns
        key = (snapshots.shape, n_columns, each.covariance is None, each.eigenpairs is None)
        alike.setdefault((*key, *_kind(each.memory)), []).append(row)
    summaries = [CovarianceSummary()] * len(asked)
    for rows in alike.values():
        size = windows[rows[0]].shape[-1] * configuration.covariance_snapshots
        most = max(_ENTRIES_AT_ONCE // max(size, 1), 1)
        for part in (rows[begin : begin + most] for begin in range(0, len(rows), most)):
            together = [asked[row] for row in part]
            own = _summarised(configuration, together, [windows[row] for row in part], counted)
            for row, summary in zip(part, own, strict=True):
                summaries[row] = summary
    return summaries


def _summarised(
    configuration: SubspaceConfiguration,
    asked: list[_Asked],
    windows: list[ComplexArray],
    counted: bool,
) -> list[CovarianceSummary]:
    """Return the summaries of covariances that are alike, of the snapshots of each."""
    memories = [each.memory for each in asked]
    noise = common_or_stacked([each.header.noise_covariance for each in memories])
    covariances = [each.covariance for each in asked if each.covariance is not None]
    return summarise_windows(
        np.stack(windows) if len(windows) > 1 else windows[0][None],
        0 if counted else memories[0].n_columns,
        replace(memories[0].header, noise_covariance=noise),
        common_or_stacked([each.whitening for each in memories]),
        math.radians(configuration.maximum_rate_deg),
        np.array(
            [configuration.steering_error or each.fit.steering.error_to_hide for each in memories]
        ),
        np.stack(covariances) if covariances else None,
        stacked_eigenpairs([each.eigenpairs for each in asked]),
    )


def _kind(memory: EstimationMemory) -> tuple[object, ...]:
    """Return what the snapshots of two memories must have in common to be summarised together."""
    header = memory.header
    return (
        memory.history.shape[:-2],
        header.element_positions.tobytes(),
        header.sample_period,
        header.center_frequency,
        header.sound_speed,
        header.noise_covariance is None,
        memory.fit.steering.error > 0.0,
    )
