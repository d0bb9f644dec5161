"""Tracks and contacts in the plane: data shared by the tests."""

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.detection.detection_levels import LEVELS
from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.active.tracks.particle_densities import particle_densities
from sonar_tracking.active.tracks.track_bank import TrackBank

COVARIANCE = np.diag([400.0, 900.0, 1.0, 2.0])


def bank_of(positions: list[list[float]], n_modes: int = 1) -> TrackBank:
    count = len(positions)
    mean = np.column_stack([positions, np.full(count, 1.0), np.full(count, 0.5)])
    return TrackBank(
        id=np.arange(1, count + 1),
        existence=np.full(count, 0.8),
        confirmed=np.ones(count, dtype=bool),
        initiated=np.zeros(count, dtype=np.int64),
        updated=np.zeros(count, dtype=np.int64),
        mean=np.repeat(mean[:, None], n_modes, axis=1),
        covariance=np.tile(COVARIANCE, (count, n_modes, 1, 1)),
        mode_probability=np.full((count, n_modes), 1.0 / n_modes),
        entered=np.zeros((count, n_modes)),
        calm=np.zeros((count, n_modes)),
        shown=np.ones((count, n_modes), dtype=bool),
        detection_weight=np.tile(LEVELS == 0.95, (count, 1)).astype(float),
    )


def contacts_at(positions: list[list[float]], delay: float = 0.0) -> PlacedContacts:
    position = np.array(positions, dtype=float).reshape(-1, 2)
    count = len(position)
    return PlacedContacts(
        position=position,
        covariance=np.tile(np.diag([100.0, 50.0]), (count, 1, 1)),
        distance=np.hypot(position[:, 0], position[:, 1]),
        delay=np.full(count, delay),
    )


def densities_of(state: np.ndarray, contacts: PlacedContacts, sensor: SensorGeometry) -> np.ndarray:
    """Return the densities of all particles and contacts, shape (n, n_contacts), 1/m^2."""
    nobody_else = np.zeros(len(contacts.distance), dtype=np.intp)
    return particle_densities(state[None], nobody_else, contacts, sensor).T
