"""Beam power of narrowband snapshots: the conventional beamformer, row by row.

Each beam is b(theta) = mean_t |a(theta)^H x_t|^2 / M^2, so that a plane wave of power p on every
element gives p in its own direction, and spatially white noise of power s gives s / M everywhere.
Elements that do not give numbers are left out of a block, and M counts those that do.

References
----------
Van Trees (2002), Optimum Array Processing, section 2.5.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.display.waterfalls.beam_rows import BeamRow, beam_axis
from sonar_tracking.geometry import steering_vectors, wavenumber
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.sensor_pose import yaw_of


def beam_power_row(block: ArraySnapshots) -> BeamRow | None:
    """Return the row of one block of snapshots.

    Parameters
    ----------
    block : ArraySnapshots
        Of any array.

    Returns
    -------
    BeamRow or None
        None = the block is empty, or more than half of its elements do not give numbers.
    """
    data = block.data
    if not data.size:
        return None
    used: BoolArray = np.asarray(np.isfinite(data).all(axis=0))
    count = int(np.count_nonzero(used))
    if 2 * count <= data.shape[1]:
        return None
    number = wavenumber(block.center_frequency, block.sound_speed)
    axis = beam_axis(block.element_positions, number)
    weights = _weights(block.element_positions.tobytes(), number)
    if count < used.size:
        data, weights = data[:, used], weights[used]
    beams = data.astype(np.complex64) @ weights / count
    power = np.mean(np.abs(beams).astype(np.float64) ** 2, axis=0)
    duration = len(data) * block.sample_period
    return BeamRow(
        begin=block.stamp,
        end=block.stamp + nanoseconds(duration),
        axis=axis,
        power=power,
        integrated=duration,
        sensor_id=block.sensor.sensor_id,
        axis_azimuth=yaw_of(block.sensor.orientation),
    )


@lru_cache(maxsize=4)
def _weights(position_bytes: bytes, number: float) -> NDArray[np.complex64]:
    positions: FloatArray = np.frombuffer(position_bytes).reshape(-1, 3)
    angles = beam_axis(positions, number).angles
    vectors = steering_vectors(positions, angles, number, "array_centre")
    return np.asarray(vectors.conj(), np.complex64)
