"""Protects: one certain contact gives the Kalman update."""

import numpy as np
import pytest

from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
)
from sonar_tracking.active.tracks.pair_updates import mix_updates, update_pairs
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.filtering.kalman import update as kalman_update
from tests.active.track_scene import bank_of, contacts_at


def test_a_certain_contact_gives_the_kalman_update() -> None:
    bank = bank_of([[1000.0, 2000.0]])
    contacts = contacts_at([[1020.0, 1990.0]], delay=1.5)
    pairs = GatePairs(np.zeros(1, dtype=np.intp), np.zeros(1, dtype=np.intp))
    mixed = mix_updates(bank, pairs, update_pairs(bank, contacts, pairs), np.ones((1, 1)))
    matrix = np.hstack([np.eye(2), 1.5 * np.eye(2)])
    single = kalman_update(
        KalmanState(bank.mean[0, 0], bank.covariance[0, 0]),
        contacts.position[0],
        matrix,
        contacts.covariance[0],
    )
    assert mixed.mean[0, 0] == pytest.approx(single.state.mean)
    assert mixed.covariance[0, 0] == pytest.approx(single.state.covariance)
