"""A recording cut into blocks of samples, with own ship at both ends of each.

Blocks are read one by one: memory does not grow with the samples. One that holds values that are
not numbers is left out, and named at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sonar_tracking.bags.audio.recording import Recording, Stretch
from sonar_tracking.bags.importers.array_geometry_file import RecordedArray
from sonar_tracking.bags.importers.audio_recording import Message
from sonar_tracking.bags.importers.contact_messages import odometry_cdr
from sonar_tracking.bags.importers.recorded_messages import samples_cdr
from sonar_tracking.bags.positions.own_ship_track import checked_coverage, own_ship_at
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.motion import lever_arm, swing_velocity
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import demodulated_band
from sonar_tracking.passive.lines.demodulation import Band
from sonar_tracking.passive.lines.sample_frames import check_samples_block
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

SAMPLES_TOPIC = "/array/samples"
ODOMETRY_TOPIC = "/own_ship/odometry"

BLOCK_SECONDS = 0.5
LARGEST_BLOCK = 1 << 18
"""Values in one message at most."""

_READ_AT_ONCE = 1 << 20
"""Values; of one file a hydrophone, opening them counts."""

_MOST_SPANS = 20
"""Stretches of samples that are not numbers of which each has a sentence."""


@dataclass(frozen=True)
class _Span:
    channels: str
    begin: float
    end: float


class SampleBlocks:
    """The blocks of a recording.

    Parameters
    ----------
    recording : Recording
        The samples.
    array : RecordedArray
        The array, with the epoch of the recording.
    columns : sequence of int
        Column of each element in the samples.
    surveyed : SurveyedPositions
        Of own ship.
    progress : callable, optional
        Called with the share that is done, 0 to 1.

    Attributes
    ----------
    own_ship_notes : list of str
        What is to be said of own ship's positions.
    """

    def __init__(
        self,
        recording: Recording,
        array: RecordedArray,
        columns: Sequence[int],
        surveyed: SurveyedPositions,
        progress: Callable[[float], None] | None = None,
    ) -> None:
        self._recording, self._array, self._columns = recording, array, list(columns)
        self._progress = progress or (lambda share: None)
        size = min(
            round(BLOCK_SECONDS * recording.sample_rate), LARGEST_BLOCK // recording.n_channels
        )
        self._size = max(size, 1)
        # Own ship is needed where a block begins, and where a stretch ends.
        self._first_block: list[int] = []
        stamps: list[int] = []
        for stretch in recording.stretches:
            self._first_block.append(len(stamps))
            edges = [*range(0, stretch.n_samples, self._size), stretch.n_samples]
            stamps += [stretch.stamp(edge) for edge in edges]
        self.own_ship_notes = checked_coverage(surveyed, np.array(stamps))
        self._motion = own_ship_at(surveyed, np.array(stamps))
        self._spans: list[_Span] = []
        self._more_spans = 0

    @property
    def end(self) -> int:
        """Instant at which the recording ends, ns."""
        return int(self._motion.stamp[-1])

    def band(self, configuration: BandDemodulatorConfiguration) -> Band:
        """Return the band bearings are made of, or say why samples or band are of no use."""
        n_samples, rate = self._recording.n_samples, self._recording.sample_rate
        silence = self._record(0, np.zeros((1, len(self._columns))), END_OF_DATA)
        path = self._recording.path
        try:
            check_samples_block(silence)
            band = demodulated_band(configuration, silence)
        except InputError as error:
            raise ConfigurationError(f"{path} is of no use as samples: {error}") from error
        if n_samples < len(band.taps):
            raise ConfigurationError(
                f"{path} lasts {n_samples / rate:g} s, less than the {len(band.taps) / rate:g} s "
                f"one snapshot of {band.bandwidth:.3g} Hz needs; give a longer file or a larger "
                "bandwidth."
            )
        return band

    def samples(self) -> Iterator[Message]:
        """Yield the blocks, each with the stamp of the next as its watermark.

        Raises
        ------
        ConfigurationError
            If no block is of use.
        """
        held: tuple[int, Any] | None = None
        for index, data in self._kept():
            if held is not None:
                yield self._message(*held, int(self._motion.stamp[index]))
            held = index, data
        if held is None:
            raise ConfigurationError(self.left_out()[0])
        yield self._message(*held, END_OF_DATA)

    def odometry(self) -> Iterator[Message]:
        """Yield own ship at both ends of each block."""
        last = -1
        for index in range(len(self._motion.stamp)):
            state = self._motion.state(index)
            if state.stamp > last:
                yield state.stamp, ODOMETRY_TOPIC, odometry_cdr(state), 0
            last = state.stamp

    def left_out(self) -> list[str]:
        """Return what was left out so far, in sentences."""
        path = self._recording.path
        notes = [
            f"{path} has samples that are not numbers on channel {span.channels}; {span.begin:.3f} "
            f"s to {span.end:.3f} s were left out."
            for span in self._spans
        ]
        if self._more_spans:
            notes.append(f"{path}: the same holds of {self._more_spans} more blocks.")
        return notes

    def _kept(self) -> Iterator[tuple[int, Any]]:
        """Yield index and samples, shape (n, n_elements), of the blocks of finite numbers."""
        done, total = 0, self._recording.n_samples
        in_order = self._columns == list(range(self._recording.n_channels))
        check = self._recording.may_be_not_a_number
        for first_block, stretch in zip(self._first_block, self._recording.stretches, strict=True):
            for index, samples in enumerate(self._read(stretch), first_block):
                data = samples if in_order else samples[:, self._columns]
                if check and not np.isfinite(data).all():
                    bad = np.flatnonzero(~np.isfinite(data).all(axis=0))
                    self._leave_out(index, len(samples), bad.tolist())
                else:
                    yield index, data
                done += len(samples)
                self._progress(done / total)

    def _read(self, stretch: Stretch) -> Iterator[Any]:
        """Yield the blocks of a stretch, of all channels; several are read at once."""
        many = max(_READ_AT_ONCE // (self._size * self._recording.n_channels), 1) * self._size
        for begin in range(0, stretch.n_samples, many):
            end = min(begin + many, stretch.n_samples)
            with np.errstate(over="ignore"):
                samples = stretch.samples(begin, end).astype(np.float32)
            for start in range(0, end - begin, self._size):
                yield samples[start : start + self._size]

    def _leave_out(self, index: int, n_samples: int, bad: Sequence[int]) -> None:
        channels = ", ".join(str(self._columns[each] + 1) for each in bad)
        begin = float(self._motion.stamp[index] - self._array.epoch) / NANOSECONDS
        end = begin + n_samples / self._recording.sample_rate
        if self._spans and self._spans[-1].channels == channels:
            before = self._spans[-1]
            if abs(before.end - begin) < 0.5 / self._recording.sample_rate:
                self._spans[-1] = _Span(channels, before.begin, end)
                return
        if len(self._spans) < _MOST_SPANS:
            self._spans.append(_Span(channels, begin, end))
        else:
            self._more_spans += 1

    def _message(self, index: int, data: FloatArray, next_stamp: int) -> Message:
        block = self._record(index, data, next_stamp)
        return block.stamp, SAMPLES_TOPIC, samples_cdr(block), len(data)

    def _record(self, index: int, data: FloatArray, next_stamp: int) -> ArraySamples:
        return ArraySamples(
            stamp=int(self._motion.stamp[index]),
            data=data,
            element_positions=self._array.element_positions,
            sample_rate=float(self._recording.sample_rate),
            sound_speed=self._array.sound_speed,
            next_stamp=next_stamp,
            sensor=self._sensor(index),
        )

    def _sensor(self, index: int) -> Sensor:
        """Return the array aboard own ship; its height is zero."""
        azimuth = float(self._motion.azimuth[index])
        arm = lever_arm(azimuth, *self._array.mounting)
        x, y = self._motion.position[index] + arm
        turn_rate = float(self._motion.turn_rate[index])
        vx, vy = self._motion.velocity[index] + swing_velocity(turn_rate, arm)
        half = 0.5 * (azimuth + self._array.mounting_yaw)
        return Sensor(
            sensor_id=self._array.sensor_id,
            position=(float(x), float(y), 0.0),
            orientation=(0.0, 0.0, float(np.sin(half)), float(np.cos(half))),
            velocity=(float(vx), float(vy), 0.0),
        )
