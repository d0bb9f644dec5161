"""Contacts of a whole run at once, and what of the truth about them a tracker is told.

As :class:`~sonar_tracking.simulation.sensors.contact_simulation.ContactSimulation` without travel
times, for many short runs: echoes of all pings are drawn together, targets may have different
probabilities of detection, and azimuths are measured from the bow of an own ship that may turn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.active.contacts.sensor_location import MountingConfiguration, located
from sonar_tracking.active.detection.detection_threshold import linear_from_decibel
from sonar_tracking.motion import KinematicState, wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration

EPOCH = 1_767_225_600_000_000_000

UNKNOWN_TO_A_SENSOR = ("detection_probability", "signal_to_noise_ratio_linear", "clutter_density")
"""Fields of contacts that a detector cannot know: they are the targets' or the sea's."""

OF_THE_DETECTOR = (
    "false_alarm_probability",
    "detection_threshold",
    "range_resolution",
    "azimuth_resolution",
    "maximum_range",
)
"""Fields that a detector knows of itself but may not tell."""


@dataclass(frozen=True)
class Scene:
    """One run.

    Attributes
    ----------
    pings : tuple of Contacts
        One a ping, with everything about them told as it is.
    true_state : ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy at the stamps, m and m/s; NaN = the target is not there.
    """

    pings: tuple[Contacts, ...]
    true_state: FloatArray

    def truth(self) -> tuple[PositionTracks, ...]:
        """Return the true states as lists of tracks, one a ping."""
        return tuple(
            _true_tracks(ping.stamp, state)
            for ping, state in zip(self.pings, self.true_state, strict=True)
        )


def simulate(
    sensor: ContactSensorConfiguration,
    own_ship: KinematicState,
    true_state: FloatArray,
    detection_probability: FloatArray,
    generator: np.random.Generator,
) -> Scene:
    """Return the contacts of a run.

    Parameters
    ----------
    sensor : ContactSensorConfiguration
        Errors, survey, threshold and clutter; its sound speed is not used.
    own_ship : KinematicState
        At the pings, arrays of shape (n_pings, ...).
    true_state : ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s; NaN = not there.
    detection_probability : ndarray, shape (n_targets,)
        Of each target, a probability.
    generator : numpy.random.Generator
        All randomness.
    """
    echoes = _echoes(sensor, own_ship, true_state, detection_probability, generator)
    described = _description(sensor)
    pings = []
    for number in range(len(true_state)):
        false = _clutter(sensor, generator)
        found = np.concatenate([echoes[number][np.isfinite(echoes[number][:, 2])], false])
        # In the order of their range, which tells nothing.
        found = found[np.argsort(found[:, 0], kind="stable")]
        stamp = EPOCH + nanoseconds(number * sensor.ping_interval)
        measured = Contacts(
            stamp=stamp,
            range=found[:, 0],
            azimuth=wrap_angle(found[:, 1]),
            amplitude=found[:, 2],
            sensor_position=_pair(own_ship.position[number]),
            sensor_velocity=_pair(own_ship.velocity[number]),
            sensor_yaw=float(wrap_angle(own_ship.azimuth[number])),
            frame_id=sensor.sensor_id,
            next_stamp=stamp + nanoseconds(sensor.ping_interval),
            **described,
        )
        pings.append(located(measured, None, MountingConfiguration()))
    return Scene(tuple(pings), true_state)


def as_told(ping: Contacts, hidden: Sequence[str], claimed: Mapping[str, float]) -> Contacts:
    """Return a ping that tells less than the truth, and some of it wrong.

    Parameters
    ----------
    ping : Contacts
        That tells everything.
    hidden : sequence of str
        Fields that are not told; ``"amplitude"`` is one of them.
    claimed : mapping of str to float
        Fields with what is told instead.
    """
    changed: dict[str, Any] = {name: np.nan for name in hidden if name != "amplitude"}
    if "amplitude" in hidden:
        changed["amplitude"] = np.empty(0)
    return replace(ping, **{**changed, **claimed})


def threshold_of(sensor: ContactSensorConfiguration) -> float:
    """Return the threshold on the linear power: by P_D where that is given, or else by P_F."""
    if sensor.detection_probability > 0.0:
        return -(1.0 + _ratio(sensor)) * float(np.log(sensor.detection_probability))
    return -float(np.log(sensor.false_alarm_probability))


def detection_probability_of(sensor: ContactSensorConfiguration) -> float:
    """Return P_D of a target of the configured signal-to-noise ratio."""
    return float(np.exp(-threshold_of(sensor) / (1.0 + _ratio(sensor))))


def false_alarm_probability_of(sensor: ContactSensorConfiguration) -> float:
    """Return the share of resolution cells with a false contact, as it is and not as claimed."""
    if sensor.clutter_per_ping > 0.0:
        return sensor.clutter_per_ping / sensor.n_cells
    if sensor.clutter_shape > 0.0:
        return k_exceedance(threshold_of(sensor), sensor.clutter_shape)
    return sensor.false_alarm_probability


def k_exceedance(threshold: float, shape: float) -> float:
    """Return the probability that K-distributed clutter of mean power 1 exceeds a threshold.

    With x = 2 (shape threshold)^(1/2) it is 2 (x / 2)^shape K_shape(x) / Gamma(shape).

    Parameters
    ----------
    threshold : float
        Linear power.
    shape : float
        Of the gamma distribution of the local mean; infinite = exponential clutter.
    """
    from scipy.special import gamma, kv

    argument = 2.0 * np.sqrt(shape * threshold)
    return float(2.0 * (0.5 * argument) ** shape * kv(shape, argument) / gamma(shape))


def _echoes(
    sensor: ContactSensorConfiguration,
    own_ship: KinematicState,
    true_state: FloatArray,
    detection_probability: FloatArray,
    generator: np.random.Generator,
) -> FloatArray:
    """Return range, azimuth from the bow and amplitude; NaN = no echo; (n_pings, n_targets, 3)."""
    away = true_state[..., :2] - own_ship.position[:, None]
    shape = away.shape[:2]
    azimuth = np.arctan2(away[..., 1], away[..., 0]) - own_ship.azimuth[:, None]
    noise = generator.standard_normal((*shape, 2))
    distance = np.hypot(away[..., 0], away[..., 1])
    distance = distance + sensor.range_standard_deviation * noise[..., 0]
    azimuth = azimuth + sensor.azimuth_standard_deviation * noise[..., 1]
    # The excess of an exponential amplitude over a threshold is exponential again.
    excess = (1.0 + _ratio(sensor)) * generator.exponential(size=shape)
    heard = generator.random(shape) < detection_probability
    heard &= (distance > 0.0) & (distance <= sensor.maximum_range)
    amplitude = np.where(heard, threshold_of(sensor) + excess, np.nan)
    return np.stack([distance, azimuth, amplitude], axis=-1)


def _clutter(sensor: ContactSensorConfiguration, generator: np.random.Generator) -> FloatArray:
    """Return range, azimuth and amplitude of the false contacts of a ping, shape (n, 3)."""
    threshold = threshold_of(sensor)
    if sensor.clutter_shape > 0.0:
        texture = generator.gamma(sensor.clutter_shape, 1.0 / sensor.clutter_shape, sensor.n_cells)
        power = texture * generator.exponential(size=sensor.n_cells)
        amplitude = power[power > threshold]
    else:
        mean = sensor.n_cells * false_alarm_probability_of(sensor)
        amplitude = threshold + generator.exponential(size=generator.poisson(mean))
    share, turn = generator.random((2, len(amplitude)))
    share = np.sqrt(share) if sensor.clutter == "area" else share
    return np.stack([sensor.maximum_range * share, 2.0 * np.pi * turn, amplitude], axis=-1)


def _description(sensor: ContactSensorConfiguration) -> dict[str, Any]:
    """Return the fields of a ping that tell the truth about its detector, targets and clutter."""
    density = np.nan
    if sensor.clutter == "area":
        density = sensor.clutter_per_ping / (np.pi * sensor.maximum_range**2)
    return {
        "range_standard_deviation": sensor.range_standard_deviation,
        "azimuth_standard_deviation": sensor.azimuth_standard_deviation,
        "detection_probability": detection_probability_of(sensor),
        "false_alarm_probability": false_alarm_probability_of(sensor),
        "detection_threshold": threshold_of(sensor),
        "signal_to_noise_ratio_linear": _ratio(sensor),
        "clutter_density": density,
        "range_resolution": sensor.range_resolution,
        "azimuth_resolution": sensor.azimuth_resolution,
        "maximum_range": sensor.maximum_range,
        "ping_interval": sensor.ping_interval,
    }


def _true_tracks(stamp: int, state: FloatArray) -> PositionTracks:
    there = np.flatnonzero(np.isfinite(state[:, 0]))
    return PositionTracks(
        stamp=stamp,
        id=(there + 1).astype(np.uint64),
        status=np.full(len(there), TrackStatus.CONFIRMED, np.uint8),
        source=np.full(len(there), TrackSource.TRUTH, np.uint8),
        state=state[there],
    )


def _ratio(sensor: ContactSensorConfiguration) -> float:
    return float(linear_from_decibel(sensor.signal_to_noise_ratio_db))


def _pair(vector: FloatArray) -> tuple[float, float]:
    return float(vector[0]), float(vector[1])
