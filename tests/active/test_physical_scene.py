"""Protects: tracking with a moving own ship, reflection times and clutter other than claimed."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.clutter_monitor import ClutterMonitor
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.motion import Trajectory, Turn
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.sensors.contact_simulation import ContactSimulation, ContactTarget

SENSOR = ContactSensorConfiguration(
    range_standard_deviation=30.0,
    azimuth_standard_deviation_deg=0.5,
    false_alarm_probability=1e-3,
    signal_to_noise_ratio_db=13.0,
)
TRACKER = ContactTrackerConfiguration(
    initial_speed_deviation=5.0, lateral_acceleration=0.06, acceleration_deviation=0.01
)
OWN_SHIP = Trajectory((0.0, 0.0), 0.5, 8.0, [Turn(500.0, 2.0, 0.02)])
TARGETS = (
    ContactTarget(1, Trajectory((-3000.0, -4000.0), 0.6, 9.0, [Turn(600.0, 2.0, 0.01)])),
    ContactTarget(2, Trajectory((3000.0, 2000.0), 3.0, 8.0, [Turn(300.0, 1.2, 0.01)]), 200.0),
)
PINGS = 110


def run(
    sensor: ContactSensorConfiguration, configuration: ContactTrackerConfiguration
) -> tuple[np.ndarray, np.ndarray, bool]:
    """Return errors (m, NaN where not held), how many tracks too many, and whether it warned."""
    simulation = ContactSimulation(sensor, OWN_SHIP, TARGETS, np.random.default_rng(1), 10**15)
    tracker = make_contact_tracker(configuration)
    errors, excess, warned = [], [], False
    for number in range(PINGS):
        ping = simulation.ping(number)
        update = tracker.update(ping.contacts)
        shown = np.isin(update.tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
        state = update.tracks.state[shown]
        separation = np.linalg.norm(ping.state[:, None, :2] - state[None, :, :2], axis=2)
        nearest = np.min(separation, axis=1, initial=np.inf)
        excess.append(len(state) - len(ping.state))
        if number >= 40:
            errors.append(np.where(nearest < 200.0, nearest, np.nan))
        warned = warned or any(notice.culprit == "clutter" for notice in update.notices)
    return np.array(errors), np.array(excess), warned


@pytest.mark.slow
def test_reflection_times_and_own_motion_are_accounted_for() -> None:
    errors, excess, warned = run(SENSOR, TRACKER)
    assert np.mean(np.isfinite(errors)) > 0.9
    assert np.mean(np.abs(excess)) < 0.6
    assert not warned
    careless, _, _ = run(SENSOR, replace(TRACKER, sound_speed=0.0))
    assert np.nanmedian(errors) < 0.85 * np.nanmedian(careless)


@pytest.mark.slow
def test_levels_that_are_not_known_are_averaged() -> None:
    errors, excess, _ = run(SENSOR, replace(TRACKER, signal_to_noise_ratio_db=0.0))
    assert np.mean(np.isfinite(errors)) > 0.85
    assert np.mean(np.abs(excess)) < 0.6


@pytest.mark.slow
def test_heavy_tailed_clutter_is_noticed_and_makes_no_crowd_of_tracks() -> None:
    heavy = replace(SENSOR, clutter_shape=1.0)
    _, excess, warned = run(heavy, TRACKER)
    assert warned
    assert np.max(excess) <= 3


@pytest.mark.parametrize(
    ("count", "factor"), [(8, 1.0), (10, 1.0), (13, 1.0), (40, 4.0), (200, 20.0)]
)
def test_the_claim_is_believed_unless_clearly_wrong(count: int, factor: float) -> None:
    model = DetectionModel(
        detection_probability=0.9,
        signal_to_noise_ratio_linear=10.0,
        averaged=False,
        outlier_share=0.01,
        threshold=2.0,
        false_alarm_probability=1e-3,
        cell_size=2.0 * np.pi,
        uniform_density=np.nan,
        maximum_range=10_000.0,
    )
    assert model.expected_clutter() == pytest.approx(10.0)
    monitor = ClutterMonitor()
    for _ in range(30):
        monitor = monitor.after(count, 0, model)
    assert monitor.factor() == pytest.approx(factor)
    assert len(monitor.notices()) == (factor > 1.0)
    density = monitor.corrected(model).clutter_density(np.array([500.0]))
    assert density == pytest.approx(factor * model.clutter_density(np.array([500.0])))
