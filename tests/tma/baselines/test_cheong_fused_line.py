"""Protects the paper's equations 17 to 25 as printed."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.baselines.cheong_fused_line import (
    CheongFusedLine,
    LineReferences,
    add_references,
    first_references,
    fuse_lines,
    fused_frames,
)
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

NAN = np.nan


def measurement(*frequency: float, stamp: int = 1) -> TmaMeasurement:
    return TmaMeasurement(
        stamp=stamp,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.array([0.4]),
        azimuth_variance=np.array(1e-4),
        frequency=np.array(frequency),
        frequency_deviation=np.array([1.0, 2.0, 1.0]),
    )


def test_the_virtual_line_is_the_best_heard_at_the_start() -> None:
    references = first_references(measurement(200.0, 300.0, NAN))
    assert references.virtual == pytest.approx(200.0)  # 200 / 1 Hz beats 300 / 2 Hz
    np.testing.assert_array_equal(references.reference, [200.0, 300.0, NAN])


def test_lines_are_scaled_and_weighted_by_one_over_sigma() -> None:
    references = LineReferences(np.array(200.0), np.array([200.0, 300.0, NAN]))
    fused = fuse_lines(measurement(201.0, 303.0, 400.0), references)
    # (18): 201 and 202; (19): weights 1 and 1/2; noise of the scaled second line is 4/3 Hz.
    assert fused.frequency == pytest.approx((201.0 + 0.5 * 202.0) / 1.5)
    assert fused.frequency_deviation == pytest.approx(np.hypot(1.0, 0.5 * 4 / 3) / 1.5)


def test_a_late_line_is_referred_to_the_virtual_line_of_its_first_frame() -> None:
    frame = measurement(201.0, NAN, 402.0)
    before = LineReferences(np.array(200.0), np.array([200.0, NAN, NAN]))
    fused = fuse_lines(frame, before)
    assert fused.frequency == pytest.approx(201.0)  # (22): not used yet
    after = add_references(frame, before, fused, np.array(NAN))
    assert after.reference[2] == pytest.approx(402.0 * 200.0 / 201.0)  # (21)
    assert np.isnan(after.reference[1])


def test_without_any_known_line_the_filter_bridges() -> None:
    frame = measurement(NAN, NAN, 402.0)
    before = LineReferences(np.array(200.0), np.array([200.0, NAN, NAN]))
    after = add_references(frame, before, fuse_lines(frame, before), np.array(199.0))
    assert after.reference[2] == pytest.approx(402.0 * 200.0 / 199.0)


def closing(*frequency: float, stamp: int = 1) -> TmaMeasurement:
    """Return a frame of a target straight ahead of own ship, which closes in at 15 m/s."""
    frame = measurement(*frequency, stamp=stamp)
    return replace(frame, velocity=np.array([15.0, 0.0]), azimuth=np.array([0.0]))


def test_a_line_that_comes_when_all_are_gone_is_referred_to_what_the_filter_expects() -> None:
    """(21) with the filter's own Doppler shift: the speed of approach over that of sound."""
    estimator, before = CheongFusedLine(), closing(200.0, NAN, NAN)
    estimate = estimator.update(before)
    rate = estimate.mean[2] - 15.0
    assert estimate.source_frequency[0] * (1.0 - rate / before.sound_speed) == pytest.approx(
        200.0, abs=1.0
    )
    estimator.update(closing(NAN, NAN, 402.0, stamp=2))
    later = estimator.update(closing(NAN, NAN, 402.0, stamp=3))
    # What the line is at once, the filter expects: it learns nothing from it.
    assert later.source_frequency[0] == pytest.approx(estimate.source_frequency[0], abs=1e-3)


def test_lines_may_all_vanish_and_first_come_late() -> None:
    estimator = CheongFusedLine()
    for second, lines in enumerate([(NAN,) * 3, (NAN, 300.0, NAN), (NAN,) * 3, (200.0, NAN, NAN)]):
        frame = measurement(*lines, stamp=1 + second * 10**9)
        estimate = estimator.update(frame)
        assert np.all(np.isfinite(estimate.mean))
        assert np.all(np.linalg.eigvalsh(estimate.covariance) > 0.0)


def test_it_takes_a_batch_of_runs() -> None:
    frame = measurement(200.0, 300.0, NAN)
    batch = replace(
        frame,
        azimuth=np.array([[0.4], [0.4]]),
        frequency=np.array([[200.0, 300.0, NAN], [NAN, 300.0, 400.0]]),
        frequency_deviation=np.tile(frame.frequency_deviation, (2, 1)),
    )
    alone, together = CheongFusedLine().update(frame), CheongFusedLine().update(batch)
    np.testing.assert_allclose(together.mean[0], alone.mean, rtol=1e-12)


def test_frames_of_a_batch_estimator_have_the_line_that_the_filter_has() -> None:
    lines = [(200.0, 300.0, NAN), (201.0, NAN, 402.0), (202.0, NAN, 404.0), (NAN, NAN, NAN)]
    frames = fused_frames([measurement(*one, stamp=1 + n) for n, one in enumerate(lines)])
    assert [one.n_lines for one in frames] == [1, 1, 1, 1]
    # The third line is used from its second frame on, 402 Hz being what 201 Hz was.
    measured = [float(one.frequency[0]) for one in frames]
    assert measured == pytest.approx([200.0, 201.0, 202.0, NAN], nan_ok=True)


def two_runs(frequency: list[list[float]], deviation: list[list[float]]) -> TmaMeasurement:
    return TmaMeasurement(
        stamp=1,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.zeros((2, 1)),
        azimuth_variance=np.full(2, 1e-4),
        frequency=np.array(frequency),
        frequency_deviation=np.array(deviation),
    )


def test_the_fused_line_and_its_deviation_by_hand() -> None:
    """(18), (19): scaled by virtual over reference, weighted by one over sigma."""
    first = two_runs([[300.0, 200.0], [300.0, np.nan]], [[0.1, 0.2], [0.1, 0.2]])
    references = first_references(first)
    assert references.virtual.tolist() == [300.0, 300.0]
    np.testing.assert_array_equal(references.reference, [[300.0, 200.0], [300.0, np.nan]])
    later = two_runs([[303.0, 201.0], [np.nan, 205.0]], [[0.1, 0.2], [0.1, 0.2]])
    fused = fuse_lines(later, references)
    # Weights 10 and 5; the second line is scaled by 1.5.
    expected = (10.0 * 303.0 + 5.0 * 301.5) / 15.0
    deviation = np.sqrt(1.0 + 1.5**2) / 15.0
    assert fused.frequency[0] == pytest.approx([expected])
    assert fused.frequency_deviation[0] == pytest.approx([deviation])
    assert np.isnan(fused.frequency[1, 0]), "its only line has no reference yet"


def test_references_of_new_lines_follow_from_the_fused_one_and_old_ones_stay() -> None:
    """(20), (21): as if the line had been heard when the virtual one was first."""
    references = first_references(two_runs([[300.0, np.nan]] * 2, [[0.1, 0.2]] * 2))
    later = two_runs([[303.0, 201.0], [np.nan, 205.0]], [[0.1, 0.2]] * 2)
    fused = fuse_lines(later, references)
    added = add_references(later, references, fused, np.array([np.nan, 299.0]))
    assert added.virtual.tolist() == [300.0, 300.0]
    assert added.reference[0] == pytest.approx([300.0, 201.0 * 300.0 / 303.0])
    # Where nothing known is heard the filter's prediction stands in.
    assert added.reference[1] == pytest.approx([300.0, 205.0 * 300.0 / 299.0])
    again = add_references(
        two_runs([[310.0, 210.0]] * 2, [[0.1, 0.2]] * 2), added, fused, np.full(2, np.nan)
    )
    np.testing.assert_array_equal(again.reference, added.reference)
    unknown = add_references(later, references, fused, np.full(2, np.nan))
    assert unknown.reference[1] == pytest.approx([300.0, 205.0]), "nothing at all: as it is"


def test_the_best_heard_has_the_largest_ratio_of_frequency_to_deviation() -> None:
    first = two_runs([[300.0, 200.0], [300.0, 200.0]], [[0.3, 0.1], [0.1, 0.1]])
    assert first_references(first).virtual.tolist() == [200.0, 300.0]
    silent = two_runs([[np.nan, np.nan], [np.nan, 200.0]], [[0.3, 0.1], [0.1, 0.1]])
    virtual = first_references(silent).virtual
    assert np.isnan(virtual[0])
    assert virtual[1] == 200.0
    none = replace(first, frequency=np.empty((2, 0)), frequency_deviation=np.empty((2, 0)))
    assert np.isnan(first_references(none).virtual).tolist() == [True, True]
