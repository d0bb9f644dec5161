"""LM-IPDA: linear multi-target integrated probabilistic data association.

All tracks are associated at once; each sees the others as moving clutter. With amplitudes, and
over interacting motion modes. For track t, contact j, with the density N of the innovation and the
amplitude likelihood ratio e,

    A_tj = N_tj e_j / P_G,        P_tj = P_D P_G p_t A_tj / sum_l A_tl,
    omega_tj = lambda + sum_{s != t} A_sj P_sj / (1 - P_sj),
    Lambda_t = 1 - P_D P_G + P_D P_G sum_j A_tj / omega_tj,
    beta_tj = P_D P_G A_tj / (omega_tj Lambda_t),    p_t <- Lambda_t p_t / (1 - p_t + Lambda_t p_t).

The cost is linear in the number of pairs, where joint association is exponential.

References
----------
D. Musicki, B. La Scala, "Multi-target tracking in clutter without measurement assignment", IEEE
Trans. AES 44(3), 2008; D. Musicki, R. Evans, S. Stankovic, "Integrated probabilistic data
association", IEEE Trans. AC 39(6), 1994, for the existence recursion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.filtering.few_terms import sum_of_few
from sonar_tracking.records.arrays import FloatArray, IndexArray

LARGEST_CLAIM = 0.999
"""Upper limit of P_tj, so that P / (1 - P) stays finite."""

EXISTENCE_LIMITS = (1e-9, 1.0 - 1e-6)
"""An existence probability of exactly 0 or 1 could never change again."""


@dataclass(frozen=True)
class BankAssociation:
    """Outcome for all tracks.

    Attributes
    ----------
    bank : TrackBank
        With new existence and mode probabilities; means and covariances as predicted.
    weights : ndarray, shape (n_pairs, n_modes)
        Probabilities of association in each mode.
    claimed : ndarray, shape (n_contacts,)
        Probability that any track explains the contact.
    detected : ndarray, shape (n,)
        Probability that one of its contacts is the track's, given that it exists.
    likelihood_ratio : ndarray, shape (n,)
        Lambda: of the ping if the target exists to if it does not, pure numbers.
    """

    bank: TrackBank
    weights: FloatArray
    claimed: FloatArray
    detected: FloatArray
    likelihood_ratio: FloatArray


@dataclass(frozen=True)
class PairEvidence:
    """What is known of each pair.

    Attributes
    ----------
    density : ndarray, shape (n_pairs, n_modes)
        N(nu; 0, S), 1/m^2.
    amplitude_ratio : ndarray, shape (n_pairs,)
        Of target to noise, pure numbers; 1 where not measured.
    clutter_density : ndarray, shape (n_pairs,)
        1/m^2.
    """

    density: FloatArray
    amplitude_ratio: FloatArray
    clutter_density: FloatArray


def associate_integrated(
    bank: TrackBank,
    pairs: GatePairs,
    evidence: PairEvidence,
    detection_probability: FloatArray,
    n_contacts: int,
) -> BankAssociation:
    """Return association, existence and mode probabilities of all tracks.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    pairs : GatePairs
        Contacts in their gates, in the order of the tracks.
    evidence : PairEvidence
        Of the pairs.
    detection_probability : ndarray, shape (n,)
        P_D of each track, probabilities.
    n_contacts : int
        Contacts in the ping.
    """
    n_tracks = len(bank)
    track, contact = pairs.track, pairs.contact
    in_gate = detection_probability * PROBABILITY_IN_GATE
    modal = evidence.density * (evidence.amplitude_ratio / PROBABILITY_IN_GATE)[:, None]
    merged = sum_of_few(bank.mode_probability[track] * modal, axis=1)
    total = sum_by_row(track, merged, n_tracks)
    share = merged / np.maximum(total[track], 1e-300)
    claim = np.minimum(LARGEST_CLAIM, (in_gate * bank.existence)[track] * share)
    strength = merged * claim / (1.0 - claim)
    others = sum_by_row(contact, strength, n_contacts)[contact] - strength
    scaled = in_gate[track][:, None] * modal
    scaled = scaled / (evidence.clutter_density + np.maximum(others, 0.0))[:, None]
    n_modes = bank.mean.shape[1]
    cell = (track[:, None] * n_modes + np.arange(n_modes)).ravel()
    explained = sum_by_row(cell, scaled.ravel(), n_tracks * n_modes).reshape(n_tracks, n_modes)
    ratio = (1.0 - in_gate)[:, None] + explained
    weights = scaled / ratio[track]
    mode_weight = bank.mode_probability * ratio
    likelihood = sum_of_few(mode_weight, axis=1)
    mode_probability = mode_weight / likelihood[:, None]
    existence = update_existence(bank.existence, likelihood)
    beta = sum_of_few(mode_probability[track] * weights, axis=1)
    return BankAssociation(
        bank=replace(bank, existence=existence, mode_probability=mode_probability),
        weights=weights,
        claimed=sum_by_row(contact, beta * existence[track], n_contacts),
        detected=sum_by_row(track, beta, n_tracks),
        likelihood_ratio=likelihood,
    )


def sum_by_row(rows: IndexArray, values: FloatArray, count: int) -> FloatArray:
    """Return the sums of the values that belong to each of ``count`` rows.

    Parameters
    ----------
    rows : ndarray of int, shape (n_values,)
        Row of each value.
    values : ndarray, shape (n_values,)
        In any unit.
    count : int
        Rows.

    Returns
    -------
    ndarray, shape (count,)
        In units of the values.
    """
    return np.asarray(np.bincount(rows, values, count), dtype=np.float64)


def update_existence(existence: FloatArray, likelihood_ratio: FloatArray) -> FloatArray:
    """Return Lambda p / (1 - p + Lambda p), kept off 0 and 1.

    Parameters
    ----------
    existence : ndarray, shape (n,)
        p, probabilities.
    likelihood_ratio : ndarray, shape (n,)
        Lambda, pure numbers.

    Returns
    -------
    ndarray, shape (n,)
        Probabilities.
    """
    weighted = likelihood_ratio * existence
    return (weighted / (1.0 - existence + weighted)).clip(*EXISTENCE_LIMITS)
