"""Protects: gating finds what exhaustive search finds."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks import pair_search
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    SensorGeometry,
    delayed_position_covariance,
    determinant,
    inverse,
    predict_gates,
    sensor_geometry,
)
from sonar_tracking.active.tracks.pair_search import find_pairs
from sonar_tracking.active.tracks.track_bank import TrackBank, empty_bank
from sonar_tracking.records.contacts import Contacts
from tests.active.track_scene import COVARIANCE, bank_of, contacts_at


@pytest.fixture(autouse=True, params=["compiled", "in numpy"])
def _ways(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Search in both ways, where there are two."""
    if request.param == "in numpy":
        monkeypatch.setattr(pair_search, "COMPILED", None)
    elif pair_search.COMPILED is None:
        pytest.skip("no compiler was there: in numpy alone")


@pytest.mark.parametrize("compared_at_once", [0, 3000, 100_000])
def test_gating_finds_what_exhaustive_search_finds(
    compared_at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether all are compared or boxes are searched."""
    monkeypatch.setattr(pair_search, "COMPARED_AT_ONCE", compared_at_once)
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


def moving_bank(count: int) -> TrackBank:
    """Return tracks whose errors lean in all directions, and some of which are candidates."""
    generator = np.random.default_rng(2)
    bank = bank_of(generator.uniform(-2000.0, 2000.0, (count, 2)).tolist())
    root = generator.normal(size=(count, 1, 4, 4)) * np.array([60.0, 40.0, 2.0, 3.0])[:, None]
    return replace(
        bank,
        mean=bank.mean + generator.normal(0.0, [0.0, 0.0, 5.0, 5.0], (count, 1, 4)),
        covariance=root @ np.swapaxes(root, -1, -2),
        confirmed=generator.random(count) < 0.5,
    )


def leaning_contacts(count: int) -> PlacedContacts:
    """Return contacts with errors and delays of their own."""
    generator = np.random.default_rng(3)
    contacts = contacts_at(generator.uniform(-2000.0, 2000.0, (count, 2)).tolist())
    root = generator.normal(0.0, 15.0, (count, 2, 2))
    covariance = root @ np.swapaxes(root, -1, -2) + np.eye(2)
    return replace(contacts, covariance=covariance, delay=generator.uniform(0.0, 3.0, count))


def moved_pairs_by_the_letter(bank: TrackBank, contacts: PlacedContacts) -> list[tuple[int, int]]:
    """Return the pairs within the gates, each pair looked at by itself."""
    expected = []
    for track in range(len(bank)):
        mean, covariance = bank.mean[track, 0], bank.covariance[track, 0]
        for contact, delay in enumerate(contacts.delay):
            delayed = np.hstack([np.eye(2), delay * np.eye(2)])
            innovation = contacts.position[contact] - delayed @ mean
            spread = delayed @ covariance @ delayed.T + contacts.covariance[contact]
            if innovation @ np.linalg.solve(spread, innovation) < 16.0:
                expected.append((track, contact))
    return expected


@pytest.mark.parametrize("at_once", [0, 100_000])
@pytest.mark.parametrize("portion", [1, 50, 500_000])
def test_gates_move_with_the_target_until_the_reflection(
    at_once: int, portion: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Against each pair by itself, whatever the portions that bound the memory."""
    monkeypatch.setattr(pair_search, "COMPARED_AT_ONCE", at_once)
    monkeypatch.setattr(pair_search, "BOXED_PER_PORTION", portion)
    bank, contacts = moving_bank(40), leaning_contacts(150)
    sensor = SensorGeometry(np.zeros(2), 80.0, 0.05, 1500.0)
    pairs = find_pairs(bank, predict_gates(bank, sensor), contacts)
    expected = moved_pairs_by_the_letter(bank, contacts)
    assert len(expected) > 40
    found = list(zip(pairs.track.tolist(), pairs.contact.tolist(), strict=True))
    assert sorted(found) == expected
    assert pairs.track.tolist() == sorted(pairs.track.tolist())


def test_of_a_crowd_the_nearest_are_kept_and_only_those_are_pairs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    crowd = contacts_at([[1000.0 + 0.5 * step, 2000.0] for step in range(100)])
    bank = bank_of([[1000.0, 2000.0]])
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.001, 0.0)
    for at_once in (0, 100_000):
        monkeypatch.setattr(pair_search, "COMPARED_AT_ONCE", at_once)
        pairs = find_pairs(bank, predict_gates(bank, sensor), crowd)
        assert sorted(pairs.contact.tolist()) == list(range(64))


@pytest.mark.parametrize("share_of_strict", [0.0, 0.8, 1.0])
@pytest.mark.parametrize("crowd", [0, 300])
def test_weak_contacts_are_left_out_as_if_all_had_been_looked_at(
    share_of_strict: float, crowd: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the nearest of a crowd, weak ones among them, fill a gate."""
    monkeypatch.setattr(pair_search, "COMPARED_AT_ONCE", 0)
    generator = np.random.default_rng(6)
    bank = moving_bank(60)
    spread_out = generator.uniform(-2000.0, 2000.0, (2000, 2))
    crowded = bank.mean[0, 0, :2] + generator.normal(0.0, 30.0, (crowd, 2))
    contacts = contacts_at(np.vstack([spread_out, crowded]).tolist())
    amplitudes = generator.exponential(size=len(contacts.distance)) + 1.0
    amplitudes[generator.random(len(amplitudes)) < 0.01] = np.nan
    thresholds = np.where(generator.random(len(bank)) < share_of_strict, 5.0, 2.0)
    thresholds[0] = 5.0
    gates = predict_gates(bank, SensorGeometry(np.zeros(2), 80.0, 0.05, 1500.0))
    pairs = find_pairs(bank, gates, contacts)
    expected = pairs.keep(~(amplitudes[pairs.contact] < thresholds[pairs.track]))
    found = find_pairs(bank, gates, contacts, amplitudes, thresholds)
    assert len(expected.track) > 10
    assert found.track.tolist() == expected.track.tolist()
    assert found.contact.tolist() == expected.contact.tolist()
    unknown = find_pairs(bank, gates, contacts, amplitudes, np.full(len(bank), np.nan))
    assert unknown.contact.tolist() == pairs.contact.tolist()


def test_without_contacts_or_tracks_there_are_no_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.001, 0.0)
    for at_once in (-1, 100_000):
        monkeypatch.setattr(pair_search, "COMPARED_AT_ONCE", at_once)
        for bank, contacts in (
            (bank_of([[0.0, 0.0]]), contacts_at([])),
            (empty_bank(1), contacts_at([[0.0, 0.0]])),
        ):
            pairs = find_pairs(bank, predict_gates(bank, sensor), contacts)
            assert len(pairs.track) == len(pairs.contact) == 0


def test_a_gate_is_made_for_the_least_precise_contact() -> None:
    contacts = Contacts(
        stamp=1,
        range=np.ones(2),
        azimuth=np.zeros(2),
        amplitude=np.zeros(0),
        range_standard_deviation=np.array([5.0, 7.0]),
        azimuth_standard_deviation=0.01,
        sensor_position=(3.0, 4.0),
    )
    sensor = sensor_geometry(contacts, 1500.0)
    assert sensor.position.tolist() == [3.0, 4.0]
    assert (sensor.range_standard_deviation, sensor.azimuth_standard_deviation) == (7.0, 0.01)
    nothing = replace(contacts, range_standard_deviation=np.zeros(0))
    assert 0.0 < sensor_geometry(nothing, 0.0).range_standard_deviation < 1e-3


def test_pairs_know_where_each_track_begins() -> None:
    pairs = GatePairs(np.array([0, 0, 2, 3, 3]), np.array([5, 6, 5, 1, 2]))
    assert pairs.first_of_each_track().tolist() == [0, 2, 3]
    kept = pairs.keep(np.array([False, True, True, False, True]))
    assert (kept.track.tolist(), kept.contact.tolist()) == ([0, 2, 3], [6, 5, 2])


def test_closed_forms_of_two_dimensions_are_those_of_any() -> None:
    generator = np.random.default_rng(4)
    root = generator.normal(size=(6, 2, 2))
    matrix = root @ np.swapaxes(root, -1, -2)
    area = determinant(matrix)
    assert area == pytest.approx(np.linalg.det(matrix))
    assert inverse(matrix, area) == pytest.approx(np.linalg.inv(matrix))
    flat = np.array([[4.0, 6.0], [6.0, 9.0]])  # singular: kept just above zero
    assert determinant(flat) == pytest.approx(36e-13)


def test_position_and_velocity_errors_add_up_over_a_delay() -> None:
    generator = np.random.default_rng(5)
    root = generator.normal(size=(3, 4, 4))
    covariance = root @ np.swapaxes(root, -1, -2)
    delay = np.array([0.0, 1.5, -2.0])
    moved = delayed_position_covariance(covariance, delay)
    for row in range(3):
        matrix = np.hstack([np.eye(2), delay[row] * np.eye(2)])
        assert moved[row] == pytest.approx(matrix @ covariance[row] @ matrix.T)
