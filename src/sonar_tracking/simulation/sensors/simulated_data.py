"""What a simulation delivers: data of the sensors, own ship, and the truth to score against."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.samples import ArraySamples


@dataclass(frozen=True)
class SimulatedBlock:
    """Everything that belongs to one block of snapshots.

    Attributes
    ----------
    snapshots : ArraySnapshots
        The data.
    truth_bearings : BearingTracks
        True arrival angles at the stamp of the block.
    truth_tracks : TruthTracks
        True positions at the stamp of the block.
    own_ship : tuple of OwnShipState
        At the end of the block, which is the begin of the next one; the first block of a run
        also has the state at its begin, ahead of it.
    """

    snapshots: ArraySnapshots
    truth_bearings: BearingTracks
    truth_tracks: TruthTracks
    own_ship: tuple[OwnShipState, ...]

    @property
    def start_stamp(self) -> int:
        """Stamp of the first snapshot, ns."""
        return self.snapshots.stamp

    @property
    def due_stamp(self) -> int:
        """End of the block, ns."""
        return self.own_ship[-1].stamp


@dataclass(frozen=True)
class SimulatedSamples:
    """Everything that belongs to one block of element time series.

    Attributes
    ----------
    samples : ArraySamples
        The data.
    truth_bearings, truth_tracks, own_ship
        As in :class:`SimulatedBlock`.
    """

    samples: ArraySamples
    truth_bearings: BearingTracks
    truth_tracks: TruthTracks
    own_ship: tuple[OwnShipState, ...]

    @property
    def start_stamp(self) -> int:
        """Stamp of the first sample, ns."""
        return self.samples.stamp

    @property
    def due_stamp(self) -> int:
        """End of the block, ns."""
        return self.own_ship[-1].stamp
