"""What a simulation delivers: data of the sensors, own ship, and the truth to score against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.passive.records import UNKNOWN_STAMP, ArraySnapshots, BearingTracks
from sonar_tracking.passive.sample_records import ArraySamples

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class OwnShipState:
    """State of own ship at one instant.

    Attributes
    ----------
    stamp : int
        ns.
    position : tuple of float
        x, y in ``map``, m.
    yaw : float
        Azimuth of the bow in ``map``, rad in [-pi, pi).
    velocity : tuple of float
        Forward and to port, in ``own_ship/base_link``, m/s.
    yaw_rate : float
        rad/s, positive anticlockwise.
    """

    stamp: int
    position: tuple[float, float]
    yaw: float
    velocity: tuple[float, float]
    yaw_rate: float


@dataclass(frozen=True)
class TruthTracks:
    """True states of the targets that have one, at one instant.

    Attributes
    ----------
    stamp : int
        The instant of the states, ns.
    id : ndarray of uint64, shape (n_tracks,)
        Number of the target in the scenario, from 1; as in the bearing truth.
    position, velocity : ndarray, shape (n_tracks, 2)
        In ``map``, m and m/s.
    next_stamp : int
        Watermark, ns.
    """

    stamp: int
    id: NDArray[np.uint64]
    position: FloatArray
    velocity: FloatArray
    next_stamp: int = UNKNOWN_STAMP


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
