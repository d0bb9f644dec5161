"""Which contact in a gate is the target's? Three rules for one track.

PDA weighs all contacts by distance. With amplitudes each weight is multiplied by the likelihood
ratio of the amplitude. HPDA takes one contact: the one of greatest probability by rank and
distance. All return probabilities of association, zero for contacts that are not used.

References
----------
Bar-Shalom, Fortmann (1988), section 6.4; Jung, Shin (2002), equations 7-15; Kim, Song (2007),
equations 11-19.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.detection.amplitude_order_statistics import rank_probabilities_of
from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.records.arrays import FloatArray

PROBABILITY_IN_GATE = 1.0 - np.exp(-0.5 * GATE_SIZE**2)
"""P_G of a planar gate."""


@dataclass(frozen=True)
class GateModel:
    """What is known of a gate before the contacts in it are looked at.

    Attributes
    ----------
    volume : float
        V, m^2.
    clutter_density : float
        Contacts per m^2 that are no target's; positive.
    detection_probability : float
        P_D of the target at the threshold in force.
    """

    volume: float
    clutter_density: float
    detection_probability: float


@dataclass(frozen=True)
class GateAssociation:
    """Outcome of one rule.

    Attributes
    ----------
    probabilities : ndarray, shape (m,)
        beta of each contact in the gate.
    likelihood_ratio : float
        Of "there is a target" to "there is none", given the contacts.
    """

    probabilities: FloatArray
    likelihood_ratio: float


def amplitude_likelihood_ratio(
    amplitudes: FloatArray,
    threshold: FloatArray | float,
    signal_to_noise_ratio_linear: float | FloatArray,
) -> FloatArray:
    """Return e(a) = exp[(a - tau) SNR / (1 + SNR)] / (1 + SNR), target against noise above tau.

    Parameters
    ----------
    amplitudes : ndarray, shape (m,)
        Linear powers, noise mean 1.
    threshold : float or ndarray, shape (m,)
        tau, linear.
    signal_to_noise_ratio_linear : float or ndarray, shape (n, 1)
        SNR as a power ratio, not in dB; several of them give a row each.

    Returns
    -------
    ndarray, shape (m,) or (n, m)
        Pure numbers.
    """
    ratio = signal_to_noise_ratio_linear
    excess = ((amplitudes - threshold) * ratio / (1.0 + ratio)).clip(0.0, 300.0)
    return np.asarray(np.exp(excess) / (1.0 + ratio))


def associate_by_distance(
    densities: FloatArray, model: GateModel, amplitude_ratios: FloatArray | float = 1.0
) -> GateAssociation:
    """Return the PDA probabilities, with amplitudes if their likelihood ratios are given.

    Parameters
    ----------
    densities : ndarray, shape (m,)
        N(nu; 0, S) of each contact in the gate, 1/m^2.
    model : GateModel
        The gate.
    amplitude_ratios : ndarray, shape (m,), optional
        From :func:`amplitude_likelihood_ratio`.
    """
    detection = model.detection_probability
    weights = detection * densities * amplitude_ratios / model.clutter_density
    ratio = 1.0 - detection * PROBABILITY_IN_GATE + float(np.sum(weights))
    return GateAssociation(weights / ratio, ratio)


def associate_by_rank(
    densities: FloatArray,
    amplitudes: FloatArray,
    model: GateModel,
    signal_to_noise_ratio_linear: float,
) -> GateAssociation:
    """Return the HPDA probabilities: all zero but that of the selected contact.

    The Poisson numbers of clutter points enter only as mu_F(m - 1) / mu_F(m) = m / (lambda V).
    The published likelihood ratio takes the rank of the selected contact as if it had been fixed
    beforehand. That favours targets in gates with more than about one clutter point (its mean
    without a target, which should be 1, is 1.2 at five), and is harmless in sparse ones.

    Parameters
    ----------
    densities : ndarray, shape (m,)
        N(nu; 0, S) of each contact in the gate, 1/m^2.
    amplitudes : ndarray, shape (m,)
        Linear powers; NaN where not measured.
    model : GateModel
        The gate.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.
    """
    count = len(densities)
    in_gate = model.detection_probability * PROBABILITY_IN_GATE
    if count == 0:
        return GateAssociation(np.zeros(0), 1.0 - in_gate)
    poisson_ratio = count / (model.clutter_density * model.volume)
    target_ranked = (
        in_gate * poisson_ratio * rank_probabilities_of(amplitudes, signal_to_noise_ratio_linear)
    )
    clutter_ranked = in_gate * poisson_ratio + (1.0 - in_gate) - target_ranked
    from_target = densities / PROBABILITY_IN_GATE * target_ranked
    from_clutter = clutter_ranked / model.volume
    probability = from_target / (from_target + from_clutter)
    selected = int(np.argmax(probability))
    kept = np.zeros(count)
    kept[selected] = probability[selected]
    # Both terms relative to m contacts that all are clutter, each of density 1 / V.
    ratio = clutter_ranked[selected] + model.volume * from_target[selected]
    return GateAssociation(kept, float(ratio))
