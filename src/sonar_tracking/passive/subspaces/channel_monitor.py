"""Which elements are bad: silent, much louder than the others, or clipped; these are left out.

Far away sources and ambient noise reach all elements of an array about equally loud. So an element
is silent when it is 30 dB below the median of the elements, and faulty when it is 20 dB above it.
A clipped element has amplitudes that pile up at full scale: they end in a plateau
(:mod:`sonar_tracking.passive.subspaces.amplitude_plateau`), and the ratio E|x|^4 / (E|x|^2)^2, 2
for Gaussian sound and 1 for a constant amplitude, is less than that of the other elements. One that
is also 6 dB louder than they are is saturated, its bearings are those of its own amplifier.

The steering vectors of the remaining elements are as good as before, so that a bad element is left
out with its position. It is used again when it has been good for a while. When more than half of
the elements are bad, all are used: the fault is likely to be elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.passive.subspaces.amplitude_plateau import (
    AmplitudePlateau,
    no_plateau,
    updated_plateaus,
)
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from sonar_tracking.records.bearings import ArraySnapshots

SILENT_RATIO, LOUD_RATIO, _SATURATED_RATIO = 1e-3, 100.0, 4.0
"""Powers over the median of the array."""

_CLIPPED_DIFFERENCE = 0.6
"""Of the amplitude ratio, below the median of the array: four standard deviations of 200 snapshots
of Gaussian sound, which happens by chance once in an hour: the plateau decides."""

_POWER_SNAPSHOTS, _AMPLITUDE_SNAPSHOTS = 50, 200

QUARANTINE_SNAPSHOTS = 1000
"""How long an element must be good to be used again."""

_LEFT_OUT = "It is left out until it has been good for a while."
_USED = "Its data are used as they are."


@dataclass(frozen=True)
class ChannelMonitor:
    """Running statistics of each element, to find the bad ones.

    Attributes
    ----------
    power : ndarray, shape (n_elements,)
        Mean |x|^2 of some fifty snapshots, linear power.
    amplitudes : ndarray, shape (2, n_elements)
        Mean |x|^2 and |x|^4 of some two hundred snapshots, linear power and its square.
    good_for : ndarray of int, shape (n_elements,)
        Snapshots since the element was last found bad.
    plateau : AmplitudePlateau
        How often each is at its largest value.
    n_snapshots : int
        Snapshots seen.
    """

    power: FloatArray
    amplitudes: FloatArray
    good_for: IntArray
    plateau: AmplitudePlateau
    n_snapshots: int = 0

    @property
    def used(self) -> BoolArray:
        """Elements that are not left out, shape (n_elements,)."""
        good = np.asarray(self.good_for >= QUARANTINE_SNAPSHOTS)
        return good if np.count_nonzero(good) > len(good) // 2 else np.ones_like(good)


def updated_monitors(
    monitors: Sequence[ChannelMonitor], blocks: Sequence[ArraySnapshots]
) -> list[tuple[ChannelMonitor, tuple[Notice, ...]]]:
    """Return the monitors of several runs after a block of each, and what is bad in it.

    Parameters
    ----------
    monitors : sequence of ChannelMonitor
        One a run.
    blocks : sequence of ArraySnapshots
        One a run; finite data of all elements. Blocks of one length are looked at in one go.

    Returns
    -------
    list of (ChannelMonitor, tuple of Notice)
        One a run, with a notice for each element that is bad.
    """
    snapshots = [block.data.reshape(-1, block.data.shape[-1]) for block in blocks]
    alike: dict[tuple[object, ...], list[int]] = {}
    for run, (monitor, data) in enumerate(zip(monitors, snapshots, strict=True)):
        alike.setdefault((data.shape, monitor.n_snapshots), []).append(run)
    after: dict[int, tuple[ChannelMonitor, tuple[Notice, ...]]] = {}
    for runs in alike.values():
        own = _updated([monitors[run] for run in runs], np.array([snapshots[run] for run in runs]))
        after.update(zip(runs, own, strict=True))
    return [after[run] for run in range(len(monitors))]


def _updated(
    monitors: Sequence[ChannelMonitor], data: ComplexArray
) -> list[tuple[ChannelMonitor, tuple[Notice, ...]]]:
    """Return monitors that have seen as many snapshots after more, (n_runs, n_new, n_elements)."""
    n_old, n_new = monitors[0].n_snapshots, data.shape[-2]
    squared = data.real**2 + data.imag**2
    moments = np.empty((len(data), 2, data.shape[-1]))
    squared.sum(axis=-2, out=moments[:, 0])
    (squared**2).sum(axis=-2, out=moments[:, 1])
    moments /= n_new
    before = np.array([each.power for each in monitors])
    power = _averaged(before, moments[:, 0], n_old, n_new, _POWER_SNAPSHOTS)
    before = np.array([each.amplitudes for each in monitors])
    amplitudes = _averaged(before, moments, n_old, n_new, _AMPLITUDE_SNAPSHOTS)
    share = _share(n_old, n_new, _AMPLITUDE_SNAPSHOTS)
    plateau = updated_plateaus([each.plateau for each in monitors], data, share)
    seen = n_old + n_new
    silent, loud = moments[:, 0] == 0.0, np.zeros(power.shape, dtype=bool)
    clipped, saturated = loud, loud
    median = _median(power, power > 0.0)
    if seen >= _POWER_SNAPSHOTS:
        silent = silent | (power < SILENT_RATIO * median)
        loud = power > LOUD_RATIO * median
    found = np.array([each.found for each in plateau])
    if seen >= _AMPLITUDE_SNAPSHOTS and found.any():
        clipped = _clipped(amplitudes) & found & ~silent
        saturated = clipped & (power > _SATURATED_RATIO * median)
    good_for = np.array([each.good_for for each in monitors])
    good_for = np.minimum(good_for + n_new, QUARANTINE_SNAPSHOTS)
    good_for = np.where(silent | loud | saturated, 0, good_for)
    bad = (silent | clipped | loud).any(axis=-1)
    updated = []
    for run, own in enumerate(plateau):
        monitor = ChannelMonitor(power[run], amplitudes[run], good_for[run], own, seen)
        notices = list[Notice]()
        if bad[run]:
            used = monitor.used
            notices += [_silent(int(n), used[n]) for n in np.flatnonzero(silent[run])]
            notices += [_clipping(int(n), used[n]) for n in np.flatnonzero(clipped[run])]
            notices += [_loud(int(n), used[n]) for n in np.flatnonzero((loud & ~clipped)[run])]
        updated.append((monitor, tuple(notices)))
    return updated


def new_monitor(n_elements: int) -> ChannelMonitor:
    """Return the monitor of an array of which nothing has been seen: all elements are used."""
    good_for = np.full(n_elements, QUARANTINE_SNAPSHOTS)
    return ChannelMonitor(
        np.zeros(n_elements), np.zeros((2, n_elements)), good_for, no_plateau(n_elements)
    )


def used_elements(block: ArraySnapshots, used: BoolArray) -> ArraySnapshots:
    """Return a block without the elements that are left out.

    Parameters
    ----------
    block : ArraySnapshots
        Of all elements.
    used : ndarray of bool, shape (n_elements,)
        Elements to keep.
    """
    if used.all():
        return block
    noise = block.noise_covariance
    return replace(
        block,
        data=block.data[..., used],
        element_positions=block.element_positions[used],
        noise_covariance=None if noise is None else noise[np.ix_(used, used)],
    )


def _averaged(
    old: FloatArray, new: FloatArray, n_old: int, n_new: int, n_averaged: int
) -> FloatArray:
    """Return an exponential mean that begins as a plain one."""
    share = _share(n_old, n_new, n_averaged)
    return share * new + (1.0 - share) * old


def _share(n_old: int, n_new: int, n_averaged: int) -> float:
    """Return the weight of new snapshots in it."""
    return max(n_new / (n_new + min(n_old, n_averaged)), min(1.0, n_new / n_averaged))


def _clipped(amplitudes: FloatArray) -> BoolArray:
    heard = amplitudes[:, 0] > 0.0
    ratio = amplitudes[:, 1] / np.where(heard, amplitudes[:, 0], np.nan) ** 2
    return np.asarray(ratio < _median(ratio, heard) - _CLIPPED_DIFFERENCE)


def _median(values: FloatArray, of: BoolArray) -> FloatArray:
    """Return the median of some of the values of each run, shape (n_runs, 1), in their unit.

    NaN, above and below which is nothing, of none.
    """
    if of.all():
        return _middle(np.sort(values, axis=-1))
    heard = [np.sort(own[rows])[None] for own, rows in zip(values, of, strict=True)]
    return np.concatenate([_middle(own) if own.size else np.full((1, 1), np.nan) for own in heard])


def _middle(ordered: FloatArray) -> FloatArray:
    """Return the median of ordered values, shape (n_runs, n), of each run, shape (n_runs, 1)."""
    n = ordered.shape[-1]
    # The median of numpy is the same, but loads its masked arrays and takes three times as long.
    return 0.5 * (ordered[:, (n - 1) // 2, None] + ordered[:, n // 2, None])


def _notice(element: int, used: bool, what: str) -> Notice:
    text = f"Element {element} {what} {_USED if used else _LEFT_OUT}"
    return Notice(Severity.WARN, f"element {element}", text)


def _silent(element: int, used: bool) -> Notice:
    what = (
        "is silent (zero, or more than 30 dB below the median of the array; elements count from "
        "0); check its cable and its gain."
    )
    return _notice(element, used, what)


def _clipping(element: int, used: bool) -> Notice:
    what = (
        "is clipped (its amplitudes pile up at full scale; elements count from 0); lower its gain."
    )
    return _notice(element, used, what)


def _loud(element: int, used: bool) -> Notice:
    what = (
        "is more than 20 dB louder than the median of the array (elements count from 0); check its "
        "preamplifier and its gain."
    )
    return _notice(element, used, what)
