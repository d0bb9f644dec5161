"""Rules of association behind one interface, and what follows from each for a tracker."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from sonar_tracking.active.association.hpda import associate_ranked
from sonar_tracking.active.association.lm_ipda import (
    BankAssociation,
    PairEvidence,
    associate_integrated,
)
from sonar_tracking.active.detection.amplitude_order_statistics import load_rank_probabilities
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class GatedPing:
    """Contacts of a ping and the gates they are in.

    Attributes
    ----------
    pairs : GatePairs
        Contacts in the gates of the tracks.
    evidence : PairEvidence
        Of the pairs.
    amplitudes : ndarray, shape (n_contacts,)
        Linear powers; NaN where not measured.
    gate_volume, detection_probability : ndarray, shape (n_tracks,)
        V, m^2, and P_D of each track.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.
    """

    pairs: GatePairs
    evidence: PairEvidence
    amplitudes: FloatArray
    gate_volume: FloatArray
    detection_probability: FloatArray
    signal_to_noise_ratio_linear: float


def _nothing_to_load() -> None:
    """Do nothing; a function with a name, so that trackers can be kept in checkpoints."""


@dataclass(frozen=True)
class AssociationRule:
    """How contacts are given to tracks.

    Attributes
    ----------
    associate : callable
        Takes predicted tracks and a ping, returns the outcome for all tracks.
    has_motion_modes : bool
        Weighs the motion modes of a track, which the one contact of HPDA does not serve.
    weighs_amplitudes : bool
        A contact's amplitude counts in the existence of the candidate it starts.
    has_particles : bool
        Confirmed tracks are followed with particles.
    warm_up : callable
        Loads what the first association needs.
    """

    associate: Callable[[TrackBank, GatedPing], BankAssociation]
    has_motion_modes: bool = False
    weighs_amplitudes: bool = False
    has_particles: bool = False
    warm_up: Callable[[], None] = _nothing_to_load


def _integrated(bank: TrackBank, ping: GatedPing) -> BankAssociation:
    detection, n_contacts = ping.detection_probability, len(ping.amplitudes)
    return associate_integrated(bank, ping.pairs, ping.evidence, detection, n_contacts)


def _ranked(bank: TrackBank, ping: GatedPing) -> BankAssociation:
    return associate_ranked(
        bank,
        ping.pairs,
        ping.evidence,
        ping.amplitudes,
        ping.gate_volume,
        ping.detection_probability,
        ping.signal_to_noise_ratio_linear,
    )


LM_IPDA = AssociationRule(_integrated, has_motion_modes=True, weighs_amplitudes=True)
HPDA = AssociationRule(_ranked, warm_up=load_rank_probabilities)
HPDA_WITH_PARTICLES = replace(HPDA, has_particles=True)
