"""Protects: joint association is what listing all events gives; crowds fall back."""

from itertools import product

import numpy as np
import pytest

from sonar_tracking.active.association import jpda
from sonar_tracking.active.association.jpda import associate_jointly


def test_joint_association_agrees_with_listing_all_events() -> None:
    ratios, missed = np.array([[2.0, 0.5], [1.5, 0.0]]), 0.1
    events = {
        (-1, -1): missed * missed,
        (0, -1): 2.0 * missed,
        (1, -1): 0.5 * missed,
        (-1, 0): missed * 1.5,
        (1, 0): 0.5 * 1.5,
    }
    total = sum(events.values())
    expected = np.zeros((2, 2))
    for chosen, weight in events.items():
        for track, contact in enumerate(chosen):
            if contact >= 0:
                expected[track, contact] += weight / total
    assert associate_jointly(ratios, missed) == pytest.approx(expected)


def test_joint_association_of_crowds_falls_back() -> None:
    ratios = np.full((8, 30), 0.1)
    probabilities = associate_jointly(ratios, 0.5)
    assert np.sum(probabilities, axis=1) == pytest.approx(np.full(8, 3.0 / 3.5))
    assert associate_jointly(np.zeros((0, 3)), 0.1).shape == (0, 3)


def by_listing(ratios: np.ndarray, missed: float) -> np.ndarray:
    """Return the probabilities from a list of all events in which no contact is given twice."""
    n_tracks, n_contacts = ratios.shape
    total, probabilities = 0.0, np.zeros_like(ratios)
    for event in product(range(-1, n_contacts), repeat=n_tracks):
        given = [contact for contact in event if contact >= 0]
        if len(set(given)) < len(given):
            continue
        weight = float(np.prod([missed if c < 0 else ratios[t, c] for t, c in enumerate(event)]))
        total += weight
        for track, contact in enumerate(event):
            if contact >= 0:
                probabilities[track, contact] += weight
    return probabilities / total


def test_clusters_are_as_good_as_all_at_once() -> None:
    """Tracks without common contacts do not know of each other."""
    generator = np.random.default_rng(1)
    ratios = generator.random((4, 5))
    ratios[generator.random((4, 5)) < 0.4] = 0.0
    ratios[3] = 0.0  # a track without contacts
    assert associate_jointly(ratios, 0.3) == pytest.approx(by_listing(ratios, 0.3))
    apart = np.zeros((3, 4))
    apart[0, :2], apart[1, 1], apart[2, 2:] = [2.0, 1.0], 3.0, [0.5, 4.0]
    assert associate_jointly(apart, 0.1) == pytest.approx(by_listing(apart, 0.1))


@pytest.mark.parametrize(("bound", "listed"), [(8, True), (7, False)])
def test_a_cluster_is_listed_up_to_the_bound_of_events(
    bound: int, listed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two tracks, three contacts and none: 4 * 2 = 8 events at most."""
    monkeypatch.setattr(jpda, "MAXIMUM_EVENTS", bound)
    ratios = np.array([[1.0, 2.0, 3.0], [0.0, 5.0, 0.0]])
    alone = ratios / (0.1 + np.sum(ratios, axis=1))[:, None]
    expected = by_listing(ratios, 0.1) if listed else alone
    assert associate_jointly(ratios, 0.1) == pytest.approx(expected)
    assert associate_jointly(np.zeros((2, 0)), 0.1).shape == (2, 0)
