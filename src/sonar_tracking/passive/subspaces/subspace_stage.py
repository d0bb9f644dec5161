"""Snapshots of an array -> signal subspaces around each sample time.

A recursive method (:mod:`sonar_tracking.passive.subspaces.subspace_method_registry`) follows the
signal subspace through all snapshots. Around each sample time k T the stage publishes P adjacent
subspaces (Ryu, Park, Choi 2003, eq. 7) and the sample covariance of the snapshots before or around
it. The first estimate belongs to the first sample time whose window is complete. Bad elements are
left out (:mod:`sonar_tracking.passive.subspaces.channel_monitor`): the subspace is then started
again on the others, from the snapshots that are kept for the covariance.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.passive.subspaces.basis_sampling import noise_factors, start_sampler
from sonar_tracking.passive.subspaces.block_checks import check_first_block, check_next_block
from sonar_tracking.passive.subspaces.channel_monitor import (
    ChannelMonitor,
    new_monitor,
    updated_monitors,
    used_elements,
)
from sonar_tracking.passive.subspaces.estimation_memory import (
    AdvancedRun,
    CompleteWindow,
    EstimationMemory,
    ready_to_count,
)
from sonar_tracking.passive.subspaces.fitted_windows import fitted_windows
from sonar_tracking.passive.subspaces.rehearsal import rehearsed_block
from sonar_tracking.passive.subspaces.sample_schedule import (
    SampleSchedule,
    first_timing,
    period_in_nanoseconds,
)
from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.passive.subspaces.subspace_configuration import (
    SubspaceConfiguration,
    check_configuration,
)
from sonar_tracking.passive.subspaces.subspace_method import SubspaceMethod
from sonar_tracking.passive.subspaces.subspace_notices import (
    estimate_notices,
    gap_notice,
    singular_notice,
)
from sonar_tracking.passive.subspaces.window_estimates import estimates_of_windows, starting_columns
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import END_OF_DATA

__all__ = ["SubspaceConfiguration", "SubspaceStage", "SubspaceUpdate", "update_together"]

Closed = tuple[EstimationMemory, list[CompleteWindow]]
Channels = tuple[ChannelMonitor, tuple[Notice, ...]]

LONG_GAP_PERIODS = 10
"""Sample times in a gap longer than this many periods give no estimates at all."""


@dataclass(frozen=True)
class SubspaceUpdate:
    """What one block of snapshots gave.

    Attributes
    ----------
    estimates : tuple of SubspaceEstimates
        One for each sample time whose window this block completed.
    notices : tuple of Notice
        What a user should know about the block.
    """

    estimates: tuple[SubspaceEstimates, ...]
    notices: tuple[Notice, ...]


class SubspaceStage:
    """Follows the signal subspace and publishes it around each sample time.

    Parameters
    ----------
    configuration : SubspaceConfiguration
        Parameters.
    method : SubspaceMethod, optional
        What follows the subspace, if not the method of the configuration.

    Raises
    ------
    ConfigurationError
        If the parameters do not fit together.

    Examples
    --------
    >>> stage = SubspaceStage(SubspaceConfiguration(method="past", source_count=2))
    >>> update = stage.update(block)  # doctest: +SKIP
    >>> for estimates in update.estimates:  # doctest: +SKIP
    ...     tracks = tracker.update(estimates).tracks
    """

    def __init__(
        self, configuration: SubspaceConfiguration, method: SubspaceMethod[Any] | None = None
    ) -> None:
        check_configuration(configuration)
        self.configuration = configuration
        self._method: SubspaceMethod[Any] = method or configuration.entry.make(configuration)
        self._schedule = SampleSchedule(
            period_in_nanoseconds(configuration.period),
            configuration.n_subspaces,
            configuration.step,
            configuration.covariance_lookahead,
        )
        self._kept_snapshots = configuration.covariance_snapshots + self._schedule.reach
        self._memory: EstimationMemory | None = None

    def warm_up(self) -> None:
        """Let a stage like this one estimate from made-up data: its first use of much is slow."""
        n_snapshots = 2 * (self._kept_snapshots + self._schedule.reach) + 20
        configuration = self.configuration
        block = rehearsed_block(configuration.source_count, n_snapshots, configuration.period)
        with suppress(InputError):
            SubspaceStage(configuration).update(block)

    def reset(self) -> None:
        """Forget all data: the next block starts a new run."""
        self._memory = None

    def update(self, block: ArraySnapshots) -> SubspaceUpdate:
        """Take one block of snapshots.

        Parameters
        ----------
        block : ArraySnapshots
            Contiguous with the block before, or after a gap.

        Returns
        -------
        SubspaceUpdate
            Estimates of the sample times completed by this block, in order.

        Raises
        ------
        InputError
            If the block cannot be used; the stage is then as before.
        """
        return update_together([self], [block])[0]

    def _advance(
        self, block: ArraySnapshots, admitted: EstimationMemory, missing: int, channels: Channels
    ) -> AdvancedRun:
        """Return what there is to remember after a block, and the windows it has completed."""
        before, (monitor, channel_notices) = self._memory, channels
        notices, complete = list(channel_notices), list[CompleteWindow]()
        memory = self._choose_elements(replace(admitted, monitor=monitor))
        memory = self._open_windows(memory, missing)
        if before is not None and missing:
            notices.append(gap_notice(missing, block))
            memory, complete = self._close_lost_windows(memory, before)
        memory, sampling_notices = self._sample_bases(memory, block)
        notices += sampling_notices
        end_of_data = block.next_stamp == END_OF_DATA
        memory, completed = self._close_complete_windows(memory, end_of_data)
        complete.extend(completed)
        if end_of_data and not complete:
            # The last estimate carries the end, if only an empty one.
            window = self._schedule.window(memory.next_sample, memory.timing)
            memory = replace(memory, next_sample=memory.next_sample + 1)
            complete = [CompleteWindow(window, memory, memory)]
        return AdvancedRun(memory, complete, notices, end_of_data)

    def _admit(self, block: ArraySnapshots) -> tuple[EstimationMemory, int]:
        """Check a block and place it in time; return how many snapshots are missing before it."""
        if (memory := self._memory) is None:
            return self._begin(block), 0
        check_next_block(block, memory.array)
        timing, missing = memory.timing.following(block.stamp, block.data.shape[-2])
        if missing < 0:
            raise InputError(
                f"The block begins {-missing} snapshots before the end of the block before it; "
                "blocks must follow each other in time."
            )
        history = memory.history if missing == 0 else memory.history[..., :0, :]
        sensors = memory.sensors.append(block.stamp, block.sensor)
        return replace(memory, sensors=sensors, timing=timing, history=history), missing

    def _begin(self, block: ArraySnapshots) -> EstimationMemory:
        """Return what there is to remember before the first block of a run."""
        configuration = self.configuration
        check_first_block(block, configuration.source_count)
        if configuration.source_count == 0 and block.data.ndim > 2:
            raise InputError(
                "source_count = 0 cannot be used on a batch of runs; give the number of sources."
            )
        timing = first_timing(block.stamp, block.data.shape[-2], block.sample_period)
        covariance, n_elements = block.noise_covariance, block.data.shape[-1]
        array = replace(block, data=block.data[..., :0, :])
        return EstimationMemory(
            array=array,
            header=array,
            sensors=SensorHistory(((block.stamp, block.sensor),)),
            timing=timing,
            monitor=new_monitor(n_elements),
            n_columns=configuration.source_count,
            next_sample=self._schedule.first_complete(timing),
            history=np.empty((*block.data.shape[:-2], 0, n_elements), complex),
            used=np.ones(n_elements, dtype=bool),
            whitening=None if covariance is None else noise_factors(covariance)[1],
        )

    def _choose_elements(self, memory: EstimationMemory) -> EstimationMemory:
        """Leave bad elements out, or take them back; the subspace then starts again."""
        used, count = memory.monitor.used, self.configuration.source_count
        if memory.history.ndim > 2 or np.count_nonzero(used) <= max(count, 1):
            return memory
        if np.array_equal(used, memory.used):
            return memory
        header = used_elements(memory.array, used)
        noise = header.noise_covariance
        return replace(
            memory,
            header=header,
            used=used,
            whitening=None if noise is None else noise_factors(noise)[1],
            sampler=None,
            n_columns=count,
            next_count=0,
            captured=(),
        )

    def _open_windows(self, memory: EstimationMemory, missing: int) -> EstimationMemory:
        """Open the windows that reach into the block; leave out those lost in a long gap."""
        timing, windows, number = memory.timing, list(memory.windows), memory.next_sample
        if missing * timing.sample_period > LONG_GAP_PERIODS * self._schedule.period:
            windows = [w for w in windows if any(c.index in w.indices for c in memory.captured)]
            number = max(number, self._schedule.first_unfinished(timing))
        while (window := self._schedule.window(number, timing)).first <= timing.last_index:
            windows.append(window)
            number += 1
        if number == memory.next_sample and len(windows) == len(memory.windows):
            return memory
        return replace(memory, windows=tuple(windows), next_sample=number)

    def _sample_bases(
        self, memory: EstimationMemory, block: ArraySnapshots
    ) -> tuple[EstimationMemory, list[Notice]]:
        """Lead the subspace through the block and take the bases that the windows want."""
        first_index, data = memory.timing.first_index, np.asarray(block.data, dtype=np.complex128)
        history = np.concatenate([memory.history, data], axis=-2)
        data = data if memory.used.all() else data[..., memory.used]
        if memory.sampler is None:
            memory = self._start_sampler(replace(memory, history=history))
            if memory.sampler is None:
                return memory, []
            if self.configuration.source_count == 0:
                # The snapshots the sources were counted on are not lost to the subspace.
                data = memory.used_history
                first_index = memory.timing.last_index + 1 - data.shape[-2]
        wanted = {index for window in memory.windows for index in window.indices}
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                sampler, new = memory.sampler.advance(data, first_index, memory.timing, wanted)
            usable = all(np.isfinite(subspace.basis).all() for subspace in new)
        except np.linalg.LinAlgError:
            usable = False
        if not usable:
            told = [singular_notice(memory.n_columns)]
            return replace(memory, history=history, sampler=None), told
        return replace(memory, history=history, sampler=sampler, captured=memory.captured + new), []

    def _start_sampler(self, memory: EstimationMemory) -> EstimationMemory:
        """Begin to follow the subspace, once the number of its columns is known."""
        configuration, n_columns = self.configuration, memory.n_columns
        if n_columns == 0 and ready_to_count(configuration, memory):
            n_columns = starting_columns(configuration, memory)
            next_count = memory.timing.last_index + configuration.covariance_snapshots
            memory = replace(memory, next_count=next_count)
        if n_columns == 0:
            return memory
        sampler = start_sampler(
            self._method,
            len(memory.header.element_positions),
            n_columns,
            memory.history.shape[:-2],
            memory.header.noise_covariance,
        )
        return replace(memory, n_columns=n_columns, sampler=sampler)

    def _close_lost_windows(self, memory: EstimationMemory, before: EstimationMemory) -> Closed:
        """Close the windows that end in the gap, with the snapshots from before it."""
        lost = [w for w in memory.windows if w.complete < memory.timing.first_index]
        complete = [CompleteWindow(window, memory, before) for window in lost]
        return memory.without_windows(lost) if lost else memory, complete

    def _close_complete_windows(self, memory: EstimationMemory, end: bool) -> Closed:
        """Close the windows that are complete; at the end of the data also those begun."""
        last_index = memory.timing.last_index
        done = [w for w in memory.windows if end or w.complete <= last_index]
        complete = [CompleteWindow(window, memory, memory) for window in done]
        oldest = max(memory.history.shape[-2] - self._kept_snapshots, 0)
        memory = replace(memory, history=memory.history[..., oldest:, :])
        return memory.without_windows(done) if done else memory, complete


def update_together(
    stages: Sequence[SubspaceStage], blocks: Sequence[ArraySnapshots]
) -> list[SubspaceUpdate]:
    """Take one block of each of several independent runs, as each stage would by itself.

    Parameters
    ----------
    stages : sequence of SubspaceStage
        One a run, all of the same configuration.
    blocks : sequence of ArraySnapshots
        One a run.

    Returns
    -------
    list of SubspaceUpdate
        One a run.

    Raises
    ------
    InputError
        If a block cannot be used; all stages are then as before.
    """
    admitted = [stage._admit(block) for stage, block in zip(stages, blocks, strict=True)]
    channels = updated_monitors([memory.monitor for memory, _ in admitted], blocks)
    advanced = [
        stage._advance(block, *own, monitored)
        for stage, block, own, monitored in zip(stages, blocks, admitted, channels, strict=True)
    ]
    configuration = stages[0].configuration
    fitted = fitted_windows(configuration, [(each.memory.fit, each.complete) for each in advanced])
    complete = [window for run in fitted for window in run.windows]
    made = iter(estimates_of_windows(configuration, stages[0]._schedule, complete))
    updates = []
    for stage, each, run in zip(stages, advanced, fitted, strict=True):
        estimates = list(islice(made, len(each.complete)))
        if each.end_of_data:
            estimates[-1] = replace(estimates[-1], next_stamp=END_OF_DATA)
        notices = [*each.notices, *estimate_notices(estimates, run.fit, each.memory)]
        stage._memory = replace(each.memory, fit=run.fit) if each.complete else each.memory
        updates.append(SubspaceUpdate(tuple(estimates), tuple(notices)))
    return updates
