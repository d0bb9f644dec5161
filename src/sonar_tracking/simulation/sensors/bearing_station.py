"""One station of a measurement-level simulation: its noise, its outliers, what it identifies.

With u the unit vector from the station to where the target was when the sound left it, v_a and v_t
the velocities of station and target, a line of frequency f_S is received with

    f = f_S (c + u . v_a) / (c + u . v_t)      (sound with its travel time),
    f = f_S (1 - rdot / c)                     (sound at once, as in the paper).

References
----------
Cheong (2011), eqs. 6, 7.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.motion import KinematicState, Path, Trajectory, emission_times, wrap_angle
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.lines import NOT_ATTRIBUTED, FrequencyLines
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    INSTANTANEOUS,
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import OWN_SHIP, Receiver
from sonar_tracking.simulation.scenarios.target import TargetConfiguration
from sonar_tracking.simulation.sensors.arrivals_ahead import ArrivalsAhead

AT_ONCE = 1e15
"""Sound speed that leaves no travel time, m/s."""


class BearingStation:
    """Measures the targets, frame by frame in their order.

    Parameters
    ----------
    configuration : BearingSensorConfiguration
        The station.
    trajectory : Trajectory
        Its motion.
    targets : sequence of TargetConfiguration
        What it listens to.
    generator : numpy.random.Generator
        Its randomness.
    times : ndarray, shape (n_frames,)
        Of its frames, s.
    """

    def __init__(
        self,
        configuration: BearingSensorConfiguration,
        trajectory: Trajectory,
        targets: Sequence[TargetConfiguration],
        generator: np.random.Generator,
        times: FloatArray,
    ) -> None:
        self._configuration = configuration
        self._trajectory = trajectory
        self._targets = tuple(targets)
        self._generator = generator
        self._track_of: dict[int, int] = {}
        self._tracks_started = 0
        delayed = configuration.propagation != INSTANTANEOUS
        receiver = Receiver(
            trajectory=trajectory,
            mounting_yaw=configuration.mounting_yaw,
            sound_speed=configuration.sound_speed if delayed else AT_ONCE,
            ambiguous=configuration.ambiguous,
        )
        self._times = times
        self._arrivals = ArrivalsAhead(self._targets, receiver, times)

    def truth(self, frame: int, stamp: int, next_stamp: int) -> BearingTracks:
        """Return the true angles of the targets present, identified by their numbers from 1."""
        time = float(self._times[frame])
        rows = [n for n, target in enumerate(self._targets) if target.is_heard(time)]
        angles, rates = self._arrivals.at(frame, rows)
        count = len(rows)
        return self._tracks(
            stamp,
            next_stamp,
            self._sensor(time),
            ids=[row + 1 for row in rows],
            status=np.full(count, TrackStatus.CONFIRMED),
            angles=angles,
            rates=rates,
            measured=np.full(count, np.nan),
            variance=0.0,
        )

    def measure(
        self, frame: int, truth: BearingTracks, last: bool
    ) -> tuple[BearingTracks, FrequencyLines] | None:
        """Return bearings and lines with their errors, or None where the frame is missing.

        Parameters
        ----------
        frame : int
            Its number, from 0.
        truth : BearingTracks
            In it.
        last : bool
            The last frame is never missing: it tells that the data end.
        """
        station = self._configuration
        n_targets = len(self._targets)
        n_lines = sum(len(target.lines) for target in self._targets)
        normal = self._generator.standard_normal(n_targets + 2 * n_lines)
        uniform = self._generator.random((2, n_targets + n_lines))
        missing = self._generator.random() < station.missing_share
        if missing and not last:
            return None
        present = [int(number) - 1 for number in truth.id]
        angles = truth.arrival_angle + station.angle_deviation * normal[present]
        limit = 0.5 * np.pi if station.ambiguous else np.pi
        wild = uniform[0, present] < station.outlier_share
        angles = np.where(wild, limit * (2.0 * uniform[1, present] - 1.0), angles)
        # A cone is told with the axis, which is where the misalignment stands then.
        told = _folded(angles) if station.ambiguous else wrap_angle(angles - station.misalignment)
        bearings = self._bearings(truth, present, told)
        of_lines = normal[n_targets:].reshape(2, n_lines)
        lines = self._lines(float(self._times[frame]), truth, of_lines, uniform[:, n_targets:])
        return bearings, lines

    def _bearings(
        self, truth: BearingTracks, present: list[int], angles: FloatArray
    ) -> BearingTracks:
        ended = [self._track_of.pop(row) for row in sorted(self._track_of) if row not in present]
        for row in present:
            if row not in self._track_of:
                self._tracks_started += 1
                self._track_of[row] = self._tracks_started
        gone = np.full(len(ended), np.nan)
        return self._tracks(
            truth.stamp,
            truth.next_stamp,
            truth.sensor,
            ids=[self._track_of[row] for row in present] + ended,
            status=np.repeat(
                [TrackStatus.CONFIRMED, TrackStatus.TERMINATED], [len(present), len(ended)]
            ),
            angles=np.concatenate([angles, gone]),
            rates=np.full(len(present) + len(ended), np.nan),
            measured=np.concatenate([angles, gone]),
            variance=self._configuration.angle_deviation**2,
        )

    def _tracks(
        self,
        stamp: int,
        next_stamp: int,
        sensor: Sensor,
        ids: list[int],
        status: IntArray,
        angles: FloatArray,
        rates: FloatArray,
        measured: FloatArray,
        variance: float,
    ) -> BearingTracks:
        count = len(ids)
        covariance = np.full((count, 2, 2), np.nan)
        covariance[:, 0, 0] = variance
        unknown = np.full(count, np.nan)
        ambiguous = self._configuration.ambiguous
        return BearingTracks(
            stamp=stamp,
            id=np.array(ids, dtype=np.uint64),
            status=status.astype(np.uint8),
            arrival_angle=angles,
            arrival_angle_rate=rates,
            covariance=covariance,
            measurement=measured,
            measurement_variance=np.where(np.isfinite(measured), variance, np.nan),
            innovation=unknown,
            signal_to_noise_ratio=unknown,
            existence_probability=np.ones(count),
            ambiguous=np.full(count, ambiguous),
            next_stamp=next_stamp,
            sensor=sensor,
            angle_kind=AngleKind.CONE if ambiguous else AngleKind.AZIMUTH,
        )

    def _lines(
        self, time: float, truth: BearingTracks, normal: FloatArray, uniform: FloatArray
    ) -> FrequencyLines:
        station = self._configuration
        state = self._trajectory.state(time)
        angle_of = {int(n) - 1: a for n, a in zip(truth.id, truth.arrival_angle, strict=True)}
        tracks, angles, numbers, frequencies = [], [], [], []
        first = 0
        for row, target in enumerate(self._targets):
            numbered = list(enumerate(target.lines, first))
            first += len(numbered)
            present = [one for one in numbered if row in angle_of and one[1].is_present(time)]
            if not present:
                continue
            assert isinstance(target.motion, KinematicMotion)
            ratio = frequency_ratio(
                target.motion.trajectory, state, time, station.sound_speed, station.propagation
            )
            for number, line in present:
                error = station.frequency_standard_deviation * normal[0, number]
                if uniform[0, number] < station.line_outlier_share:
                    error = station.line_outlier_width * (2.0 * uniform[1, number] - 1.0)
                tracks.append(self._track_of[row] if station.attribute_lines else NOT_ATTRIBUTED)
                angle = angle_of[row] + station.angle_deviation * normal[1, number]
                angles.append(self._from_broadside(angle, state))
                numbers.append(number + 1)
                frequencies.append(line.frequency * ratio + error)
        count = len(numbers)
        deviation = np.full(count, station.frequency_standard_deviation)
        return FrequencyLines(
            stamp=truth.stamp,
            track_id=np.array(tracks, dtype=np.uint64),
            arrival_angle=np.array(angles, dtype=np.float64),
            arrival_angle_variance=np.full(count, station.angle_deviation**2),
            line_id=np.array(numbers, dtype=np.uint64),
            frequency=np.array(frequencies, dtype=np.float64),
            standard_deviation=deviation,
            signal_to_noise_ratio=np.full(count, np.nan),
            integration_time=np.full(count, station.frame_interval),
            next_stamp=truth.next_stamp,
            sensor=truth.sensor,
        )

    def _from_broadside(self, angle: float, state: KinematicState) -> float:
        if self._configuration.ambiguous:
            return float(np.arcsin(np.sin(angle)))
        from_axis = float(wrap_angle(angle - state.azimuth - self._configuration.mounting_yaw))
        return 0.5 * np.pi - abs(from_axis)

    def _sensor(self, time: float) -> Sensor:
        station = self._configuration
        state = self._trajectory.state(time)
        yaw = state.azimuth + station.mounting_yaw - station.misalignment
        half_yaw = 0.5 * float(wrap_angle(yaw))
        frame = "map"
        if station.ambiguous:
            frame = f"{'own_ship' if station.platform == OWN_SHIP else station.sensor_id}/array"
        return Sensor(
            sensor_id=station.sensor_id,
            frame_id=frame,
            position=(float(state.position[0]), float(state.position[1]), 0.0),
            orientation=(0.0, 0.0, float(np.sin(half_yaw)), float(np.cos(half_yaw))),
            velocity=(float(state.velocity[0]), float(state.velocity[1]), 0.0),
        )


def _folded(angles: FloatArray) -> FloatArray:
    """Return arrival angles as a line array tells them, in -pi/2 ... pi/2."""
    return np.asarray(np.arcsin(np.sin(angles)))


def frequency_ratio(
    target: Path, receiver: KinematicState, time: float, sound_speed: float, propagation: str
) -> float:
    """Return received over emitted frequency.

    Parameters
    ----------
    target : Path
        What emits.
    receiver : KinematicState
        What receives, at ``time``.
    time : float
        Of reception, s.
    sound_speed : float
        m/s.
    propagation : str
        ``delayed`` or ``instantaneous``.
    """
    instantaneous = propagation == INSTANTANEOUS
    emitted = (
        time if instantaneous else emission_times(target, receiver.position, time, sound_speed)
    )
    source = target.state(emitted)
    separation = source.position - receiver.position
    direction = separation / max(float(np.hypot(*separation)), 1e-9)
    if instantaneous:
        return float(1.0 - direction @ (source.velocity - receiver.velocity) / sound_speed)
    closing = sound_speed + direction @ receiver.velocity
    return float(closing / (sound_speed + direction @ source.velocity))
