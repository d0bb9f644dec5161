"""Protects HPDA for many tracks: who chooses first, what is left, what becomes of existence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.association.hpda import associate_ranked
from sonar_tracking.active.association.lm_ipda import BankAssociation, PairEvidence
from sonar_tracking.active.detection.gate_association import (
    PROBABILITY_IN_GATE,
    GateModel,
    associate_by_rank,
)
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.track_bank import TrackBank
from tests.active.track_scene import bank_of

RATIO = 10.0
VOLUME = np.array([1e4, 2e4, 3e4])
DETECTION = np.array([0.9, 0.8, 0.7])


def associated(
    bank: TrackBank, pairs: GatePairs, density: list[float], amplitudes: list[float]
) -> BankAssociation:
    evidence = PairEvidence(
        np.array(density)[:, None], np.ones(len(density)), 1e-5 * np.arange(1.0, len(density) + 1.0)
    )
    count = len(bank)
    return associate_ranked(
        bank, pairs, evidence, np.array(amplitudes), VOLUME[:count], DETECTION[:count], RATIO
    )


def test_a_lone_track_takes_the_contact_best_by_rank_and_distance() -> None:
    bank = bank_of([[0.0, 0.0]])
    pairs = GatePairs(np.array([0, 0, 0]), np.array([2, 0, 1]))
    density = [1e-4, 2e-4, 3e-4]
    outcome = associated(bank, pairs, density, [8.0, 3.0, 20.0])
    # The clutter density of the gate is the mean of those of its contacts, 2e-5.
    single = associate_by_rank(
        np.array(density), np.array([20.0, 8.0, 3.0]), GateModel(1e4, 2e-5, 0.9), RATIO
    )
    assert outcome.weights[:, 0] == pytest.approx(single.probabilities)
    weighted = 0.8 * single.likelihood_ratio
    assert outcome.bank.existence[0] == pytest.approx(weighted / (0.2 + weighted))
    assert outcome.detected == pytest.approx([np.sum(single.probabilities)])


def test_the_surer_track_chooses_first_and_the_next_one_takes_what_is_left() -> None:
    bank = replace(bank_of([[0.0, 0.0]] * 2), existence=np.array([0.6, 0.9]))
    pairs = GatePairs(np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1]))
    density = [4e-4, 1e-5, 4e-4, 1e-5]
    outcome = associated(bank, pairs, density, [9.0, 2.0])
    assert outcome.weights[2, 0] > 0.5
    assert outcome.weights[[0, 3], 0].tolist() == [0.0, 0.0]
    left = associate_by_rank(np.array([1e-5]), np.array([2.0]), GateModel(1e4, 2e-5, 0.9), RATIO)
    assert outcome.weights[1, 0] == pytest.approx(left.probabilities[0])
    assert outcome.claimed.tolist() == [1.0, 1.0]  # confirmed tracks keep what they take


def test_a_candidate_keeps_a_contact_only_if_it_is_likely_its_own() -> None:
    for density, claimed in [(4e-4, 1.0), (1e-6, 0.0)]:
        bank = replace(bank_of([[0.0, 0.0]]), confirmed=np.array([False]))
        outcome = associated(bank, GatePairs(np.array([0]), np.array([0])), [density], [9.0])
        assert (outcome.weights[0, 0] > 0.5) == bool(claimed)
        assert outcome.claimed.tolist() == [claimed]


def test_a_track_without_contacts_and_one_robbed_of_its_only_one_were_missed() -> None:
    bank = replace(bank_of([[0.0, 0.0]] * 3), existence=np.array([0.9, 0.8, 0.7]))
    pairs = GatePairs(np.array([0, 1]), np.array([0, 0]))
    outcome = associated(bank, pairs, [4e-4, 4e-4], [9.0])
    for row in (1, 2):
        missed = 1.0 - DETECTION[row] * PROBABILITY_IN_GATE
        weighted = missed * bank.existence[row]
        expected = weighted / (1.0 - bank.existence[row] + weighted)
        assert outcome.bank.existence[row] == pytest.approx(expected)
        assert outcome.detected[row] == 0.0
