"""A target moves straight, manoeuvres, wanders, or weaves: the modes of each range hypothesis.

The first two differ in their process noise, and interact. Before each prediction each takes over
from the other what may have changed into it meanwhile (Markov chain in continuous time, so that
irregular frames are no matter). Nothing need be decided: while the data do not tell a turn from a
straight path the estimate's covariance holds both, and a turn that is none costs next to nothing.

A target that weaves (:mod:`~sonar_tracking.tma.estimators.weaving`) does so all the time, and so
does one whose velocity wanders: these modes have pasts of their own and only take over probability,
so that what speaks for or against them adds up over all that was measured. One that goes straight
is soon known to, one that weaves seems to turn again and again, which is less probable.

The modes of a hypothesis are neighbours in the bank: straight, manoeuvring, wandering, and weaving
with a short, a middle and a long period. Where all modes are the same there is one of them, without
the states of a deviation.
``compiled_modes``, which is there if a compiler was when the package was installed, gives the bits
of what is here in numpy.

References
----------
Blom and Bar-Shalom, "The interacting multiple model algorithm for systems with Markovian switching
coefficients", IEEE Trans. Automatic Control 33(8), 1988.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    move_straight,
    predict_bank,
)
from sonar_tracking.tma.estimators.range_bank_configuration import (
    WEAVE_PERIODS,
    RangeBankConfiguration,
)
from sonar_tracking.tma.estimators.sensor_frame import DEVIATION
from sonar_tracking.tma.estimators.vertical_prediction import predict_vertical
from sonar_tracking.tma.estimators.weaving import (
    begin_weave,
    deviation_noise,
    deviation_transition,
    move_deviation,
)

COMPILED = compiled_module("tma.estimators.compiled_modes")

STRAIGHT, MANOEUVRING, WANDERING, WEAVING = 0, 1, 2, 3
"""The last is the first of those that weave."""

WEAVES = len(WEAVE_PERIODS)
MODES = WEAVING + WEAVES
"""Of motion."""

MIXED = 2
"""The first two interact."""

TRANSITION, DEVIATES, DEVIATION_NOISE, EXCHANGE = (
    slice(0, 4),
    slice(4, 4 + 4 * WEAVES),
    slice(4 + 4 * WEAVES, 4 + 8 * WEAVES),
    slice(4 + 8 * WEAVES, None),
)
"""Places in what a time does to a hypothesis."""


def modes_of(bank: HypothesisBank) -> int:
    """Return how many modes of motion each hypothesis of a bank has: all, or one."""
    return MODES if bank.mean.shape[-1] - bank.height >= DEVIATION else 1


def with_modes(bank: HypothesisBank, configuration: RangeBankConfiguration) -> HypothesisBank:
    """Return a bank in which each component has become several, the deviation added to its states.

    Where a target moves in one way only the bank is as it was.

    Parameters
    ----------
    bank : HypothesisBank
        Without modes.
    configuration : RangeBankConfiguration
        How often targets manoeuvre, wander and weave.
    """
    if configuration.moves_one_way:
        return bank
    interval, duration = configuration.manoeuvre_interval, configuration.manoeuvre_duration
    lasting = configuration.lasting_shares
    share = np.array([interval, duration]) / (interval + duration)
    with np.errstate(divide="ignore"):
        share = np.log(np.append((1.0 - lasting.sum()) * share, lasting))
    states = [(0, 0)] * (bank.mean.ndim - 1) + [(0, DEVIATION)]
    mean = np.repeat(np.pad(bank.mean, states), MODES, axis=-2)
    covariance = np.pad(bank.covariance, [*states[:-1], (0, DEVIATION), (0, DEVIATION)])
    covariance = np.repeat(covariance, MODES, axis=-3)
    for mode, weave in enumerate(configuration.weaves, start=WEAVING):
        begin_weave(covariance[..., mode::MODES, :, :], weave)
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
        How targets move, and how often they manoeuvre, wander and weave.
    """
    if modes_of(bank) == 1:
        return predict_bank(bank, elapsed, np.array(configuration.acceleration))
    step, change = _changes(elapsed[::MODES], configuration)
    bank = _mixed(bank, change)
    _move(bank, step, change, configuration)
    if not bank.vertical:
        return bank
    moved = predict_vertical(bank.mean, bank.covariance, elapsed[:, None], bank.height)
    return replace(bank, mean=moved[0], covariance=moved[1])


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
        How often targets manoeuvre, wander and weave.
    """
    return _mixed(bank, _changes(elapsed[::MODES], configuration)[1])


def _changes(
    elapsed: FloatArray, configuration: RangeBankConfiguration
) -> tuple[FloatArray, FloatArray]:
    """Return times of shape (n_hypotheses,), s, and what they do, shape (n_hypotheses, 34).

    Where all are the same both have one entry.
    """
    first = elapsed[:1]
    if (elapsed == first).all():
        return first, _change(float(first[0]), configuration)[None]
    times, place = np.unique(elapsed, return_inverse=True)
    return elapsed, np.array([_change(time, configuration) for time in times.tolist()])[place]


@lru_cache(maxsize=1024)
def _change(elapsed: float, configuration: RangeBankConfiguration) -> FloatArray:
    """Return what a time, s, does to a hypothesis: most frames follow each other alike.

    Logs of the transition between the first two modes (4 numbers), transitions and noise of the
    deviations (4 each), logs of what stays as it is, and of what changes into which mode.
    """
    time = np.array([elapsed])
    interval, duration = configuration.manoeuvre_interval, configuration.manoeuvre_duration
    change = np.concatenate(
        [
            _log_transition(time, interval, duration).ravel(),
            *(deviation_transition(time, weave).ravel() for weave in configuration.weaves),
            *(deviation_noise(time, weave).ravel() for weave in configuration.weaves),
            _log_exchange(time, configuration).ravel(),
        ]
    )
    change.setflags(write=False)
    return change


def _move(
    bank: HypothesisBank,
    step: FloatArray,
    change: FloatArray,
    configuration: RangeBankConfiguration,
) -> None:
    """Move each mode for so many seconds, shape (n_hypotheses,) or (1,), in place."""
    density = tuple(each * each for each in configuration.accelerations)
    if COMPILED is not None:
        shape = len(bank.mean) // MODES, bank.mean.shape[-1]
        each = shape[0] // len(step)
        parts = step, change[:, DEVIATES], change[:, DEVIATION_NOISE]
        COMPILED.move(
            *(bank.mean, bank.covariance, *(one.repeat(each, axis=0) for one in parts)),
            *(density, shape),
        )
        return
    mean, covariance = _of_modes(bank)
    states = mean.shape[-1] - DEVIATION
    turning = mean[:, :WEAVING, :states], covariance[:, :WEAVING, :states, :states]
    move_straight(*turning, step[:, None], np.array(density))
    for mode, weave in enumerate(configuration.weaves, start=WEAVING):
        weaving = mean[:, mode], covariance[:, mode]
        move_straight(*weaving, step, np.array(density[STRAIGHT]))
        move_deviation(*weaving, step, weave)


def _mixed(bank: HypothesisBank, change: FloatArray) -> HypothesisBank:
    """Return a copy of the bank, its modes changed into each other."""
    before = bank.log_weight.reshape(-1, MODES)
    joint = before[:, :MIXED, None] + change[:, TRANSITION].reshape(-1, MIXED, MIXED)
    after = np.logaddexp(joint[:, 0], joint[:, 1])
    # Share of what comes from the other mode in each.
    other = np.exp(joint[:, ::-1].diagonal(axis1=1, axis2=2) - after)
    weight = _exchanged(after, before[:, MIXED:], change[:, EXCHANGE])
    bank = HypothesisBank(
        np.array(bank.mean, dtype=float, order="C"),
        np.array(bank.covariance, dtype=float, order="C"),
        weight.reshape(bank.log_weight.shape),
        bank.known,
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


def weaving_modes(n_components: int) -> BoolArray:
    """Return which components of a bank weave, shape (n_components,)."""
    return np.arange(n_components) % MODES >= WEAVING


def _of_modes(bank: HypothesisBank) -> tuple[FloatArray, FloatArray]:
    """Return views of mean and covariance, shapes (n_hypotheses, MODES, ...)."""
    size = bank.mean.shape[-1]
    covariance = bank.covariance.reshape(-1, MODES, size, size)
    return bank.mean.reshape(-1, MODES, size), covariance


def _exchanged(mixed: FloatArray, lasting: FloatArray, logs: FloatArray) -> FloatArray:
    """Return the log weights of all modes after targets have changed how they move at all."""
    begins, stays = logs[:, 1:], logs[:, :1]
    weight = np.empty((len(mixed), MODES))
    total = np.logaddexp(mixed[:, 0], mixed[:, 1])
    every = np.logaddexp.reduce(np.column_stack([total, lasting]), axis=1)
    left = np.logaddexp(total + stays[:, 0], every + begins[:, 0]) - total
    np.add(mixed, left[:, None], out=weight[:, :MIXED])
    np.logaddexp(lasting + stays, every[:, None] + begins[:, 1:], out=weight[:, MIXED:])
    return weight


def _log_exchange(elapsed: FloatArray, configuration: RangeBankConfiguration) -> FloatArray:
    """Return the logs of the probabilities to stay, to turn, to wander, to weave, (n, 6)."""
    lasting = configuration.lasting_shares
    share = np.concatenate([[1.0 - lasting.sum()], lasting])
    settled = -np.expm1(-elapsed / configuration.manoeuvre_interval)
    with np.errstate(divide="ignore"):
        return np.column_stack([np.log1p(-settled), np.log(settled[:, None] * share)])


def _log_transition(elapsed: FloatArray, interval: float, duration: float) -> FloatArray:
    """Return the log of the probability of changing from one mode (row) to another (column)."""
    settled = -np.expm1(-elapsed * (1.0 / interval + 1.0 / duration))
    begins = settled * duration / (interval + duration)
    ends = settled * interval / (interval + duration)
    with np.errstate(divide="ignore"):
        table = np.log(np.stack([1.0 - begins, begins, ends, 1.0 - ends], axis=-1))
    return np.asarray(table.reshape(-1, MIXED, MIXED))
