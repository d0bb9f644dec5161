"""What the subspace stage remembers between blocks, and how an estimate is made of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.errors import Notice
from sonar_tracking.geometry import is_uniform_line
from sonar_tracking.passive.array_fit.array_fit import ArrayFit
from sonar_tracking.passive.sources.noise_of_windows import common_or_stacked
from sonar_tracking.passive.subspaces.basis_sampling import (
    BasisSampler,
    CapturedSubspace,
    noise_factors,
)
from sonar_tracking.passive.subspaces.channel_monitor import ChannelMonitor
from sonar_tracking.passive.subspaces.covariance_summary import (
    CovarianceSummary,
    summarise_windows,
)
from sonar_tracking.passive.subspaces.sample_schedule import BlockTiming, SampleSchedule, Window
from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.arrays import BoolArray, ComplexArray
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates

_ENTRIES_AT_ONCE = 1 << 17
"""Snapshots times elements that are summarised at once (2 MB): more do not stay in the cache."""


@dataclass(frozen=True)
class EstimationMemory:
    """State of the subspace stage after a block.

    Attributes
    ----------
    array : ArraySnapshots
        Array and frequency, from the first block, without its data.
    header : ArraySnapshots
        The same of the elements that are used.
    sensors : SensorHistory
        The sensor since the last estimate.
    timing : BlockTiming
        Timing of the newest block.
    monitor : ChannelMonitor
        Which elements are bad.
    n_columns : int
        Columns of the subspace; 0 = not known yet.
    next_sample : int
        Number of the first sample time whose window is not open yet.
    history : ndarray, shape (..., n_kept, n_elements), complex
        Newest contiguous snapshots of all elements, linear amplitude, for the sample
        covariance.
    used : ndarray of bool, shape (n_elements,)
        Elements that are not left out.
    whitening : ndarray, shape (n_used, n_used), complex, or None
        Inverse Cholesky factor of their noise covariance, pure numbers; None = white noise.
    sampler : BasisSampler or None
        Follows the subspace; None before it starts.
    next_count : int
        Global index before which the sources are not counted (again).
    windows : tuple of Window
        Open windows, in order of time.
    captured : tuple of CapturedSubspace
        Bases taken for them.
    fit : ArrayFit
        What the data have told of the array.
    """

    array: ArraySnapshots
    header: ArraySnapshots
    sensors: SensorHistory
    timing: BlockTiming
    monitor: ChannelMonitor
    n_columns: int
    next_sample: int
    history: ComplexArray
    used: BoolArray
    whitening: ComplexArray | None
    sampler: BasisSampler | None = None
    next_count: int = 0
    windows: tuple[Window, ...] = ()
    captured: tuple[CapturedSubspace, ...] = ()
    fit: ArrayFit = field(default_factory=ArrayFit)

    @property
    def used_history(self) -> ComplexArray:
        """Snapshots kept of the elements in use, shape (..., n_kept, n_used), linear amplitude."""
        return self.history if self.used.all() else self.history[..., self.used]

    def fitted(self, fit: ArrayFit) -> EstimationMemory:
        """Return the memory with an array as the data have told it: faults undone, noise found."""
        header, whitening = self.header, self.whitening
        noise = fit.noise_covariance(header.element_positions)
        if noise is not None and header.noise_covariance is None:
            header, whitening = replace(header, noise_covariance=noise), noise_factors(noise)[1]
        history = fit.undone(self.history)
        return replace(self, header=header, whitening=whitening, history=history, fit=fit)

    def without_windows(self, closed: list[Window]) -> EstimationMemory:
        """Return the memory without some windows, one at least, and what was kept for them."""
        windows = tuple(w for w in self.windows if w not in closed)
        captured = tuple(c for c in self.captured if any(c.index in w.indices for w in windows))
        sensors = self.sensors.since(closed[-1].stamp)
        return replace(self, windows=windows, captured=captured, sensors=sensors)


@dataclass(frozen=True)
class CompleteWindow:
    """A window whose estimate can be made.

    Attributes
    ----------
    window : Window
        The window; subspaces that are missing in it are left out.
    bases_from : EstimationMemory
        The newest memory: captured bases and where the sensor was.
    snapshots_from : EstimationMemory
        Array and snapshots of the covariance: of the same memory, or of the one before a gap.
    """

    window: Window
    bases_from: EstimationMemory
    snapshots_from: EstimationMemory

    @property
    def subspaces(self) -> list[CapturedSubspace]:
        """The bases taken for it."""
        return [c for c in self.bases_from.captured if c.index in self.window.indices]

    def shows_no_source(self, n_snapshots: int) -> bool:
        """Return whether no subspace is followed though there are so many snapshots to see one."""
        return (
            self.snapshots_from.sampler is None
            and self.snapshots_from.history.shape[-2] >= n_snapshots
        )

    @property
    def covariance_end(self) -> int:
        """Global index of the last snapshot of its covariance."""
        return min(self.window.covariance_end, self.snapshots_from.timing.last_index)


@dataclass(frozen=True)
class AdvancedRun:
    """A run after one more block, before its estimates are made.

    Attributes
    ----------
    memory : EstimationMemory
        After the block.
    complete : list of CompleteWindow
        Windows that it has completed.
    notices : list of Notice
        What a user should know about it.
    end_of_data : bool
        Whether it is the last one.
    """

    memory: EstimationMemory
    complete: list[CompleteWindow]
    notices: list[Notice]
    end_of_data: bool


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
    ends = [(windows[row].snapshots_from, windows[row].covariance_end) for row in known]
    for row, summary in zip(known, _summaries(configuration, ends), strict=True):
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
        noise_power=summary.noise_power,
        noise_covariance=header.noise_covariance,
        next_stamp=schedule.stamp(window.number + 1),
        sensor=complete.bases_from.sensors.at(window.stamp),
    )


def ready_to_count(configuration: SubspaceConfiguration, memory: EstimationMemory) -> bool:
    """Return whether there is a full covariance that no sources were counted on yet."""
    full = memory.history.shape[-2] >= configuration.covariance_snapshots
    return full and memory.timing.last_index >= memory.next_count


def starting_columns(configuration: SubspaceConfiguration, memory: EstimationMemory) -> int:
    """Return the number of sources by MDL on the newest full covariance, 0 = none seen."""
    (summary,) = _summaries(configuration, [(memory, memory.timing.last_index)])
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


def _summaries(
    configuration: SubspaceConfiguration, ends: list[tuple[EstimationMemory, int]]
) -> list[CovarianceSummary]:
    """Return the summaries of the covariances that end at some snapshots, those alike together."""
    # The columns of the covariance method are no limit to what is in a covariance of its own.
    counted = configuration.entry.of_covariance and configuration.source_count == 0
    alike: dict[tuple[object, ...], list[int]] = {}
    for row, (memory, end) in enumerate(ends):
        n_snapshots = covariance_snapshots(configuration, memory, end).shape[-2]
        key = (n_snapshots, 0 if counted else memory.n_columns, *_kind(memory))
        alike.setdefault(key, []).append(row)
    summaries = [CovarianceSummary()] * len(ends)
    for rows in alike.values():
        first = ends[rows[0]][0]
        size = first.used_history.shape[-1] * configuration.covariance_snapshots
        most = max(_ENTRIES_AT_ONCE // max(size, 1), 1)
        for part in (rows[begin : begin + most] for begin in range(0, len(rows), most)):
            windows = [covariance_snapshots(configuration, *ends[row]) for row in part]
            memories = [ends[row][0] for row in part]
            noise = common_or_stacked([each.header.noise_covariance for each in memories])
            together = summarise_windows(
                np.stack(windows) if len(windows) > 1 else windows[0][None],
                0 if counted else first.n_columns,
                replace(first.header, noise_covariance=noise),
                common_or_stacked([each.whitening for each in memories]),
                math.radians(configuration.maximum_rate_deg),
                np.array(
                    [
                        configuration.steering_error or each.fit.steering.error_to_hide
                        for each in memories
                    ]
                ),
            )
            for row, summary in zip(part, together, strict=True):
                summaries[row] = summary
    return summaries


def covariance_snapshots(
    configuration: SubspaceConfiguration, memory: EstimationMemory, end: int
) -> ComplexArray:
    """Return the snapshots of the covariance that ends at a snapshot.

    Parameters
    ----------
    configuration : SubspaceConfiguration
        Parameters of the stage.
    memory : EstimationMemory
        With the snapshots kept.
    end : int
        Global index of the last snapshot of the covariance.

    Returns
    -------
    ndarray, shape (..., n_snapshots, n_used), complex
        Of the elements in use, linear amplitude.
    """
    begin_of_history = memory.timing.last_index + 1 - memory.history.shape[-2]
    stop = max(end + 1 - begin_of_history, 0)
    start = max(stop - configuration.covariance_snapshots, 0)
    return memory.used_history[..., start:stop, :]


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
