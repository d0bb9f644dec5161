"""Protects the difference between a changed line and a manoeuvring target."""

import numpy as np
import pytest

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.estimators import innovation_monitor
from sonar_tracking.tma.estimators.innovation_monitor import (
    Changes,
    InnovationWindows,
    clear_windows,
    empty_windows,
    extend_windows,
    judge,
    watch_innovations,
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


def judged(
    *lines: list[float], azimuth: list[float] | None = None, present: list[bool] | None = None
) -> tuple[list[int], bool]:
    """Return the lines that changed and whether the target manoeuvres, of the newest innovations.

    Each list is the end of a window; before it there was nothing.
    """
    count = len(lines)
    windows = empty_windows((), count)
    for row, newest in enumerate(lines):
        windows.lines[row, len(windows.lines[row]) - len(newest) :] = newest
    windows.azimuth[len(windows.azimuth) - len(azimuth or []) :] = azimuth or []
    there = np.array([True] * (1 + count) if present is None else [True, *present])
    changes = judge(windows, there)
    return np.flatnonzero(changes.reborn).tolist(), bool(changes.manoeuvre)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_line_is_another_source_at_four_and_a_half_deviates_of_ten(sign: float) -> None:
    # Ten of 1.42: 14.2 / sqrt(10) = 4.49. The window of the motion has room for ten more.
    assert judged([sign * 1.42] * 10, [0.0], [0.0]) == ([], False)
    assert judged([sign * 1.43] * 10, [0.0], [0.0]) == ([0], False)
    assert judged([0.0], [sign * 1.43] * 10, [0.0]) == ([1], False)
    # Older than the ten newest does not count.
    assert judged([sign * 3.0] * 10 + [0.0] * 10, [0.0], [0.0]) == ([], False)
    # Wild values count three at most: 3 n / sqrt(10).
    assert judged([sign * 100.0] * 4, [0.0], [0.0]) == ([], False)
    assert judged([sign * 100.0] * 5, [0.0], [0.0]) == ([0], False)


def test_an_absent_line_is_not_judged() -> None:
    assert judged([2.0] * 10, [0.0], present=[False, True]) == ([], False)
    assert judged([2.0] * 10, [0.0], present=[True, False]) == ([0], False)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_all_lines_the_same_way_are_a_manoeuvre(sign: float) -> None:
    # Twenty of a: sqrt(20) a each, together sqrt(3) times as much: 3.85 at a = 0.497.
    assert judged(*[[sign * 0.49] * 20] * 3) == ([], False)
    assert judged(*[[sign * 0.50] * 20] * 3) == ([], True)
    # The same of two lines: 3.85 / (sqrt(2) sqrt(20)) = 0.609.
    assert judged(*[[sign * 0.60] * 20] * 2) == ([], False)
    assert judged(*[[sign * 0.62] * 20] * 2) == ([], True)
    assert judged(*[[sign * 0.62] * 20] * 2, [5.0] * 20, present=[True, True, False]) == ([], True)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_strong_line_does_not_pass_for_all(sign: float) -> None:
    # The two others together: 2 sqrt(20) b / sqrt(2) = 2.5 at b = 0.395.
    strong = [sign * 1.0] * 20
    assert judged(strong, [sign * 0.39] * 20, [sign * 0.39] * 20) == ([], False)
    assert judged(strong, [sign * 0.40] * 20, [sign * 0.40] * 20) == ([], True)
    assert judged(strong, [-sign * 0.40] * 20, [-sign * 0.40] * 20) == ([], False)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_line_that_others_follow_is_the_target_turning(sign: float) -> None:
    # Of ten: 2 sqrt(10) b / sqrt(2) = 2.5 at b = 0.559.
    out = [sign * 1.45] * 10
    assert judged(out, [sign * 0.55] * 10, [sign * 0.55] * 10) == ([0], False)
    assert judged(out, [sign * 0.57] * 10, [sign * 0.57] * 10) == ([], True)
    assert judged(out, [-sign * 0.57] * 10, [-sign * 0.57] * 10) == ([0], False)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_azimuth_alone_tells_a_manoeuvre(sign: float) -> None:
    # sqrt(20) a = 3.85 at a = 0.861.
    assert judged([0.0], azimuth=[sign * 0.85] * 20) == ([], False)
    assert judged([0.0], azimuth=[sign * 0.87] * 20) == ([], True)
    # Up to 4 an innovation counts 3 at most, beyond it 1.5: n c / sqrt(20).
    assert judged([0.0], azimuth=[sign * 3.9] * 5) == ([], False)
    assert judged([0.0], azimuth=[sign * 3.9] * 6) == ([], True)
    assert judged([0.0], azimuth=[sign * 4.1] * 11) == ([], False)
    assert judged([0.0], azimuth=[sign * 4.1] * 12) == ([], True)


def test_a_manoeuvre_goes_before_a_changed_line() -> None:
    assert judged([1.45] * 10, [0.0], azimuth=[0.9] * 20) == ([], True)


def test_windows_take_what_is_present_and_forget_what_raised_an_alarm() -> None:
    windows = empty_windows((2,), 1)
    for number in range(1, 24):
        present = np.array([[True, True], [number % 2 == 0, False]])
        windows = extend_windows(windows, np.full((2, 2), float(number)), present)
    assert windows.azimuth[0].tolist() == list(range(4, 24))
    assert windows.lines[0, 0].tolist() == list(range(4, 24))
    assert windows.azimuth[1].tolist() == [0.0] * 9 + list(range(2, 24, 2))
    assert windows.lines[1, 0].tolist() == [0.0] * 20
    reborn = clear_windows(windows, Changes(np.array([[True], [False]]), np.zeros(2, bool)))
    assert not np.any(reborn.lines[0])
    np.testing.assert_array_equal(reborn.azimuth, windows.azimuth)
    turned = clear_windows(windows, Changes(np.zeros((2, 1), bool), np.array([True, False])))
    assert not np.any(turned.lines[0])
    assert not np.any(turned.azimuth[0])
    np.testing.assert_array_equal(turned.azimuth[1], windows.azimuth[1])


@pytest.mark.skipif(innovation_monitor.COMPILED is None, reason="no compiler was there")
@pytest.mark.parametrize("n_lines", [0, 1, 4, 9])
def test_the_compiled_monitor_gives_the_bits_of_numpy(
    n_lines: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Lines that shift, all and singly, outliers and gaps; windows and what they say."""
    generator = np.random.default_rng(8)
    innovations = 1.3 * generator.standard_normal((120, N_RUNS, 1 + n_lines))
    innovations[40:, ::3, 1:] += 1.5
    innovations[60:, 1::3, 1:2] += 3.0
    innovations[generator.random(innovations.shape) < 0.02] *= 8.0
    present = generator.random(innovations.shape) < 0.9
    compiled = empty_windows((N_RUNS,), n_lines)
    alarms = 0
    for one, there in zip(innovations, present, strict=True):
        before = compiled
        compiled, changes = watch_innovations(before, one, there)
        with monkeypatch.context() as without:
            without.setattr(innovation_monitor, "COMPILED", None)
            plain, others = watch_innovations(before, one, there)
        np.testing.assert_array_equal(compiled.lines, plain.lines)
        np.testing.assert_array_equal(compiled.azimuth, plain.azimuth)
        np.testing.assert_array_equal(changes.reborn, others.reborn)
        np.testing.assert_array_equal(changes.manoeuvre, others.manoeuvre)
        alarms += int(changes.reborn.sum()) + int(changes.manoeuvre.sum())
    assert n_lines == 0 or alarms > 50
