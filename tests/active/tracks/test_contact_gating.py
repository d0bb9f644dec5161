"""Protects: gating finds what exhaustive search finds."""

import numpy as np
import pytest

from sonar_tracking.active.tracks import contact_gating
from sonar_tracking.active.tracks.contact_gating import (
    SensorGeometry,
    find_pairs,
    predict_gates,
)
from tests.active.track_scene import COVARIANCE, bank_of, contacts_at


@pytest.mark.parametrize("compared_at_once", [0, 3000, 100_000])
def test_gating_finds_what_exhaustive_search_finds(
    compared_at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether all are compared or boxes are searched."""
    monkeypatch.setattr(contact_gating, "COMPARED_AT_ONCE", compared_at_once)
    generator = np.random.default_rng(1)
    bank = bank_of(generator.uniform(-3000.0, 3000.0, (60, 2)).tolist())
    contacts = contacts_at(generator.uniform(-3000.0, 3000.0, (200, 2)).tolist())
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.001, 0.0)
    pairs = find_pairs(bank, predict_gates(bank, sensor), contacts)
    found = set(zip(pairs.track.tolist(), pairs.contact.tolist(), strict=True))
    spread = COVARIANCE[:2, :2] + contacts.covariance[0]
    difference = contacts.position[None] - bank.mean[:, 0, None, :2]
    square = np.einsum("tci,ij,tcj->tc", difference, np.linalg.inv(spread), difference)
    assert found == set(zip(*(index.tolist() for index in np.nonzero(square < 16.0)), strict=True))
    assert np.all(np.diff(pairs.track) >= 0)
