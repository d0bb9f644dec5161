"""A target moves straight, manoeuvres, or weaves: three modes of each range hypothesis.

The first two differ in their process noise, and interact. Before each prediction each takes over
from the other what may have changed into it meanwhile (Markov chain in continuous time, so that
irregular frames are no matter). Nothing need be decided: while the data do not tell a turn from a
straight path the estimate's covariance holds both, and a turn that is none costs next to nothing.

A target that weaves (:mod:`~sonar_tracking.tma.estimators.weaving`) does so all the time: that mode
has a past of its own and only takes over probability, so that what speaks for or against it adds up
over all that was measured. One that goes straight is soon known to, one that weaves seems to turn
again and again, which is less probable.

The modes of a hypothesis are neighbours in the bank: straight, manoeuvring, weaving.
``compiled_modes``, which is there if a compiler was when the package was installed, gives the bits
of what is here in numpy.

References
----------
Blom and Bar-Shalom, "The interacting multiple model algorithm for systems with Markovian switching
coefficients", IEEE Trans. Automatic Control 33(8), 1988.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, move_straight
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.sensor_frame import DEVIATION
from sonar_tracking.tma.estimators.vertical_prediction import predict_vertical
from sonar_tracking.tma.estimators.weaving import (
    begin_weave,
    deviation_noise,
    deviation_transition,
    move_deviation,
)

COMPILED = compiled_module("tma.estimators.compiled_modes")

MODES = 3
"""Of motion: straight, manoeuvring, weaving."""

STRAIGHT, MANOEUVRING, WEAVING = 0, 1, 2

MIXED = 2
"""The first two interact."""


def with_modes(bank: HypothesisBank, configuration: RangeBankConfiguration) -> HypothesisBank:
    """Return a bank in which each component has become three, the deviation added to its states.

    Parameters
    ----------
    bank : HypothesisBank
        Without modes.
    configuration : RangeBankConfiguration
        How often targets manoeuvre and weave.
    """
    interval, duration = configuration.manoeuvre_interval, configuration.manoeuvre_duration
    weaving = configuration.weave_probability
    share = np.array([interval, duration]) / (interval + duration)
    with np.errstate(divide="ignore"):
        share = np.log(np.append((1.0 - weaving) * share, weaving))
    states = [(0, 0)] * (bank.mean.ndim - 1) + [(0, DEVIATION)]
    mean = np.repeat(np.pad(bank.mean, states), MODES, axis=-2)
    covariance = np.pad(bank.covariance, [*states[:-1], (0, DEVIATION), (0, DEVIATION)])
    covariance = np.repeat(covariance, MODES, axis=-3)
    begin_weave(covariance[..., WEAVING::MODES, :, :], configuration.weave)
    log_weight = (bank.log_weight[..., None] + share).reshape(*bank.log_weight.shape[:-1], -1)
    return HypothesisBank(mean, covariance, log_weight, bank.known)


def predict_modes(
    bank: HypothesisBank, elapsed: FloatArray, configuration: RangeBankConfiguration
) -> HypothesisBank:
    """Return the bank after its modes have had time to change into each other, and have moved.

    Parameters
    ----------
    bank : HypothesisBank
        Every component a batch entry of its own, shape (n_components, 1).
    elapsed : ndarray, shape (n_components,)
        Time since the last measurement of each component, s.
    configuration : RangeBankConfiguration
        How targets move, and how often they manoeuvre and weave.
    """
    bank = mix_modes(bank, elapsed, configuration)
    _move(bank, elapsed[::MODES], configuration)
    if not bank.vertical:
        return bank
    moved = predict_vertical(bank.mean, bank.covariance, elapsed[:, None], bank.height)
    return replace(bank, mean=moved[0], covariance=moved[1])


def _move(bank: HypothesisBank, step: FloatArray, configuration: RangeBankConfiguration) -> None:
    """Move each mode for so many seconds, shape (n_hypotheses,), in place."""
    straight, manoeuvring = configuration.acceleration, configuration.manoeuvre_acceleration
    density = np.array([straight, manoeuvring]) ** 2
    if COMPILED is not None:
        weave, step = configuration.weave, np.ascontiguousarray(step, dtype=float)
        change = np.ascontiguousarray(deviation_transition(step, weave))
        noise = np.ascontiguousarray(deviation_noise(step, weave))
        shape = len(step), bank.mean.shape[-1]
        COMPILED.move(bank.mean, bank.covariance, step, change, noise, tuple(density), shape)
        return
    mean, covariance = _of_modes(bank)
    states = mean.shape[-1] - DEVIATION
    turning = mean[:, :MIXED, :states], covariance[:, :MIXED, :states, :states]
    move_straight(*turning, step[:, None], density)
    weaving = mean[:, WEAVING], covariance[:, WEAVING]
    move_straight(*weaving, step, density[STRAIGHT])
    move_deviation(*weaving, step, configuration.weave)


def mix_modes(
    bank: HypothesisBank, elapsed: FloatArray, configuration: RangeBankConfiguration
) -> HypothesisBank:
    """Return the bank after the modes have had time to change into each other.

    Parameters
    ----------
    bank : HypothesisBank
        Every component a batch entry of its own, shape (n_components, 1).
    elapsed : ndarray, shape (n_components,)
        Time since the last measurement of each component, s.
    configuration : RangeBankConfiguration
        How often targets manoeuvre and weave.
    """
    interval, duration = configuration.manoeuvre_interval, configuration.manoeuvre_duration
    before = bank.log_weight.reshape(-1, MODES)
    joint = before[:, :MIXED, None] + _log_transition(elapsed[::MODES], interval, duration)
    after = np.logaddexp(joint[:, 0], joint[:, 1])
    # Share of what comes from the other mode in each.
    other = np.stack(
        [np.exp(joint[:, 1, 0] - after[:, 0]), np.exp(joint[:, 0, 1] - after[:, 1])], 1
    )
    weight = _exchanged(after, before[:, WEAVING], elapsed[::MODES], configuration)
    bank = replace(
        bank,
        mean=np.array(bank.mean, dtype=float, order="C"),
        covariance=np.array(bank.covariance, dtype=float, order="C"),
        log_weight=weight.reshape(bank.log_weight.shape),
    )
    if COMPILED is None:
        _mix(bank, other)
    else:
        shape = len(other), bank.mean.shape[-1]
        COMPILED.mix(bank.mean, bank.covariance, other, shape)
    return bank


def _mix(bank: HypothesisBank, other: FloatArray) -> None:
    """Let the first two modes take over their shares of each other, in place."""
    means, covariances = _of_modes(bank)
    states = means.shape[-1] - DEVIATION
    mean, covariance = means[:, :MIXED, :states], covariances[:, :MIXED, :states, :states]
    apart = mean[:, 1] - mean[:, 0]
    swapped = covariance[:, ::-1] - covariance
    swapped += (1.0 - other)[..., None, None] * (apart[:, None, :, None] * apart[:, None, None, :])
    covariance += other[..., None, None] * swapped
    mean += other[..., None] * (mean[:, ::-1] - mean)


def _of_modes(bank: HypothesisBank) -> tuple[FloatArray, FloatArray]:
    """Return views of mean and covariance, shapes (n_hypotheses, MODES, ...)."""
    size = bank.mean.shape[-1]
    covariance = bank.covariance.reshape(-1, MODES, size, size)
    return bank.mean.reshape(-1, MODES, size), covariance


def _exchanged(
    mixed: FloatArray,
    weaving: FloatArray,
    elapsed: FloatArray,
    configuration: RangeBankConfiguration,
) -> FloatArray:
    """Return the log weights of all modes after targets have begun, or ceased, to weave."""
    share = configuration.weave_probability
    settled = -np.expm1(-elapsed / configuration.manoeuvre_interval)
    total = np.logaddexp(mixed[:, 0], mixed[:, 1])
    with np.errstate(divide="ignore"):
        begins, ceases = np.log(settled * share), np.log(settled * (1.0 - share))
        stays, goes_on = np.log1p(-settled * share), np.log1p(-settled * (1.0 - share))
    left = np.logaddexp(total + stays, weaving + ceases) - total
    weaves = np.logaddexp(weaving + goes_on, total + begins)
    return np.concatenate([mixed + left[:, None], weaves[:, None]], axis=1)


def _log_transition(elapsed: FloatArray, interval: float, duration: float) -> FloatArray:
    """Return the log of the probability of changing from one mode (row) to another (column)."""
    settled = -np.expm1(-elapsed * (1.0 / interval + 1.0 / duration))
    begins = settled * duration / (interval + duration)
    ends = settled * interval / (interval + duration)
    with np.errstate(divide="ignore"):
        table = np.log(np.stack([1.0 - begins, begins, ends, 1.0 - ends], axis=-1))
    return np.asarray(table.reshape(-1, MIXED, MIXED))
