"""HPDA, highest probability data association: one contact a track, best by rank and distance.

Contacts are used by one track only: confirmed tracks choose first, then candidates by existence
probability. A contact taken by a confirmed track, or by a candidate that is more sure than not, is
not offered again. Tracks that share no contact choose together.

References
----------
Kim, Song (2007), equations 11-19, in Korean; the rule of exclusive use is left open there.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sonar_tracking.active.association.lm_ipda import (
    BankAssociation,
    PairEvidence,
    sum_by_row,
    update_existence,
)
from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.active.detection.ranked_gates import associate_gates_by_rank
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import FloatArray, IndexArray


def associate_ranked(
    bank: TrackBank,
    pairs: GatePairs,
    evidence: PairEvidence,
    amplitudes: FloatArray,
    gate_volume: FloatArray,
    detection_probability: FloatArray,
    signal_to_noise_ratio_linear: float,
) -> BankAssociation:
    """Return the selected contacts and the existence probabilities of all tracks.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks of one motion mode.
    pairs : GatePairs
        Contacts in their gates, in the order of the tracks.
    evidence : PairEvidence
        Of the pairs; the amplitude ratio is not used.
    amplitudes : ndarray, shape (n_contacts,)
        Linear powers; NaN where not measured.
    gate_volume, detection_probability : ndarray, shape (n,)
        V, m^2, and P_D of each track.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.
    """
    likelihood = 1.0 - detection_probability * PROBABILITY_IN_GATE
    weights = np.zeros(len(pairs.track))
    free = np.ones(len(amplitudes), dtype=bool)
    for rows in _rounds_of_choice(bank, pairs):
        own = rows[free[pairs.contact[rows]]]
        if not len(own):
            continue
        left = pairs.keep(own)
        first = left.first_of_each_track()
        track = left.track[first]
        outcome = associate_gates_by_rank(
            first,
            evidence.density[own, 0],
            amplitudes[left.contact],
            evidence.clutter_density[own],
            gate_volume[track],
            detection_probability[track],
            signal_to_noise_ratio_linear,
        )
        selected = own[outcome.selected]
        weights[selected] = outcome.probability
        likelihood[track] = outcome.likelihood_ratio
        takes = bank.confirmed[track] | (outcome.probability > 0.5)
        free[pairs.contact[selected[takes]]] = False
    return BankAssociation(
        bank=replace(bank, existence=update_existence(bank.existence, likelihood)),
        weights=weights[:, None],
        claimed=np.where(free, 0.0, 1.0),
        detected=sum_by_row(pairs.track, weights, len(bank)),
        likelihood_ratio=likelihood,
    )


def _rounds_of_choice(bank: TrackBank, pairs: GatePairs) -> Iterator[IndexArray]:
    """Yield the rows of pairs whose tracks choose together: no two of them want one contact.

    Confirmed tracks choose first, then candidates by existence probability; a track waits for all
    before it that it shares a contact with.
    """
    turn = np.ones(len(bank), dtype=np.intp)
    shared = np.flatnonzero(np.bincount(pairs.contact)[pairs.contact] > 1)
    own = pairs.keep(shared)
    begins = own.first_of_each_track()
    tracks, bounds = own.track[begins], np.append(begins, len(shared)).tolist()
    contacts = own.contact.tolist()
    last_round: dict[int, int] = {}
    turns = [1] * len(tracks)
    for row in np.lexsort((-bank.existence[tracks], ~bank.confirmed[tracks])).tolist():
        wanted = contacts[bounds[row] : bounds[row + 1]]
        mine = 1 + max(last_round.get(contact, 0) for contact in wanted)
        last_round.update(dict.fromkeys(wanted, mine))
        turns[row] = mine
    turn[tracks] = turns
    turn_of_pair = turn[pairs.track]
    by_turn = np.argsort(turn_of_pair, kind="stable")
    ends = np.searchsorted(turn_of_pair[by_turn], np.arange(1, int(turn.max(initial=0)) + 2))
    for begin, end in itertools.pairwise(ends):
        yield by_turn[begin:end]
