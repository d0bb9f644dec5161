"""Element time series of plane waves from fixed angles, for tests of what listens to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.bearings import BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS
from sonar_tracking.simulation.signals.sample_propagation import plane_wave_emission_times

EPOCH = 1_767_225_600 * NANOSECONDS
RATE = 1000.0
SOUND_SPEED = 1500.0
POSITIONS = np.stack([1.8 * np.arange(16), np.zeros(16), np.zeros(16)], axis=1)


@dataclass(frozen=True)
class Tone:
    """A tone from a direction; level over the noise of an element in 1 Hz."""

    frequency: float
    angle_deg: float
    level_db: float


def element_samples(tones: Sequence[Tone], seconds: float, seed: int = 1) -> np.ndarray:
    """Return tones in white noise of power 1 a hertz, shape (n_samples, n_elements)."""
    generator = np.random.default_rng(seed)
    times = np.arange(round(seconds * RATE)) / RATE
    data = np.sqrt(0.5 * RATE) * generator.standard_normal((len(times), len(POSITIONS)))
    for tone in tones:
        angle = np.array(np.radians(tone.angle_deg))
        emitted = plane_wave_emission_times(angle, SOUND_SPEED, POSITIONS, times)
        amplitude = np.sqrt(2.0 * 10.0 ** (tone.level_db / 10.0))
        phase = generator.uniform(0.0, 2.0 * np.pi)
        data += amplitude * np.cos(2.0 * np.pi * tone.frequency * emitted + phase)
    return data


def blocks(
    data: np.ndarray, block_samples: int = 250, stamp: int = EPOCH, sensor: Sensor | None = None
) -> list[ArraySamples]:
    """Return contiguous blocks; the last one ends the data."""
    records = []
    for first in range(0, len(data), block_samples):
        last = min(first + block_samples, len(data))
        records.append(
            ArraySamples(
                stamp=stamp + round(first / RATE * NANOSECONDS),
                data=data[first:last],
                element_positions=POSITIONS,
                sample_rate=RATE,
                sound_speed=SOUND_SPEED,
                next_stamp=(
                    END_OF_DATA if last == len(data) else stamp + round(last / RATE * NANOSECONDS)
                ),
                sensor=sensor or Sensor(),
            )
        )
    return records


def bearings(
    angles_deg: Sequence[float],
    stamp: int = EPOCH,
    rates_deg: Sequence[float] | None = None,
    status: TrackStatus = TrackStatus.CONFIRMED,
) -> BearingTracks:
    """Return confirmed tracks 1, 2, ... on the given angles."""
    count = len(angles_deg)
    unknown = np.full(count, np.nan)
    return BearingTracks(
        stamp=stamp,
        id=np.arange(1, count + 1, dtype=np.uint64),
        status=np.full(count, status, dtype=np.uint8),
        arrival_angle=np.radians(angles_deg),
        arrival_angle_rate=np.radians(rates_deg if rates_deg is not None else np.zeros(count)),
        covariance=np.tile(np.diag([1e-6, 1e-8]), (count, 1, 1)),
        measurement=unknown,
        measurement_variance=unknown,
        innovation=unknown,
        signal_to_noise_ratio=unknown,
        existence_probability=np.ones(count),
        ambiguous=np.ones(count, dtype=bool),
    )
