"""Snapshots of an array -> signal subspaces around each sample time.

A recursive method (PAST, OPAST, block PAST or the eigenvectors of an exponentially weighted
covariance) follows the signal subspace through all snapshots. Around each sample time k T the stage
publishes P adjacent subspaces (Ryu, Park, Choi 2003, eq. 7) and the sample covariance of the
snapshots before or around it. The first estimate belongs to the first sample time whose window is
complete. Bad elements are left out (:mod:`sonar_tracking.passive.subspaces.channel_monitor`): the
subspace is then started again on the others, from the snapshots that are kept for the covariance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.errors import ConfigurationError, InputError, Notice, Severity
from sonar_tracking.passive.subspaces.basis_sampling import (
    SubspaceRecursion,
    make_method,
    noise_factors,
    start_recursion,
)
from sonar_tracking.passive.subspaces.block_checks import (
    check_block,
    check_first_block,
    check_unchanged,
)
from sonar_tracking.passive.subspaces.channel_monitor import new_monitor, used_elements
from sonar_tracking.passive.subspaces.estimation_memory import (
    SubspaceRun,
    ready_to_count,
    starting_columns,
    window_estimates,
)
from sonar_tracking.passive.subspaces.sample_schedule import (
    SampleSchedule,
    Window,
    first_timing,
    period_in_nanoseconds,
)
from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

__all__ = ["SubspaceConfiguration", "SubspaceStage", "SubspaceUpdate"]

Advanced = tuple[SubspaceRun, list[Notice]]
Closed = tuple[SubspaceRun, list[SubspaceEstimates]]

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

    def __init__(self, configuration: SubspaceConfiguration) -> None:
        if configuration.n_subspaces % 2 == 0:
            raise ConfigurationError(
                f"n_subspaces is {configuration.n_subspaces}; it must be odd, so that the window "
                "is centred on the sample time."
            )
        if configuration.source_count == 0 and configuration.covariance_snapshots == 0:
            raise ConfigurationError(
                "source_count = 0 finds the number of sources from the sample covariance; set "
                "covariance_snapshots above zero, or give source_count."
            )
        self.configuration = configuration
        self._method = make_method(
            configuration.method, configuration.forgetting_factor, configuration.step
        )
        self._schedule = SampleSchedule(
            period_in_nanoseconds(configuration.period),
            configuration.n_subspaces,
            configuration.step,
            configuration.covariance_lookahead,
        )
        self._run: SubspaceRun | None = None

    def reset(self) -> None:
        """Forget all data: the next block starts a new run."""
        self._run = None

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
        if self._run is None:
            previous, run, missing = None, self._first_run(block), 0
        else:
            previous = self._run
            run, missing = self._continued_run(previous, block)
        monitor, channel_notices = run.monitor.update(block)
        notices = list(channel_notices)
        run = self._opened(self._with_used(replace(run, monitor=monitor)), missing)
        estimates: list[SubspaceEstimates] = []
        if previous is not None and missing:
            notices.append(_gap_notice(missing, block))
            run, estimates = self._close_before(run, previous)
        run, recursion_notices = self._advanced(run, block)
        notices.extend(recursion_notices)
        end_of_data = block.next_stamp == END_OF_DATA
        run, completed = self._close_completed(run, end_of_data)
        estimates.extend(completed)
        if end_of_data and not estimates:
            # Some estimate must carry the end, if only an empty one.
            window = self._schedule.window(run.next_sample, run.timing)
            run = replace(run, next_sample=run.next_sample + 1)
            estimates.append(self._estimates(window, run, run))
        if end_of_data and estimates:
            estimates[-1] = replace(estimates[-1], next_stamp=END_OF_DATA)
        if any(each.rank >= len(each.element_positions) - 1 for each in estimates):
            notices.append(_crowded_notice(len(run.header.element_positions)))
        self._run = run
        return SubspaceUpdate(tuple(estimates), tuple(notices))

    def _first_run(self, block: ArraySnapshots) -> SubspaceRun:
        configuration = self.configuration
        check_first_block(block, configuration.source_count)
        if configuration.source_count == 0 and block.data.ndim > 2:
            raise InputError(
                "source_count = 0 cannot be used on a batch of runs; give the number of sources."
            )
        timing = first_timing(block.stamp, block.data.shape[-2], block.sample_period)
        covariance, n_elements = block.noise_covariance, block.data.shape[-1]
        array = replace(block, data=block.data[..., :0, :])
        return SubspaceRun(
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

    def _continued_run(self, run: SubspaceRun, block: ArraySnapshots) -> tuple[SubspaceRun, int]:
        check_block(block)
        check_unchanged(block, run.array)
        timing, missing = run.timing.following(block.stamp, block.data.shape[-2])
        if missing < 0:
            raise InputError(
                f"The block begins {-missing} snapshots before the end of the block before it; "
                "blocks must follow each other in time."
            )
        history = run.history if missing == 0 else run.history[..., :0, :]
        sensors = run.sensors.appended(block.stamp, block.sensor)
        return replace(run, sensors=sensors, timing=timing, history=history), missing

    def _with_used(self, run: SubspaceRun) -> SubspaceRun:
        """Leave bad elements out, or take them back; the subspace then starts again."""
        used, count = run.monitor.used, self.configuration.source_count
        if run.history.ndim > 2 or np.count_nonzero(used) <= max(count, 1):
            return run
        if np.array_equal(used, run.used):
            return run
        header = used_elements(run.array, used)
        noise = header.noise_covariance
        return replace(
            run,
            header=header,
            used=used,
            whitening=None if noise is None else noise_factors(noise)[1],
            recursion=None,
            n_columns=count,
            next_count=0,
            captured=(),
        )

    def _opened(self, run: SubspaceRun, missing: int) -> SubspaceRun:
        """Open the windows that reach into the block; leave out those lost in a long gap."""
        timing, windows, number = run.timing, list(run.windows), run.next_sample
        long_gap = missing * timing.sample_period > LONG_GAP_PERIODS * self._schedule.period
        if long_gap:
            windows = [w for w in windows if any(c.index in w.indices for c in run.captured)]
            number = max(number, self._schedule.first_unfinished(timing))
        while (window := self._schedule.window(number, timing)).first <= timing.last_index:
            windows.append(window)
            number += 1
        return replace(run, windows=tuple(windows), next_sample=number)

    def _advanced(
        self, run: SubspaceRun, block: ArraySnapshots
    ) -> tuple[SubspaceRun, list[Notice]]:
        data = np.asarray(block.data, dtype=np.complex128)
        first_index = run.timing.first_index
        run = replace(run, history=np.concatenate([run.history, data], axis=-2))
        data = data if run.used.all() else data[..., run.used]
        recursion = run.recursion
        if recursion is None:
            run, recursion = self._started(run)
            if recursion is None:
                return run, []
            if self.configuration.source_count == 0:
                # The snapshots the sources were counted on are not lost to the recursion.
                data = run.used_history
                first_index = run.timing.last_index + 1 - data.shape[-2]
        wanted = {index for window in run.windows for index in window.indices}
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                recursion, captured = recursion.advance(data, first_index, run.timing, wanted)
            usable = all(np.isfinite(subspace.basis).all() for subspace in captured)
        except np.linalg.LinAlgError:
            usable = False
        if not usable:
            return replace(run, recursion=None), [_singular_notice(run.n_columns)]
        return replace(run, recursion=recursion, captured=run.captured + captured), []

    def _started(self, run: SubspaceRun) -> tuple[SubspaceRun, SubspaceRecursion | None]:
        configuration = self.configuration
        n_columns = run.n_columns
        if n_columns == 0 and ready_to_count(configuration, run):
            n_columns = starting_columns(configuration, run)
            next_count = run.timing.last_index + configuration.covariance_snapshots
            run = replace(run, next_count=next_count)
        if n_columns == 0:
            return run, None
        recursion = start_recursion(
            self._method,
            len(run.header.element_positions),
            n_columns,
            run.history.shape[:-2],
            run.header.noise_covariance,
        )
        return replace(run, n_columns=n_columns), recursion

    def _close_before(self, run: SubspaceRun, previous: SubspaceRun) -> Closed:
        """Close the windows that end in the gap before the block."""
        lost = [w for w in run.windows if w.complete < run.timing.first_index]
        estimates = [self._estimates(window, run, previous) for window in lost]
        return self._without(run, lost), estimates

    def _close_completed(self, run: SubspaceRun, end: bool) -> Closed:
        """Close the windows that are complete; at the end of the data also those begun."""
        timing = run.timing
        done = [w for w in run.windows if w.complete <= timing.last_index]
        if end:
            done = list(run.windows)
        estimates = [self._estimates(window, run, run) for window in done]
        keep = self.configuration.covariance_snapshots + self._schedule.reach
        history = run.history[..., max(run.history.shape[-2] - keep, 0) :, :]
        return replace(self._without(run, done), history=history), estimates

    def _estimates(
        self, window: Window, run: SubspaceRun, source: SubspaceRun
    ) -> SubspaceEstimates:
        return window_estimates(self.configuration, self._schedule, window, run, source)

    def _without(self, run: SubspaceRun, closed: list[Window]) -> SubspaceRun:
        windows = tuple(w for w in run.windows if w not in closed)
        captured = tuple(c for c in run.captured if any(c.index in w.indices for w in windows))
        sensors = run.sensors.since(closed[-1].stamp) if closed else run.sensors
        return replace(run, windows=windows, captured=captured, sensors=sensors)


def _gap_notice(missing: int, block: ArraySnapshots) -> Notice:
    return Notice(
        Severity.WARN,
        "gap",
        f"{missing} snapshots are missing before the block at "
        f"{block.stamp / NANOSECONDS:.3f} s; tracking continues with the subspace from before.",
    )


def _crowded_notice(n_elements: int) -> Notice:
    return Notice(
        Severity.WARN,
        "rank",
        f"The data show {n_elements - 1} sources or more, as many as {n_elements} elements can "
        "tell apart; those that are weak or close to others may have no track.",
    )


def _singular_notice(n_columns: int) -> Notice:
    return Notice(
        Severity.ERROR,
        "subspace",
        f"The data do not carry {n_columns} directions, the subspace became singular and is "
        "started again; lower source_count.",
    )
