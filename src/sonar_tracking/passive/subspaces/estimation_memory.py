"""What the subspace stage remembers between blocks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from sonar_tracking.errors import Notice
from sonar_tracking.filtering.eigenpairs import Eigenpairs
from sonar_tracking.passive.array_fit.array_fit import ArrayFit
from sonar_tracking.passive.subspaces.basis_sampling import (
    BasisSampler,
    CapturedSubspace,
    noise_factors,
)
from sonar_tracking.passive.subspaces.channel_monitor import ChannelMonitor
from sonar_tracking.passive.subspaces.sample_schedule import BlockTiming, Window
from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.arrays import BoolArray, ComplexArray
from sonar_tracking.records.bearings import ArraySnapshots


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
    covariance : ndarray, shape (n_used, n_used), complex, or None
        Of those snapshots, linear power, if it is known already.
    eigenpairs : Eigenpairs or None
        Of it, if they are known already.
    """

    window: Window
    bases_from: EstimationMemory
    snapshots_from: EstimationMemory
    covariance: ComplexArray | None = None
    eigenpairs: Eigenpairs | None = None

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


def ready_to_count(configuration: SubspaceConfiguration, memory: EstimationMemory) -> bool:
    """Return whether there is a full covariance that no sources were counted on yet."""
    full = memory.history.shape[-2] >= configuration.covariance_snapshots
    return full and memory.timing.last_index >= memory.next_count


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
