"""Protects the difference between a changed line and a manoeuvring target."""

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.estimators.innovation_monitor import (
    Changes,
    InnovationWindows,
    clear_windows,
    empty_windows,
    extend_windows,
    judge,
)

N_RUNS, N_LINES = 100, 4


def watch(innovations: FloatArray, present: BoolArray | None = None) -> tuple[Changes, int]:
    """Return the first changes of each run, and the number of false steps before frame 100."""
    shape = innovations.shape[1:]
    present = np.ones(innovations.shape, dtype=bool) if present is None else present
    windows: InnovationWindows = empty_windows(shape[:-1], shape[-1] - 1)
    reborn = np.zeros((shape[0], shape[-1] - 1), dtype=bool)
    manoeuvre = np.zeros(shape[0], dtype=bool)
    early = 0
    for frame, (one, there) in enumerate(zip(innovations, present, strict=True)):
        windows = extend_windows(windows, one, there)
        changes = judge(windows, there)
        windows = clear_windows(windows, changes)
        if frame < 100:
            early += int(changes.manoeuvre.sum())
            continue
        undecided = ~(manoeuvre | np.any(reborn, axis=-1))
        reborn |= changes.reborn & undecided[:, None]
        manoeuvre |= changes.manoeuvre & undecided
    return Changes(reborn, manoeuvre), early


def white(seed: int) -> FloatArray:
    return np.random.default_rng(seed).standard_normal((130, N_RUNS, 1 + N_LINES))


def test_white_innovations_raise_hardly_any_alarm() -> None:
    _, early = watch(white(1))
    assert early <= 3  # of 10,000 frames: once in 4,000


def test_one_shifted_line_is_another_source() -> None:
    innovations = white(2)
    innovations[100:, :, 2] += 3.0
    changes, _ = watch(innovations)
    assert np.mean(changes.reborn[:, 1]) >= 0.95
    assert not np.any(np.delete(changes.reborn, 1, axis=1).sum() > 3)


def test_a_shift_of_all_lines_is_a_manoeuvre() -> None:
    innovations = white(3)
    innovations[100:, :, 1:] += 3.0
    changes, _ = watch(innovations)
    assert np.mean(changes.manoeuvre) >= 0.95


def test_a_drifting_azimuth_is_a_manoeuvre() -> None:
    innovations = white(4)
    innovations[100:, :, 0] += 1.8
    changes, _ = watch(innovations)
    assert np.mean(changes.manoeuvre) >= 0.9
    assert changes.reborn.sum() <= 2


def test_absent_lines_do_not_vote() -> None:
    innovations = white(5)
    innovations[100:, :, 1:] += 3.0
    present = np.ones(innovations.shape, dtype=bool)
    present[100:, :, 1:] = False
    changes, _ = watch(innovations, present)
    assert changes.manoeuvre.sum() <= 2
    assert not np.any(changes.reborn)


def test_scattered_outliers_are_no_change() -> None:
    innovations = white(6)
    wild = np.random.default_rng(7).random(innovations.shape) < 0.05
    innovations = np.where(wild, 100.0 * np.sign(innovations), innovations)
    changes, early = watch(innovations)
    assert early <= 5
    assert changes.manoeuvre.sum() <= 3
