"""Protects: one certain contact gives the Kalman update, several their mixture."""

from dataclasses import replace

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


def test_several_contacts_give_the_mixture_of_their_kalman_updates() -> None:
    """Mean and covariance of the mixture, coded plainly: every contact, and having none."""
    generator = np.random.default_rng(1)
    bank = bank_of([[1000.0, 2000.0], [5000.0, 0.0], [1010.0, 2010.0]], n_modes=2)
    root = generator.normal(size=(3, 2, 4, 4)) * np.array([20.0, 30.0, 1.0, 2.0])[:, None]
    bank = replace(bank, covariance=root @ np.swapaxes(root, -1, -2))
    contacts = contacts_at([[1020.0, 1990.0], [990.0, 2015.0]], delay=1.5)
    skew = np.array([[100.0, 30.0], [30.0, 50.0]])
    contacts = replace(contacts, covariance=np.stack([skew, 2.0 * skew]))
    pairs = GatePairs(np.array([0, 0, 2]), np.array([0, 1, 1]))
    weights = np.array([[0.5, 0.2], [0.3, 0.1], [0.6, 0.9]])
    updates = update_pairs(bank, contacts, pairs)
    mixed = mix_updates(bank, pairs, updates, weights)
    matrix = np.hstack([np.eye(2), 1.5 * np.eye(2)])
    for track, rows in [(0, [0, 1]), (2, [2])]:
        for mode in range(2):
            state = KalmanState(bank.mean[track, mode], bank.covariance[track, mode])
            parts = [(1.0 - np.sum(weights[rows, mode]), state)]
            for row in rows:
                contact = pairs.contact[row]
                noise = contacts.covariance[contact]
                updated = kalman_update(state, contacts.position[contact], matrix, noise)
                parts.append((weights[row, mode], updated.state))
                density = np.exp(
                    -0.5
                    * updated.innovation
                    @ np.linalg.solve(updated.innovation_covariance, updated.innovation)
                ) / np.sqrt(np.linalg.det(2.0 * np.pi * updated.innovation_covariance))
                assert updates.density[row, mode] == pytest.approx(density)
            mean = sum(w * part.mean for w, part in parts)
            spread = sum(
                w * (part.covariance + np.outer(part.mean - mean, part.mean - mean))
                for w, part in parts
            )
            assert mixed.mean[track, mode] == pytest.approx(mean)
            assert mixed.covariance[track, mode] == pytest.approx(spread)
    assert mixed.mean[1] == pytest.approx(bank.mean[1]), "no contact, no change"
    np.testing.assert_array_equal(mixed.covariance[1], bank.covariance[1])


def test_without_pairs_nothing_changes() -> None:
    bank = bank_of([[1000.0, 2000.0]])
    nothing = GatePairs(np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp))
    updates = update_pairs(bank, contacts_at([[1020.0, 1990.0]]), nothing)
    assert mix_updates(bank, nothing, updates, np.zeros((0, 1))) is bank
