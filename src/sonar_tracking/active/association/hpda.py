"""HPDA, highest probability data association: one contact a track, best by rank and distance.

Contacts are used by one track only: confirmed tracks choose first, then candidates by existence
probability. A contact taken by a confirmed track, or by a candidate that is more sure than not, is
not offered again.

References
----------
Kim, Song (2007), equations 11-19, in Korean; the rule of exclusive use is left open there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.active.association.lm_ipda import (
    BankAssociation,
    PairEvidence,
    sum_by_row,
    update_existence,
)
from sonar_tracking.active.detection.gate_association import (
    PROBABILITY_IN_GATE,
    GateModel,
    associate_by_rank,
)
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
    first = np.searchsorted(pairs.track, np.arange(len(bank) + 1))
    for row in _in_order_of_choice(bank, np.flatnonzero(np.diff(first))):
        own = np.arange(first[row], first[row + 1])
        own = own[free[pairs.contact[own]]]
        if not len(own):
            continue
        density = float(np.mean(evidence.clutter_density[own]))
        model = GateModel(gate_volume[row], density, detection_probability[row])
        outcome = associate_by_rank(
            evidence.density[own, 0],
            amplitudes[pairs.contact[own]],
            model,
            signal_to_noise_ratio_linear,
        )
        selected = int(np.argmax(outcome.probabilities))
        weights[own[selected]] = outcome.probabilities[selected]
        likelihood[row] = outcome.likelihood_ratio
        if bank.confirmed[row] or outcome.probabilities[selected] > 0.5:
            free[pairs.contact[own[selected]]] = False
    return BankAssociation(
        bank=replace(bank, existence=update_existence(bank.existence, likelihood)),
        weights=weights[:, None],
        claimed=np.where(free, 0.0, 1.0),
        detected=sum_by_row(pairs.track, weights, len(bank)),
    )


def _in_order_of_choice(bank: TrackBank, rows: IndexArray) -> IndexArray:
    """Return the tracks, confirmed ones first, then by existence probability."""
    order = np.lexsort((-bank.existence[rows], ~bank.confirmed[rows]))
    return np.asarray(rows[order])
