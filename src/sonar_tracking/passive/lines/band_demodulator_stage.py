"""Narrowband snapshots from broadband element time series: what the subspace stage listens to.

One band is demodulated, low-pass filtered and decimated
(:mod:`sonar_tracking.passive.lines.demodulation` says how and why); the bandwidth must be narrow
for the array. The blocks of snapshots depend on the samples alone, not on how they were cut into
blocks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.geometry import aperture
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.demodulation import Band, Demodulator, design_band
from sonar_tracking.passive.lines.sample_frames import check_samples_block, check_unchanged
from sonar_tracking.passive.subspaces.block_checks import MAXIMUM_RELATIVE_BANDWIDTH
from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS


@dataclass(frozen=True)
class _Run:
    """What the first block of a run decides."""

    first: ArraySamples
    band: Band


class BandDemodulatorStage:
    """Turns element time series into snapshots of one band.

    Parameters
    ----------
    configuration : BandDemodulatorConfiguration
        Its parameters.
    """

    def __init__(self, configuration: BandDemodulatorConfiguration | None = None) -> None:
        self._configuration = configuration or BandDemodulatorConfiguration()
        self.reset()

    def reset(self) -> None:
        """Begin again with the next block."""
        self._run: _Run | None = None

    def update(self, samples: ArraySamples) -> tuple[ArraySnapshots, ...]:
        """Take a block of samples and return the blocks of snapshots that are complete.

        The last snapshot waits for the next one, so that the end of the data always finds one to
        travel with. After samples that are missing the filter begins again.

        Raises
        ------
        InputError
            If the block cannot be used, or the band does not suit the array or the sample rate;
            nothing has changed then.
        """
        check_samples_block(samples)
        if self._run is None:
            self._begin(samples)
        else:
            check_unchanged(samples, self._run.first)
            gap = (samples.stamp - self._end_stamp) * samples.sample_rate / NANOSECONDS
            if gap < -0.5:
                raise InputError(
                    f"The block begins {-gap:.0f} samples before the end of the one before it; the "
                    "sender must number samples without overlap."
                )
            if gap > 0.5:
                return (*self._flush(samples.stamp), *self._resume(samples, round(gap)))
        return self._advance(samples)

    def _begin(self, samples: ArraySamples) -> None:
        self._run = _Run(samples, demodulated_band(self._configuration, samples))
        self._sensors = SensorHistory()
        self._begin_filter(samples, 0)

    def _resume(self, samples: ArraySamples, gap: int) -> tuple[ArraySnapshots, ...]:
        """Go on after a gap, with snapshots at multiples of their period from those before."""
        assert self._run is not None
        grid_sample = self._n_samples - self._skip + gap
        self._begin_filter(samples, -grid_sample % self._run.band.decimation)
        return self._advance(samples)

    def _begin_filter(self, samples: ArraySamples, skip: int) -> None:
        assert self._run is not None
        self._skip, self._n_samples = skip, 0
        self._demodulator = Demodulator(self._run.band, samples.sample_rate)
        self._held: ComplexArray = np.empty((0, samples.data.shape[1]), np.complex128)
        self._held_sample = self._demodulator.next_centre
        self._filter_stamp = samples.stamp + round(skip * NANOSECONDS / samples.sample_rate)

    def _advance(self, samples: ArraySamples) -> tuple[ArraySnapshots, ...]:
        assert self._run is not None
        skipped = min(self._skip, len(samples.data))
        self._skip -= skipped
        snapshots = self._demodulator.update(samples.data[skipped:])
        self._held = np.concatenate([self._held, snapshots])
        self._n_samples += len(samples.data) - skipped
        self._end_stamp = samples.end_stamp
        self._sensors = self._sensors.append(samples.stamp, samples.sensor)
        size = self._configuration.block_snapshots
        blocks = []
        while len(self._held) > size:
            blocks.append(self._block(size, self._stamp_after(size)))
        if samples.next_stamp == END_OF_DATA:
            blocks.extend(self._flush(END_OF_DATA))
        return tuple(blocks)

    def _flush(self, next_stamp: int) -> list[ArraySnapshots]:
        """Return the snapshots held, whatever their number."""
        return [self._block(len(self._held), next_stamp)] if len(self._held) else []

    def _stamp_after(self, count: int) -> int:
        assert self._run is not None
        sample = self._held_sample + count * self._run.band.decimation
        return self._filter_stamp + round(sample * NANOSECONDS / self._run.first.sample_rate)

    def _block(self, count: int, next_stamp: int) -> ArraySnapshots:
        assert self._run is not None
        run, stamp = self._run, self._stamp_after(0)
        data, self._held = self._held[:count], self._held[count:]
        self._held_sample += count * run.band.decimation
        self._sensors = self._sensors.since(stamp)
        return ArraySnapshots(
            stamp=stamp,
            data=data.astype(np.complex64).astype(np.complex128),
            element_positions=run.first.element_positions,
            sample_period=run.band.decimation / run.first.sample_rate,
            center_frequency=run.band.frequency,
            bandwidth=run.band.bandwidth,
            sound_speed=run.first.sound_speed,
            next_stamp=next_stamp,
            sensor=self._sensors.at(stamp),
        )


def demodulated_band(configuration: BandDemodulatorConfiguration, samples: ArraySamples) -> Band:
    """Return the band that is taken out of samples.

    Parameters
    ----------
    configuration : BandDemodulatorConfiguration
        Centre and width.
    samples : ArraySamples
        Tell array, sample rate and sound speed.

    Raises
    ------
    InputError
        If the band does not suit them.
    """
    limit = _narrow(samples.element_positions, samples.sound_speed)
    bandwidth = chosen_bandwidth(configuration, samples.element_positions, samples.sound_speed)
    if bandwidth >= limit:
        raise InputError(
            f"bandwidth is {bandwidth:g} Hz; for this array it must be below {limit:.4g} Hz."
        )
    try:
        return design_band(samples.sample_rate, configuration.center_frequency, bandwidth)
    except ConfigurationError as error:
        raise InputError(str(error)) from error


def chosen_bandwidth(
    configuration: BandDemodulatorConfiguration,
    element_positions: FloatArray,
    sound_speed: float,
) -> float:
    """Return the bandwidth that is asked for, or what suits an array where none is.

    Parameters
    ----------
    configuration : BandDemodulatorConfiguration
        Centre and width.
    element_positions : ndarray, shape (n_elements, 3)
        m.
    sound_speed : float
        m/s.

    Returns
    -------
    float
        Hz.
    """
    suitable = 0.5 * _narrow(element_positions, sound_speed)
    return configuration.bandwidth or min(suitable, 0.1 * configuration.center_frequency)


def _narrow(element_positions: FloatArray, sound_speed: float) -> float:
    """Return the bandwidth from which on a band is not narrow for an array, Hz."""
    return MAXIMUM_RELATIVE_BANDWIDTH * sound_speed / max(float(aperture(element_positions)), 1e-9)
