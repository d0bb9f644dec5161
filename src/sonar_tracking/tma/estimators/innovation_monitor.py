"""Tests whether a line is still the same source and the target still moves straight.

A window of normalised innovations is kept of every line and of the azimuth. A consistent filter's
innovations are white with variance one, so that sum / sqrt(n) over a window is a standard normal
deviate: of one line T_i, of all lines present together C = sum T_i / sqrt(n_lines).

- One line whose T is out is another source under the old name: it is started anew.
- All lines out the same way, or the azimuth, is the target manoeuvring: Doppler is common to all
  lines. C is judged without its strongest line too, so that one line cannot pass for all.

The sums have a stated order, and ``compiled_monitor``, which is there if a compiler was when the
package was installed, gives the same bits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import BoolArray, FloatArray

COMPILED = compiled_module("tma.estimators.compiled_monitor")

WINDOW = 20
"""Innovations kept; all of them judge a manoeuvre."""

LINE_WINDOW = 10
"""The newest innovations, which judge a line."""

CLIP = 3.0
"""Normalised innovations count at most this much: a few outliers are no change."""

OUTLIER, OUTLIER_COUNT = 4.0, 1.5
"""Beyond the first, an innovation says little of the motion and counts as the second there."""

LINE_THRESHOLD = 4.5
MOTION_THRESHOLD = 3.85
OTHERS_THRESHOLD = 2.5
"""Standard normal deviates: one line, the motion, the motion without its strongest line."""


@dataclass(frozen=True)
class InnovationWindows:
    """The last normalised innovations, newest last; 0 where there is none yet.

    Attributes
    ----------
    lines : ndarray, shape (..., n_lines, WINDOW)
        Pure numbers, of each line, of frames in which it was present.
    azimuth : ndarray, shape (..., WINDOW)
        Pure numbers, of the azimuth.
    """

    lines: FloatArray
    azimuth: FloatArray


@dataclass(frozen=True)
class Changes:
    """What the windows say now.

    Attributes
    ----------
    reborn : ndarray of bool, shape (..., n_lines)
        Lines to start anew.
    manoeuvre : ndarray of bool, shape (...)
        The target does not move straight.
    """

    reborn: BoolArray
    manoeuvre: BoolArray


def empty_windows(batch: tuple[int, ...], n_lines: int) -> InnovationWindows:
    """Return windows without innovations."""
    return InnovationWindows(np.zeros((*batch, n_lines, WINDOW)), np.zeros((*batch, WINDOW)))


def watch_innovations(
    windows: InnovationWindows, normalised: FloatArray, present: BoolArray
) -> tuple[InnovationWindows, Changes]:
    """Return the windows with the newest innovations, cleared where they say so, and what they say.

    Parameters
    ----------
    windows : InnovationWindows
        Before.
    normalised : ndarray, shape (..., 1 + n_lines)
        Innovations over their standard deviations, pure numbers: azimuth, then lines.
    present : ndarray of bool, shape (..., 1 + n_lines)
        Which of them there are.
    """
    if COMPILED is None:
        extended = extend_windows(windows, normalised, present)
        changes = judge(extended, present)
        return clear_windows(extended, changes), changes
    after = InnovationWindows(np.empty(windows.lines.shape), np.empty(windows.azimuth.shape))
    batch, n_lines = windows.azimuth.shape[:-1], windows.lines.shape[-2]
    changes = Changes(np.empty((*batch, n_lines), dtype=bool), np.empty(batch, dtype=bool))
    given = windows.lines, windows.azimuth, normalised, present
    COMPILED.watch(
        *(np.ascontiguousarray(each) for each in given),
        *(after.lines, after.azimuth, changes.reborn, changes.manoeuvre),
        (CLIP, OUTLIER, OUTLIER_COUNT, LINE_THRESHOLD, MOTION_THRESHOLD, OTHERS_THRESHOLD),
        (changes.manoeuvre.size, n_lines, WINDOW, LINE_WINDOW),
    )
    return after, changes


def extend_windows(
    windows: InnovationWindows, normalised: FloatArray, present: BoolArray
) -> InnovationWindows:
    """Return the windows with the newest innovations.

    Parameters
    ----------
    windows : InnovationWindows
        Before.
    normalised : ndarray, shape (..., 1 + n_lines)
        Innovations over their standard deviations, pure numbers: azimuth, then lines.
    present : ndarray of bool, shape (..., 1 + n_lines)
        Which of them there are.
    """
    return InnovationWindows(
        _push(windows.lines, normalised[..., 1:], present[..., 1:]),
        _push(windows.azimuth, normalised[..., 0], present[..., 0]),
    )


def judge(windows: InnovationWindows, present: BoolArray) -> Changes:
    """Return which lines changed and whether the target manoeuvres.

    Parameters
    ----------
    windows : InnovationWindows
        With the newest innovations.
    present : ndarray of bool, shape (..., 1 + n_lines)
        Rows that the newest frame had.
    """
    there = present[..., 1:]
    azimuth = np.abs(_deviate(_counted(windows.azimuth), WINDOW)) > MOTION_THRESHOLD
    if not there.any():
        return Changes(np.zeros(there.shape, dtype=bool), azimuth)
    clipped = np.clip(windows.lines[..., -LINE_WINDOW:], -CLIP, CLIP)
    line = _deviate(clipped, LINE_WINDOW)
    out = (np.abs(line) > LINE_THRESHOLD) & there
    counted = _counted(windows.lines)
    recent, _ = _others(counted, there, LINE_WINDOW)
    supported = recent * np.sign(line) > OTHERS_THRESHOLD

    others, moving = _others(counted, there, WINDOW)
    count = np.maximum(np.sum(there, axis=-1), 1)
    common = np.abs(_summed(moving)) > MOTION_THRESHOLD * np.sqrt(count)
    strongest = np.abs(moving) == np.max(np.abs(moving), axis=-1, keepdims=True, initial=0.0)
    common &= np.any((others * np.sign(moving) > OTHERS_THRESHOLD) & strongest, axis=-1)

    manoeuvre = common | np.any(out & supported, axis=-1) | azimuth
    return Changes(out & ~supported & ~manoeuvre[..., None], manoeuvre)


def clear_windows(windows: InnovationWindows, changes: Changes) -> InnovationWindows:
    """Return the windows without those that raised an alarm; a manoeuvre clears them all."""
    lines = changes.reborn | changes.manoeuvre[..., None]
    if not lines.any() and not changes.manoeuvre.any():
        return windows
    return InnovationWindows(
        np.where(lines[..., None], 0.0, windows.lines),
        np.where(changes.manoeuvre[..., None], 0.0, windows.azimuth),
    )


def _counted(window: FloatArray) -> FloatArray:
    """Return what each innovation of a window counts."""
    counted = np.clip(window, -CLIP, CLIP)
    return np.where(np.abs(window) > OUTLIER, OUTLIER_COUNT * np.sign(window), counted)


def _deviate(counted: FloatArray, length: int) -> FloatArray:
    return np.asarray(_summed(counted[..., -length:]) / np.sqrt(length))


def _summed(values: FloatArray) -> FloatArray:
    """Return the sum over the last axis, one after the other."""
    return np.asarray(np.add.accumulate(values, axis=-1)[..., -1])


def _others(counted: FloatArray, there: BoolArray, length: int) -> tuple[FloatArray, FloatArray]:
    """Return the deviate of all lines but each one, and that of each; 0 where there is none."""
    moving = np.where(there, _deviate(counted, length), 0.0)
    count = np.maximum(np.sum(there, axis=-1, keepdims=True) - 1, 1)
    return (_summed(moving)[..., None] - moving) / np.sqrt(count), moving


def _push(window: FloatArray, newest: FloatArray, present: BoolArray) -> FloatArray:
    longer = np.concatenate([window[..., 1:], newest[..., None]], axis=-1)
    return np.where(present[..., None], longer, window)
