"""What an active sonar reports: contacts of targets and clutter, ping by ping.

A ping leaves own ship at the stamp, is reflected where the target is when it arrives there, and is
received where own ship is then. Half the travel time times the sound speed is the range, the
direction of arrival the azimuth; both with Gaussian errors. Amplitudes are exponential, noise mean
1, target mean 1 + SNR; what exceeds the threshold is a contact. A sonar that is misaligned tells
azimuths that are too small by the angle it is turned by.

References
----------
Kim, Song (2007), equations 3-5, whose scene is instantaneous (sound speed 0 here).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.motion import KinematicState, Path, wrap_angle
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.simulation.scenarios.contact_configuration import (
    ContactSensorConfiguration,
    check_contact_sensor,
)

ITERATIONS = 8
"""Of the travel times at most; each one gains the ratio of speeds, about 1e-2."""


@dataclass(frozen=True)
class ContactTarget:
    """One target.

    Attributes
    ----------
    target_id : int
        Identity in the truth.
    path : Path
        Its motion.
    first_time, last_time : float
        When it is there, both inclusive, s.
    level_db : float
        Of its echo over that of a target of the configured ratio, dB.
    """

    target_id: int
    path: Path
    first_time: float = 0.0
    last_time: float = np.inf
    level_db: float = 0.0


@dataclass(frozen=True)
class SimulatedPing:
    """One ping and the truth at its stamp.

    Attributes
    ----------
    contacts : Contacts
        What the sensor reports.
    target_id : ndarray of int, shape (n,)
        Who is there.
    state : ndarray, shape (n, 4)
        x, y, vx, vy at the transmit time, m and m/s.
    """

    contacts: Contacts
    target_id: IntArray
    state: FloatArray


class ContactSimulation:
    """Active sonar on a moving own ship.

    Parameters
    ----------
    configuration : ContactSensorConfiguration
        The sensor.
    own_ship : Path
        Its motion.
    targets : sequence of ContactTarget
        What it looks at.
    generator : numpy.random.Generator
        All randomness.
    epoch : int
        Stamp of time 0, ns.
    start : float
        Time of ping 0, s.

    Raises
    ------
    ConfigurationError
        If parameters do not fit together.
    """

    def __init__(
        self,
        configuration: ContactSensorConfiguration,
        own_ship: Path,
        targets: Sequence[ContactTarget],
        generator: np.random.Generator,
        epoch: int,
        start: float = 0.0,
    ) -> None:
        check_contact_sensor(configuration)
        self._configuration = configuration
        self._own_ship = own_ship
        self._targets = tuple(targets)
        self._generator = generator
        self._epoch = epoch
        self._start = start

    def ping(self, number: int) -> SimulatedPing:
        """Return ping ``number``, transmitted number * ping_interval after the first one.

        Call in order: the random numbers of a ping follow those of the one before.
        """
        time = self._start + number * self._configuration.ping_interval
        present = [one for one in self._targets if one.first_time <= time <= one.last_time]
        own_ship = self._own_ship.state(time)
        states = [target.path.state(time) for target in present]
        echoes = [
            self._echo(target.path, time, state.position - own_ship.position)
            for target, state in zip(present, states, strict=True)
        ]
        levels = np.array([target.level_db for target in present])
        heard = self._detected(np.array([r for r, _ in echoes]), levels)
        noise = self._generator.standard_normal((len(present), 2))
        found = np.array(echoes).reshape(-1, 2)
        found[:, 0] += self._configuration.range_standard_deviation * noise[:, 0]
        found[:, 1] += self._configuration.azimuth_standard_deviation * noise[:, 1]
        kept = np.isfinite(heard) & (found[:, 0] > 0.0)
        kept &= found[:, 0] <= self._configuration.maximum_range
        clutter, amplitudes = self._clutter()
        rows = np.vstack([found[kept], clutter])
        heard = np.concatenate([heard[kept], amplitudes])
        return SimulatedPing(
            contacts=self._contacts(time, own_ship, rows, heard),
            target_id=np.array([target.target_id for target in present], dtype=np.int64),
            state=np.array([[*s.position, *s.velocity] for s in states]).reshape(-1, 4),
        )

    @property
    def threshold(self) -> float:
        """Threshold on the linear power, noise mean 1."""
        given = self._configuration.detection_probability
        if given > 0.0:
            return -(1.0 + self._nominal_ratio()) * float(np.log(given))
        return -float(np.log(self._configuration.false_alarm_probability))

    def _echo(self, path: Path, time: float, separation: FloatArray) -> tuple[float, float]:
        """Return range (m) and azimuth (rad) without errors, of a target so far away (m)."""
        speed = self._configuration.sound_speed
        if speed == 0.0:
            return float(np.hypot(*separation)), float(np.arctan2(separation[1], separation[0]))
        start = self._own_ship.state(time).position

        def to_target(after: float) -> FloatArray:
            return path.state(time + after).position - start

        there = _travel_time(to_target, speed)
        reflected = path.state(time + there).position

        def to_receiver(after: float) -> FloatArray:
            return reflected - self._own_ship.state(time + there + after).position

        back = _travel_time(to_receiver, speed)
        separation = reflected - self._own_ship.state(time + there + back).position
        azimuth = float(np.arctan2(separation[1], separation[0]))
        return 0.5 * speed * (there + back), azimuth

    def _nominal_ratio(self) -> float:
        return float(10.0 ** (self._configuration.signal_to_noise_ratio_db / 10.0))

    def _ratios(self, distance: FloatArray, level_db: FloatArray) -> FloatArray:
        reference = self._configuration.reference_range
        if reference == 0.0:
            return np.asarray(self._nominal_ratio() * 10.0 ** (level_db / 10.0))
        loss = 40.0 * np.log10(np.maximum(distance, 1.0) / reference)
        loss = loss + 2e-3 * self._configuration.absorption_db_per_km * (distance - reference)
        return np.asarray(self._nominal_ratio() * 10.0 ** ((level_db - loss) / 10.0))

    def _detected(self, distance: FloatArray, level_db: FloatArray) -> FloatArray:
        """Return the amplitudes of the targets, NaN where one is not detected."""
        level = self._generator.exponential(size=len(distance))
        luck = self._generator.random(len(distance))
        given = self._configuration.detection_probability
        if given > 0.0:
            amplitude = self.threshold + (1.0 + self._ratios(distance, level_db)) * level
            return np.where(luck < given, amplitude, np.nan)
        amplitude = (1.0 + self._ratios(distance, level_db)) * level
        return np.where(amplitude > self.threshold, amplitude, np.nan)

    def _clutter(self) -> tuple[FloatArray, FloatArray]:
        """Return range and azimuth, shape (n, 2), and amplitudes of the false contacts."""
        amplitudes = self.threshold + self._generator.exponential(size=self._clutter_count())
        shape = self._configuration.clutter_shape
        if shape > 0.0:
            texture = self._generator.gamma(shape, 1.0 / shape, self._configuration.n_cells)
            power = texture * self._generator.exponential(size=len(texture))
            amplitudes = power[power > self.threshold]
        uniform, turn = self._generator.random((2, len(amplitudes)))
        share = np.sqrt(uniform) if self._configuration.clutter == "area" else uniform
        azimuth = wrap_angle(2.0 * np.pi * turn)
        return np.stack([self._configuration.maximum_range * share, azimuth], axis=1), amplitudes

    def _clutter_count(self) -> int:
        given = self._configuration.clutter_per_ping
        by_threshold = self._configuration.n_cells * self._configuration.false_alarm_probability
        return int(self._generator.poisson(given if given > 0.0 else by_threshold))

    def _contacts(
        self, time: float, own_ship: KinematicState, rows: FloatArray, amplitudes: FloatArray
    ) -> Contacts:
        """Return the record, contacts in the order of their range: it tells nothing.

        A level that depends on the range is left unknown, since no single ratio is right.
        """
        sensor = self._configuration
        order = np.argsort(rows[:, 0], kind="stable")
        by_threshold = sensor.clutter_per_ping == 0.0
        density = np.nan
        if sensor.clutter == "area":
            density = sensor.clutter_per_ping / (np.pi * sensor.maximum_range**2)
        false_alarm = (
            sensor.false_alarm_probability
            if by_threshold
            else sensor.clutter_per_ping / sensor.n_cells
        )
        ratio = self._nominal_ratio() if sensor.reference_range == 0.0 else np.nan
        nominal = float(np.exp(-self.threshold / (1.0 + ratio)))
        return Contacts(
            stamp=self._stamp(time),
            range=rows[order, 0],
            azimuth=wrap_angle(rows[order, 1] - sensor.misalignment),
            amplitude=amplitudes[order],
            range_standard_deviation=sensor.range_standard_deviation,
            azimuth_standard_deviation=sensor.azimuth_standard_deviation,
            sensor_position=_pair(own_ship.position),
            sensor_velocity=_pair(own_ship.velocity),
            detection_probability=sensor.detection_probability or nominal,
            false_alarm_probability=false_alarm,
            detection_threshold=self.threshold,
            signal_to_noise_ratio_linear=ratio,
            clutter_density=density,
            range_resolution=sensor.range_resolution,
            azimuth_resolution=sensor.azimuth_resolution,
            maximum_range=sensor.maximum_range,
            next_stamp=self._stamp(time + sensor.ping_interval),
            ping_interval=sensor.ping_interval,
            sensor_id=sensor.sensor_id,
            sensor_yaw=float(wrap_angle(own_ship.azimuth)),
        )

    def _stamp(self, time: float) -> int:
        return self._epoch + nanoseconds(time)


def _travel_time(apart: Callable[[float], FloatArray], speed: float) -> float:
    """Return how long sound of a speed (m/s) travels, s, to what is so far away (m) then."""
    taken = 0.0
    for _ in range(ITERATIONS):
        before, taken = taken, float(np.hypot(*apart(taken))) / speed
        if taken == before:
            break
    return taken


def _pair(vector: FloatArray) -> tuple[float, float]:
    return float(vector[0]), float(vector[1])
