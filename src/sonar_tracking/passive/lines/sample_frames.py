"""Half-overlapping frames cut out of a stream of sample blocks.

Frames begin at multiples of half a frame in stamp time, so that a recording may start anywhere.
Samples that are missing, because a block was lost or could not be used, leave frames without data;
after a gap of more than ``MAXIMUM_GAP`` frames the stream begins again.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import InputError, shown
from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.samples import MINIMUM_SAMPLE_RATE, ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

MAXIMUM_GAP = 30
"""Frames that may be lost in a row before the stream begins again."""


@dataclass(frozen=True)
class SampleFrame:
    """One frame.

    Attributes
    ----------
    stamp : int
        Its middle, ns.
    next_stamp : int
        Middle of the next frame, or the end of the data, ns.
    samples : ndarray, shape (n_samples, n_elements), or None
        Linear amplitude; None if samples are missing.
    sensor : Sensor
        The sensor at the stamp.
    """

    stamp: int
    next_stamp: int
    samples: FloatArray | None
    sensor: Sensor


class SampleFramer:
    """Cuts the blocks of one array into frames.

    Parameters
    ----------
    frame_length : float
        s; rounded to an even number of samples.
    """

    def __init__(self, frame_length: float) -> None:
        self._frame_length = frame_length
        self._first: ArraySamples | None = None

    @property
    def began(self) -> bool:
        """Whether there has been a block."""
        return self._first is not None

    def frames(self, block: ArraySamples) -> tuple[SampleFrame, ...]:
        """Take a block and return the frames it completes.

        After the last block the frame the data end in follows, without samples.

        Raises
        ------
        InputError
            If the block cannot be used; nothing has changed then.
        """
        check_samples_block(block)
        if self._first is None:
            self._begin(block)
        else:
            check_unchanged(block, self._first)
        missing = self._missing(block)
        if missing > MAXIMUM_GAP * self._hop:
            self._begin(block)
            missing = 0
        return tuple(self._cut(block, missing))

    def _begin(self, block: ArraySamples) -> None:
        self._first = block
        self._hop = max(1, round(0.5 * self._frame_length * block.sample_rate))
        self._held = np.empty((0, block.data.shape[1]))
        self._sensors = SensorHistory()
        hop_stamp = round(self._hop / block.sample_rate * NANOSECONDS)
        wait = -block.stamp % hop_stamp * block.sample_rate / NANOSECONDS
        self._skip = int(np.ceil(wait - 1e-3))
        self._end_stamp = block.stamp

    def _missing(self, block: ArraySamples) -> int:
        missing = round((block.stamp - self._end_stamp) * block.sample_rate / NANOSECONDS)
        if missing < 0:
            raise InputError(
                f"The block begins {-missing} samples before the end of the one before it; the "
                "sender must number samples without overlap."
            )
        return missing

    def _cut(self, block: ArraySamples, missing: int) -> Iterator[SampleFrame]:
        rate, n_elements = block.sample_rate, block.data.shape[1]
        self._sensors = self._sensors.append(block.stamp, block.sensor)
        gap_end = block.stamp
        while missing:
            part = min(missing, self._hop)
            missing -= part
            end = gap_end - round(missing / rate * NANOSECONDS)
            yield from self._extend(np.full((part, n_elements), np.nan), end, rate)
        last = block.next_stamp == END_OF_DATA
        yield from self._extend(block.data, block.end_stamp, rate)
        if last:
            begin = self._end_stamp - round((len(self._held) - self._skip) / rate * NANOSECONDS)
            middle = begin + round(self._hop / rate * NANOSECONDS)
            yield SampleFrame(middle, END_OF_DATA, None, self._sensors.at(middle))

    def _extend(self, samples: FloatArray, end_stamp: int, rate: float) -> Iterator[SampleFrame]:
        self._end_stamp = end_stamp
        skipped = min(self._skip, len(samples))
        self._skip -= skipped
        self._held = np.concatenate([self._held, samples[skipped:]])
        hop = round(self._hop / rate * NANOSECONDS)
        while len(self._held) >= 2 * self._hop:
            frame = self._held[: 2 * self._hop]
            middle = end_stamp - round((len(self._held) - self._hop) / rate * NANOSECONDS)
            whole = frame if np.isfinite(frame).all() else None
            self._sensors = self._sensors.since(middle)
            yield SampleFrame(middle, middle + hop, whole, self._sensors.at(middle))
            self._held = self._held[self._hop :]


def check_samples_block(block: ArraySamples) -> None:
    """Reject a block that cannot be used.

    Raises
    ------
    InputError
        With one sentence for the first thing that is wrong.
    """
    positions = block.element_positions
    if positions.ndim != 2 or positions.shape[-1] != 3 or len(positions) == 0:
        raise InputError(
            f"element_positions has shape {positions.shape}; it must be (n_elements, 3)."
        )
    if block.data.ndim != 2 or block.data.shape[1] != len(positions):
        raise InputError(
            f"The data have shape {block.data.shape} but the array has {len(positions)} elements; "
            "send one column for each element position."
        )
    if len(block.data) == 0:
        raise InputError("The block holds zero samples; send at least one.")
    if not (np.isfinite(block.sample_rate) and block.sample_rate >= MINIMUM_SAMPLE_RATE):
        raise InputError(
            f"sample_rate is {block.sample_rate:g} Hz; it must be at least "
            f"{MINIMUM_SAMPLE_RATE:g} Hz."
        )
    if not (np.isfinite(block.sound_speed) and block.sound_speed > 0.0):
        raise InputError(f"sound_speed is {block.sound_speed:g}; it must be above zero.")
    if not np.isfinite(positions).all():
        raise InputError("An element position is not a finite number; give all positions in m.")
    finite = np.isfinite(block.data)
    if not finite.all():
        sample, element = np.argwhere(~finite)[0]
        raise InputError(
            f"Element {element} of sample {sample} is not a finite number ({np.sum(~finite)} such "
            "values in the block); the block is not used."
        )


def check_unchanged(block: ArraySamples, first: ArraySamples) -> None:
    """Reject a block whose array, rate or sensor differs from the first one of the run.

    Raises
    ------
    InputError
        Naming what changed.
    """
    for name in ("sample_rate", "sound_speed"):
        old, new = getattr(first, name), getattr(block, name)
        if old != new:
            raise InputError(
                f"{name} changed from {old:g} to {new:g} during the run; restart the node to "
                "go on with other settings."
            )
    if not np.array_equal(first.element_positions, block.element_positions):
        raise InputError(
            "element_positions changed during the run; restart the node to go on with another "
            "array."
        )
    if first.sensor.sensor_id != block.sensor.sensor_id:
        raise InputError(
            f"The block comes from sensor '{shown(block.sensor.sensor_id)}' but the run is of "
            f"sensor '{shown(first.sensor.sensor_id)}'; stop the second publisher."
        )
