"""HPDA in many gates at once: what ``associate_by_rank`` says of each, without a loop over them.

The gates are consecutive stretches of the contacts. None of them is empty.

References
----------
Kim, Song (2007), equations 11-19.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.detection.amplitude_order_statistics import rank_probabilities
from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.records.arrays import FloatArray, IndexArray


@dataclass(frozen=True)
class RankedGates:
    """Outcome for every gate.

    Attributes
    ----------
    selected : ndarray of int, shape (n_gates,)
        Row of the contact that each of them takes.
    probability : ndarray, shape (n_gates,)
        That this is the target's.
    likelihood_ratio : ndarray, shape (n_gates,)
        Of "there is a target" to "there is none", given the contacts; pure numbers.
    """

    selected: IndexArray
    probability: FloatArray
    likelihood_ratio: FloatArray


def associate_gates_by_rank(
    first: IndexArray,
    densities: FloatArray,
    amplitudes: FloatArray,
    clutter_density: FloatArray,
    volume: FloatArray,
    detection_probability: FloatArray,
    signal_to_noise_ratio_linear: float,
) -> RankedGates:
    """Return the selected contact of each gate.

    Parameters
    ----------
    first : ndarray of int, shape (n_gates,)
        Row at which the contacts of each gate begin.
    densities : ndarray, shape (n,)
        N(nu; 0, S) of each contact in its gate, 1/m^2.
    amplitudes : ndarray, shape (n,)
        Linear powers; NaN where not measured: all ranks in that gate are then equally likely.
    clutter_density : ndarray, shape (n,)
        1/m^2, at each contact; of a gate it is their mean.
    volume, detection_probability : ndarray, shape (n_gates,)
        V, m^2, and P_D of each gate.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.
    """
    counts = np.append(first[1:], len(densities)) - first
    gate = np.arange(len(first)).repeat(counts)
    in_gate = detection_probability * PROBABILITY_IN_GATE
    density = np.add.reduceat(clutter_density, first) / counts
    found = in_gate * (counts / (density * volume))
    ranks = _rank_probabilities(first, counts, gate, amplitudes, signal_to_noise_ratio_linear)
    target_ranked = found[gate] * ranks
    clutter_ranked = (found + (1.0 - in_gate))[gate] - target_ranked
    from_target = densities / PROBABILITY_IN_GATE * target_ranked
    probability = from_target / (from_target + clutter_ranked / volume[gate])
    best = np.maximum.reduceat(probability, first)
    candidates = np.flatnonzero(probability == best[gate])
    selected = candidates[np.searchsorted(gate[candidates], np.arange(len(first)))]
    return RankedGates(
        selected,
        probability[selected],
        clutter_ranked[selected] + volume * from_target[selected],
    )


def _rank_probabilities(
    first: IndexArray,
    counts: IndexArray,
    gate: IndexArray,
    amplitudes: FloatArray,
    signal_to_noise_ratio_linear: float,
) -> FloatArray:
    """Return for each contact the probability that the target has its rank in its gate."""
    strongest_first = np.lexsort((-amplitudes, gate))
    places = np.arange(len(amplitudes)) - first[gate]
    table = np.zeros((int(counts.max()) + 1, int(counts.max())))
    for count in np.unique(counts).tolist():
        table[count, :count] = rank_probabilities(count, signal_to_noise_ratio_linear)
    ranked = np.empty(len(amplitudes))
    ranked[strongest_first] = table[counts[gate], places]
    measured = np.logical_and.reduceat(np.isfinite(amplitudes), first)
    return np.where(measured[gate], ranked, (1.0 / counts)[gate])
