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

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.passive.subspaces.amplitude_plateau import AmplitudePlateau, no_plateau
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
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

    def update(self, block: ArraySnapshots) -> tuple[ChannelMonitor, tuple[Notice, ...]]:
        """Return the monitor after a block and a notice for each element that is bad in it.

        Parameters
        ----------
        block : ArraySnapshots
            Finite data of all elements.
        """
        data = block.data.reshape(-1, block.data.shape[-1])
        squared = data.real**2 + data.imag**2
        moments = np.stack([squared.mean(axis=0), (squared**2).mean(axis=0)])
        power = _averaged(self.power, moments[0], self.n_snapshots, len(data), _POWER_SNAPSHOTS)
        amplitudes = _averaged(
            self.amplitudes, moments, self.n_snapshots, len(data), _AMPLITUDE_SNAPSHOTS
        )
        share = _share(self.n_snapshots, len(data), _AMPLITUDE_SNAPSHOTS)
        plateau = self.plateau.update(data, share)
        seen = self.n_snapshots + len(data)
        silent, loud = moments[0] == 0.0, np.zeros(data.shape[-1], dtype=bool)
        clipped, saturated = loud, loud
        if seen >= _POWER_SNAPSHOTS:
            median = _median(power, power > 0.0)
            silent = silent | (power < SILENT_RATIO * median)
            loud = power > LOUD_RATIO * median
        if seen >= _AMPLITUDE_SNAPSHOTS:
            clipped = _clipped(amplitudes) & plateau.found & ~silent
            saturated = clipped & (power > _SATURATED_RATIO * _median(power, power > 0.0))
        good_for = np.minimum(self.good_for + len(data), QUARANTINE_SNAPSHOTS)
        good_for = np.where(silent | loud | saturated, 0, good_for)
        monitor = ChannelMonitor(power, amplitudes, good_for, plateau, seen)
        used = monitor.used
        notices = [_silent(int(n), used[n]) for n in np.flatnonzero(silent)]
        notices += [_clipping(int(n), used[n]) for n in np.flatnonzero(clipped)]
        notices += [_loud(int(n), used[n]) for n in np.flatnonzero(loud & ~clipped)]
        return monitor, tuple(notices)


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
    heard = amplitudes[0] > 0.0
    ratio = amplitudes[1] / np.where(heard, amplitudes[0], np.nan) ** 2
    return np.asarray(ratio < _median(ratio, heard) - _CLIPPED_DIFFERENCE)


def _median(values: FloatArray, of: BoolArray) -> float:
    """Return the median of some of the values; NaN, above and below which is nothing, of none."""
    ordered = np.sort(values[of])
    n = len(ordered)
    # The median of numpy is the same, but loads its masked arrays and takes three times as long.
    return 0.5 * float(ordered[(n - 1) // 2] + ordered[n // 2]) if n else np.nan


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
