"""Protects: integrated association is PDA for one track, and counts neighbours as clutter."""

import numpy as np
import pytest

from sonar_tracking.active.association.lm_ipda import PairEvidence, associate_integrated
from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.detection.gate_association import (
    PROBABILITY_IN_GATE,
    GateModel,
    associate_by_distance,
)
from sonar_tracking.active.tracks.contact_gating import (
    SensorGeometry,
    find_pairs,
    predict_gates,
)
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
