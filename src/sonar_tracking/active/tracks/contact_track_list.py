"""What the trackers of contacts show: their tracks and thresholds as the records of the chain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.gate_threshold_registry import AS_DETECTED
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.contacts import GateThresholds
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS, UNKNOWN_STAMP


@dataclass(frozen=True)
class ContactTrackRows:
    """Tracks as a tracker of contacts keeps them.

    Attributes
    ----------
    id : ndarray of int, shape (n,)
        Identifiers.
    status : ndarray of int, shape (n,)
        Values of :class:`~sonar_tracking.records.bearings.TrackStatus`.
    existence : ndarray, shape (n,)
        Probabilities; NaN = not estimated.
    state, covariance : ndarray, shape (n, 4) and (n, 4, 4)
        x, y, vx, vy in ``map``, m and m/s; m^2, m^2/s, m^2/s^2.
    initiated, updated : ndarray of int, shape (n,)
        Stamps of the first and the last contact, ns.
    static : ndarray of bool, shape (n,), optional
        Which are of something that is fixed; None = not estimated.
    measured : tuple of two ndarray, shape (n, 2) and (n, 2, 2), optional
        What the last update measured, m and m^2; None = unknown.
    """

    id: IntArray
    status: IntArray
    existence: FloatArray
    state: FloatArray
    covariance: FloatArray
    initiated: IntArray
    updated: IntArray
    static: BoolArray | None = None
    measured: tuple[FloatArray, FloatArray] | None = None

    def select(self, rows: slice) -> ContactTrackRows:
        """Return some of the tracks, next to each other."""
        return ContactTrackRows(
            self.id[rows],
            self.status[rows],
            self.existence[rows],
            self.state[rows],
            self.covariance[rows],
            self.initiated[rows],
            self.updated[rows],
            None if self.static is None else self.static[rows],
            None if self.measured is None else (self.measured[0][rows], self.measured[1][rows]),
        )

    def append(self, other: ContactTrackRows) -> ContactTrackRows:
        """Return the tracks with others after them, which have measured nothing."""
        static, measured = self.static, self.measured
        if static is not None and other.static is not None:
            static = np.concatenate([static, other.static])
        if measured is not None:
            count = len(other.id)
            nothing = np.full((count, 2), np.nan), np.full((count, 2, 2), np.nan)
            measured = (
                np.concatenate([measured[0], nothing[0]]),
                np.concatenate([measured[1], nothing[1]]),
            )
        return ContactTrackRows(
            np.concatenate([self.id, other.id]),
            np.concatenate([self.status, other.status]),
            np.concatenate([self.existence, other.existence]),
            np.concatenate([self.state, other.state]),
            np.concatenate([self.covariance, other.covariance]),
            np.concatenate([self.initiated, other.initiated]),
            np.concatenate([self.updated, other.updated]),
            static,
            measured,
        )


def shown_tracks(rows: ContactTrackRows, stamp: int, next_stamp: int) -> PositionTracks:
    """Return tracks as the complete picture at a ping.

    Parameters
    ----------
    rows : ContactTrackRows
        The tracks to show.
    stamp, next_stamp : int
        Of the ping, ns.
    """
    source = np.full(len(rows.id), int(TrackSource.ACTIVE), np.uint8)
    if rows.static is not None:
        source[rows.static] = int(TrackSource.STATIC)
    measurement, noise = rows.measured or (np.empty(0), np.empty(0))
    return PositionTracks(
        stamp=stamp,
        id=rows.id.astype(np.uint64),
        status=rows.status.astype(np.uint8),
        source=source,
        state=rows.state,
        covariance=rows.covariance,
        existence_probability=rows.existence,
        initiated=_seconds(rows.initiated),
        updated=_seconds(rows.updated),
        hypothesis_probability=np.ones(len(rows.id)),
        next_stamp=next_stamp,
        measurement=measurement,
        measurement_covariance=noise,
    )


def thresholds_without_gates(
    stamp: int, next_stamp: int = UNKNOWN_STAMP, model: DetectionModel | None = None
) -> GateThresholds:
    """Return the thresholds of a ping in which no gate was searched.

    Parameters
    ----------
    stamp, next_stamp : int
        Of the ping, ns.
    model : DetectionModel, optional
        What is known of the detector; None = nothing.
    """
    nothing = np.zeros(0)
    return GateThresholds(
        stamp=stamp,
        track_id=nothing.astype(np.int64),
        false_alarm_probability=nothing,
        threshold=nothing,
        resolution_cells=nothing,
        gate_volume=nothing,
        predicted_position=np.zeros((0, 2)),
        gate_covariance=np.zeros((0, 2, 2)),
        search_false_alarm_probability=model.false_alarm_probability if model else np.nan,
        search_threshold=model.threshold if model else np.nan,
        signal_to_noise_ratio_linear=nothing,
        method=AS_DETECTED,
        next_stamp=next_stamp,
    )


def _seconds(stamps: IntArray) -> FloatArray:
    return np.asarray(stamps, dtype=np.float64) / NANOSECONDS
