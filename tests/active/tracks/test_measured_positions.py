"""Protects what a track tells of its last update: one position that explains it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.measured_positions import measured_positions
from sonar_tracking.active.tracks.track_bank import TrackBank, empty_bank
from sonar_tracking.records.arrays import FloatArray


def bank(mean: FloatArray, covariance: FloatArray) -> TrackBank:
    """Return tracks of one mode."""
    count = len(mean)
    blank = empty_bank(1)
    return replace(
        blank,
        id=np.arange(count),
        existence=np.ones(count),
        confirmed=np.ones(count, bool),
        initiated=np.zeros(count, np.int64),
        updated=np.zeros(count, np.int64),
        mean=mean[:, None],
        covariance=covariance[:, None],
        mode_probability=np.ones((count, 1)),
        detection_weight=np.ones((count, blank.detection_weight.shape[1])),
        entered=np.zeros((count, 1)),
        calm=np.zeros((count, 1)),
        shown=np.ones((count, 1), dtype=bool),
    )


MEAN = np.array([[1000.0, 2000.0, 3.0, -1.0], [0.0, 500.0, 0.0, 0.0]])
SPREAD = np.array([[[400.0, 90.0], [90.0, 900.0]], [[100.0, 0.0], [0.0, 100.0]]])
COVARIANCE = np.zeros((2, 4, 4))
COVARIANCE[:, :2, :2], COVARIANCE[:, 2:, 2:] = SPREAD, np.eye(2)


def contacts(position: FloatArray, covariance: FloatArray) -> PlacedContacts:
    """Return contacts that were reflected at the stamp."""
    nothing = np.zeros(len(position))
    return PlacedContacts(position, covariance, nothing, nothing)


def test_a_certain_contact_is_the_measurement() -> None:
    position = np.array([[1010.0, 1970.0]])
    noise = np.array([[[250.0, -30.0], [-30.0, 160.0]]])
    pairs = GatePairs(np.array([0]), np.array([0]))
    found, covariance = measured_positions(
        bank(MEAN, COVARIANCE), contacts(position, noise), pairs, np.ones(1), np.array([0, 1])
    )
    np.testing.assert_allclose(found[0], position[0])
    np.testing.assert_allclose(covariance[0], noise[0], rtol=1e-9)
    assert np.all(np.isnan(found[1])) and np.all(np.isnan(covariance[1]))


def test_a_doubtful_contact_tells_less() -> None:
    """With probability p of its being the target's: scalar by hand along x.

    M = 100, R = 100, nu = 10: K = 1/2, N = M - p K M + p (1 - p) (K nu)^2.
    """
    share = 0.6
    position = np.array([[10.0, 500.0]])
    pairs = GatePairs(np.array([1]), np.array([0]))
    found, covariance = measured_positions(
        bank(MEAN, COVARIANCE),
        contacts(position, 100.0 * np.eye(2)[None]),
        pairs,
        np.array([share]),
        np.array([1]),
    )
    after = 100.0 - share * 50.0 + share * (1.0 - share) * 25.0
    noise = 1.0 / (1.0 / after - 1.0 / 100.0)
    assert np.isclose(covariance[0, 0, 0], noise)
    assert np.isclose(found[0, 0], noise / after * share * 5.0)


def test_contacts_that_only_confuse_measure_nothing() -> None:
    """Two equally likely contacts far apart along x: the track is less sure there than before."""
    position = np.array([[-60.0, 500.0], [60.0, 500.0]])
    pairs = GatePairs(np.array([1, 1]), np.array([0, 1]))
    found, covariance = measured_positions(
        bank(MEAN, COVARIANCE),
        contacts(position, np.tile(100.0 * np.eye(2), (2, 1, 1))),
        pairs,
        np.full(2, 0.5),
        np.array([1]),
    )
    assert np.allclose(found[0], MEAN[1, :2])
    assert covariance[0, 0, 0] > 1e9 and np.isclose(covariance[0, 1, 1], 100.0)
