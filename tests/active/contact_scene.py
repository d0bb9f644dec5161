"""Targets 3 km apart that all move alike, in clutter: the scene of several tests."""

import numpy as np

from sonar_tracking.active.contact_tracker import ContactTracker, make_contact_tracker
from sonar_tracking.active.contacts.contact_method_registry import CONTACT_METHODS
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate

METHODS = CONTACT_METHODS.names
WITH_EXISTENCE = CONTACT_METHODS.names_with("estimates_existence")
SECOND = 1_000_000_000
VELOCITY = np.array([2.0, -1.0])
NOTHING = np.zeros(0)


PUBLISHED: dict[str, float | str] = {
    "motion": "turning",
    "acceleration_deviation": 0.0015,
    "lateral_acceleration": 0.01,
    "initial_speed_deviation": 1.5,
    "detection_probability": 0.9,
    "signal_to_noise_ratio_db": 10.0,
}
"""What the paper tells its trackers of targets and detector."""


def start(method: str, **values: float | str) -> ContactTracker:
    told = {} if method == "integrated" else {**PUBLISHED, "acceleration_deviation": 0.005}
    given = {"sound_speed": 0.0, "n_particles": 300, **told, **values}
    return make_contact_tracker(
        ContactTrackerConfiguration(method=method, **given)  # type: ignore[arg-type]
    )


def ping(
    number: int,
    generator: np.random.Generator,
    targets: int = 1,
    clutter: int = 5,
    heard: bool = True,
) -> Contacts:
    """Return a ping with targets 3 km apart that all move alike."""
    truth = target_positions(number, targets)
    distance = np.hypot(truth[:, 0], truth[:, 1]) + 20.0 * generator.standard_normal(targets)
    azimuth = np.arctan2(truth[:, 1], truth[:, 0]) + 0.002 * generator.standard_normal(targets)
    if not heard:
        distance, azimuth = NOTHING, NOTHING
    far = 10_000.0 * np.sqrt(generator.random(clutter))
    around = np.pi * (2.0 * generator.random(clutter) - 1.0)
    strong = 1.0 + 11.0 * generator.exponential(size=len(distance))
    return Contacts(
        stamp=(100 + 10 * number) * SECOND,
        range=np.concatenate([distance, far]),
        azimuth=np.concatenate([azimuth, around]),
        amplitude=np.concatenate([strong, 1.0 + generator.exponential(size=clutter)]),
        range_standard_deviation=20.0,
        azimuth_standard_deviation=0.002,
        detection_threshold=1.0,
        clutter_density=max(clutter, 1) / (np.pi * 1e8),
        maximum_range=10_000.0,
    )


def target_positions(number: int, targets: int) -> np.ndarray:
    starts = np.array([[3000.0 * index - 3000.0, 4000.0] for index in range(targets)])
    return starts + 10.0 * number * VELOCITY


def confirmed(update: ContactTrackerUpdate) -> np.ndarray:
    return np.flatnonzero(
        np.isin(update.tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
    )
