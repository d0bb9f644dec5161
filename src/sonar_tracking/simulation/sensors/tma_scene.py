"""Measurement-level simulation of target motion analysis: azimuths and lines on and off.

Every run draws its own numbers from its own generator, all lines in all frames, so that neither
the schedule of the lines nor the number of runs changes them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

EPOCH = 1_767_225_600 * NANOSECONDS
"""Stamp of the first frame, ns."""


@dataclass(frozen=True)
class TmaScene:
    """One target, one moving sensor, lines on a schedule.

    Attributes
    ----------
    times : ndarray, shape (n_frames,)
        s from the first frame.
    sensor_position, sensor_velocity : ndarray, shape (n_frames, 2)
        m and m/s.
    target : ndarray, shape (4,)
        x, y, vx, vy in the first frame, m and m/s.
    line_frequency : ndarray, shape (n_lines,)
        At the source, Hz.
    heard : ndarray of bool, shape (n_frames, n_lines)
        Which line is present when.
    azimuth_deviation : float
        Of the measurement noise, rad.
    frequency_deviation : float
        Of the measurement noise, Hz.
    acceleration : float
        Standard deviation of the target's acceleration, constant over a frame, m/s^2.
    commanded : ndarray, shape (n_frames, 2)
        Change of the target's velocity between a frame and the next, m/s: manoeuvres.
    sound_speed : float
        m/s.
    """

    times: FloatArray
    sensor_position: FloatArray
    sensor_velocity: FloatArray
    target: FloatArray
    line_frequency: FloatArray
    heard: BoolArray
    azimuth_deviation: float
    frequency_deviation: float
    acceleration: float
    commanded: FloatArray
    sound_speed: float = 1500.0


@dataclass(frozen=True)
class TmaRuns:
    """What was measured in a batch of runs, and where the target was.

    Attributes
    ----------
    scene : TmaScene
        Common to all runs.
    truth : ndarray, shape (n_runs, n_frames, 4)
        x, y, vx, vy, m and m/s.
    azimuth : ndarray, shape (n_runs, n_frames)
        Measured, rad.
    frequency : ndarray, shape (n_runs, n_frames, n_lines)
        Measured, Hz; NaN = absent.
    """

    scene: TmaScene
    truth: FloatArray
    azimuth: FloatArray
    frequency: FloatArray

    def frames(self) -> Iterator[TmaMeasurement]:
        """Yield one measurement a frame, all runs in it."""
        scene = self.scene
        for index, time in enumerate(scene.times):
            frequency = self.frequency[:, index]
            yield TmaMeasurement(
                stamp=EPOCH + round(time * NANOSECONDS),
                position=scene.sensor_position[index],
                velocity=scene.sensor_velocity[index],
                azimuth=self.azimuth[:, index, None],
                azimuth_variance=np.array(scene.azimuth_deviation**2),
                frequency=frequency,
                frequency_deviation=np.full(frequency.shape, scene.frequency_deviation),
                sound_speed=scene.sound_speed,
            )


def simulate_runs(scene: TmaScene, seeds: Sequence[np.random.SeedSequence]) -> TmaRuns:
    """Draw the runs of a batch.

    Parameters
    ----------
    scene : TmaScene
        What to simulate.
    seeds : sequence of numpy.random.SeedSequence
        One a run.
    """
    n_frames, n_lines = scene.heard.shape
    truth = np.empty((len(seeds), n_frames, 4))
    noise = np.empty((len(seeds), n_frames, 1 + n_lines))
    for run, seed in enumerate(seeds):
        generator = np.random.default_rng(seed)
        truth[run] = true_states(scene, generator.standard_normal((n_frames, 2)))
        noise[run] = generator.standard_normal((n_frames, 1 + n_lines))
    offset = truth[..., :2] - scene.sensor_position
    relative = truth[..., 2:] - scene.sensor_velocity
    distance = np.hypot(offset[..., 0], offset[..., 1])
    rate = np.sum(offset * relative, axis=-1) / distance
    azimuth = np.arctan2(offset[..., 1], offset[..., 0])
    frequency = scene.line_frequency * (1.0 - rate[..., None] / scene.sound_speed)
    frequency = frequency + scene.frequency_deviation * noise[..., 1:]
    return TmaRuns(
        scene,
        truth,
        azimuth + scene.azimuth_deviation * noise[..., 0],
        np.where(scene.heard, frequency, np.nan),
    )


def true_states(scene: TmaScene, normal: FloatArray) -> FloatArray:
    """Return the target's path for given standard normal accelerations.

    Parameters
    ----------
    scene : TmaScene
        The motion.
    normal : ndarray, shape (n_frames, 2)
        Pure numbers; row k acts between frame k and the next.

    Returns
    -------
    ndarray, shape (n_frames, 4)
        x, y, vx, vy, m and m/s.
    """
    intervals = np.diff(scene.times)[:, None]
    change = scene.acceleration * normal[:-1] * intervals + scene.commanded[:-1]
    velocity = scene.target[2:] + np.concatenate([np.zeros((1, 2)), np.cumsum(change, axis=0)])
    steps = 0.5 * (velocity[1:] + velocity[:-1]) * intervals
    position = scene.target[:2] + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    return np.concatenate([position, velocity], axis=-1)
