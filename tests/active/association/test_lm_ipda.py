"""Protects: integrated association is PDA for one track, and counts neighbours as clutter."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.association.lm_ipda import (
    PairEvidence,
    associate_integrated,
    sum_by_row,
    update_existence,
)
from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.detection.gate_association import (
    PROBABILITY_IN_GATE,
    GateModel,
    associate_by_distance,
)
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    SensorGeometry,
    predict_gates,
)
from sonar_tracking.active.tracks.pair_search import find_pairs
from sonar_tracking.active.tracks.pair_updates import update_pairs
from sonar_tracking.active.tracks.track_bank import TrackBank
from tests.active.track_scene import bank_of, contacts_at


def associate(bank: TrackBank, contacts: PlacedContacts, density: float = 1e-7) -> tuple:
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.001, 0.0)
    pairs = find_pairs(bank, predict_gates(bank, sensor), contacts)
    updates = update_pairs(bank, contacts, pairs)
    count = len(pairs.track)
    evidence = PairEvidence(updates.density, np.ones(count), np.full(count, density))
    outcome = associate_integrated(
        bank, pairs, evidence, np.full(len(bank), 0.9), len(contacts.distance)
    )
    return pairs, updates, outcome


def test_a_lone_track_is_associated_as_by_pda() -> None:
    bank = bank_of([[1000.0, 2000.0]])
    pairs, updates, outcome = associate(bank, contacts_at([[1010.0, 2005.0], [990.0, 1950.0]]))
    assert len(pairs.track) == 2
    model = GateModel(1.0, 1e-7, 0.9)
    single = associate_by_distance(updates.density[:, 0], model)
    assert outcome.weights[:, 0] == pytest.approx(single.probabilities, rel=1e-9)


def test_a_contact_of_a_neighbour_is_worth_less() -> None:
    contacts = contacts_at([[1000.0, 2000.0]])
    _, _, alone = associate(bank_of([[1010.0, 2000.0]]), contacts)
    _, _, both = associate(bank_of([[1010.0, 2000.0], [1000.0, 2000.0]]), contacts)
    assert both.weights[0, 0] < alone.weights[0, 0]
    assert both.bank.existence[0] < alone.bank.existence[0]


def test_a_missed_track_loses_existence() -> None:
    bank = bank_of([[1000.0, 2000.0]])
    _, _, outcome = associate(bank, contacts_at([[-9000.0, 0.0]]))
    ratio = 1.0 - 0.9 * PROBABILITY_IN_GATE
    assert outcome.bank.existence[0] == pytest.approx(0.8 * ratio / (0.2 + 0.8 * ratio))
    assert np.all(outcome.claimed == 0.0)


def three_targets() -> tuple[TrackBank, GatePairs, PairEvidence, np.ndarray]:
    """Return two tracks of three modes that share contacts, and one that has none."""
    generator = np.random.default_rng(1)
    probability = generator.random((3, 3)) + 0.1
    bank = replace(
        bank_of([[0.0, 0.0], [60.0, 0.0], [900.0, 0.0]], n_modes=3),
        existence=np.array([0.95, 0.4, 0.7]),
        mode_probability=probability / np.sum(probability, axis=1, keepdims=True),
    )
    pairs = GatePairs(np.array([0, 0, 1, 1]), np.array([0, 1, 1, 2]))
    density = generator.uniform(1e-5, 4e-4, (4, 3))
    evidence = PairEvidence(
        density, np.array([3.0, 0.5, 1.5, 0.2]), np.array([1e-5, 2e-5, 2e-5, 3e-5])
    )
    return bank, pairs, evidence, np.array([0.9, 0.8, 0.7])


def test_modes_weights_and_existence_are_those_of_a_plain_coding() -> None:
    bank, pairs, evidence, detection = three_targets()
    outcome = associate_integrated(bank, pairs, evidence, detection, 3)
    in_gate = detection * PROBABILITY_IN_GATE
    likelihoods = evidence.density * evidence.amplitude_ratio[:, None] / PROBABILITY_IN_GATE
    merged = np.sum(bank.mode_probability[pairs.track] * likelihoods, axis=1)
    odds = np.zeros(4)
    for row, track in enumerate(pairs.track.tolist()):
        total = np.sum(merged[pairs.track == track])
        prior = in_gate[track] * bank.existence[track] * merged[row] / total
        odds[row] = merged[row] * prior / (1.0 - prior)
    for track in range(3):
        ratio = np.full(3, 1.0 - in_gate[track])
        own = np.flatnonzero(pairs.track == track).tolist()
        explained = {}
        for row in own:
            same = (pairs.contact == pairs.contact[row]) & (pairs.track != track)
            clutter = evidence.clutter_density[row] + np.sum(odds[same])
            explained[row] = in_gate[track] * likelihoods[row] / clutter
            ratio += explained[row]
        likelihood = bank.mode_probability[track] @ ratio
        weighted = likelihood * bank.existence[track]
        existence = weighted / (1.0 - bank.existence[track] + weighted)
        probability = bank.mode_probability[track] * ratio / likelihood
        assert outcome.bank.existence[track] == pytest.approx(existence)
        assert outcome.bank.mode_probability[track] == pytest.approx(probability)
        for row in own:
            assert outcome.weights[row] == pytest.approx(explained[row] / ratio)
        detected = sum(probability @ (explained[row] / ratio) for row in own)
        assert outcome.detected[track] == pytest.approx(detected)


def test_a_claim_is_bounded_so_that_a_rival_can_still_be_heard() -> None:
    """A certain track that has but one contact claims 0.999 of it at most."""
    bank = replace(bank_of([[0.0, 0.0], [0.0, 0.0]]), existence=np.array([1.0, 0.5]))
    pairs = GatePairs(np.array([0, 1]), np.array([0, 0]))
    evidence = PairEvidence(np.full((2, 1), 1e-4), np.ones(2), np.full(2, 1e-6))
    outcome = associate_integrated(bank, pairs, evidence, np.array([1.0, 1.0]), 1)
    merged = 1e-4 / PROBABILITY_IN_GATE
    explained = PROBABILITY_IN_GATE * merged / (1e-6 + merged * 0.999 / 0.001)
    assert outcome.weights[1, 0] == pytest.approx(
        explained / (1.0 - PROBABILITY_IN_GATE + explained)
    )


def test_existence_is_updated_by_bayes_and_never_certain() -> None:
    existence = np.array([0.5, 0.8, 1e-12, 1.0])
    updated = update_existence(existence, np.array([3.0, 0.25, 1.0, 1.0]))
    assert updated == pytest.approx([0.75, 0.5, 1e-9, 1.0 - 1e-6], rel=1e-12)


def test_sums_by_row() -> None:
    sums = sum_by_row(np.array([2, 0, 2]), np.array([1.0, 5.0, 3.0]), 4)
    assert sums.tolist() == [5.0, 0.0, 4.0, 0.0]
