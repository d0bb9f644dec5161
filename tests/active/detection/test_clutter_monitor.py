"""Protects when the number of contacts contradicts the claimed clutter, and what follows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.detection.clutter_amplitudes import IN_NOISE, ExcessLaw
from sonar_tracking.active.detection.clutter_monitor import MOST_AMPLITUDES, ClutterMonitor
from sonar_tracking.active.detection.detection_model import DetectionModel

MODEL = DetectionModel(
    detection_probability=0.5,
    signal_to_noise_ratio_linear=10.0,
    averaged=False,
    outlier_share=0.01,
    threshold=3.0,
    false_alarm_probability=np.nan,
    cell_size=np.nan,
    uniform_density=20.0 / (np.pi * 1000.0**2),
    maximum_range=1000.0,
)
"""Twenty false contacts a ping."""


def test_contacts_that_tracks_explain_are_no_clutter() -> None:
    monitor = ClutterMonitor().after(30, 4, MODEL)
    assert (monitor.counted, monitor.claimed) == pytest.approx((28.0, 20.0))
    assert ClutterMonitor().after(1, 4, MODEL).counted == 0.0


def test_older_pings_are_forgotten() -> None:
    monitor = ClutterMonitor(100.0, 200.0).after(30, 0, MODEL)
    assert (monitor.counted, monitor.claimed) == pytest.approx((120.0, 200.0))
    unknown = replace(MODEL, maximum_range=np.inf)
    assert ClutterMonitor(1.0, 2.0).after(30, 0, unknown) == ClutterMonitor(1.0, 2.0)


@pytest.mark.parametrize(
    ("counted", "claimed", "factor"),
    [
        (139.0, 100.0, 1.0),  # within four deviations, 100 + 4 * 10
        (149.0, 100.0, 1.0),  # beyond them, but not half more
        (151.0, 100.0, 1.51),
        (7.9, 4.0, 1.0),
        (11.9, 4.0, 1.0),  # 4 + 4 * 2
        (12.1, 4.0, 3.025),
        (4.2, 0.25, 1.0),  # of few claimed ones, as if of one: 0.25 + 4
        (4.3, 0.25, 17.2),
        (50.0, 0.0, 1.0),
        (10.0, 100.0, 1.0),  # fewer than claimed are believed
    ],
)
def test_a_claim_is_contradicted_by_half_more_and_four_deviations(
    counted: float, claimed: float, factor: float
) -> None:
    monitor = ClutterMonitor(counted, claimed)
    assert monitor.factor() == pytest.approx(factor)
    corrected = monitor.corrected(MODEL)
    if factor == 1.0:
        assert corrected is MODEL
        assert monitor.notices() == ()
        return
    assert corrected == replace(MODEL, clutter_factor=monitor.factor(), outlier_share=1.0)
    (notice,) = monitor.notices()
    assert f"{factor:.1f} times as many" in notice.text


def unexplained(monitor: ClutterMonitor, excess: np.ndarray) -> ClutterMonitor:
    return monitor.with_unexplained(excess, np.linspace(1.0, 999.0, len(excess)), MODEL)


def test_amplitudes_of_what_no_track_explains_make_the_law_once_there_are_enough() -> None:
    monitor = ClutterMonitor(300.0, 100.0)
    assert unexplained(monitor, np.full(29, 2.0)).corrected(MODEL).outlier_share == 1.0
    law = ExcessLaw(4.0, 0.0)
    excess = -4.0 * np.log1p(-(np.arange(1, 1001) - 0.5) / 1000.0)
    unknown = np.full(5, np.nan)
    learnt = unexplained(unexplained(monitor, unknown), excess).corrected(MODEL)
    assert (learnt.outlier_share, learnt.clutter_factor) == (MODEL.outlier_share, 3.0)
    assert learnt.clutter_law.scale == pytest.approx(law.scale, rel=0.02)
    assert learnt.clutter_law.shape == pytest.approx(0.0, abs=0.02)
    # A claim that is believed is believed in all.
    believed = unexplained(ClutterMonitor(100.0, 100.0), excess).corrected(MODEL)
    assert (believed.clutter_factor, believed.clutter_law) == (1.0, IN_NOISE)


def test_the_latest_amplitudes_count() -> None:
    monitor = unexplained(ClutterMonitor(), np.full(1500, 1.0))
    monitor = unexplained(monitor, np.full(1500, 2.0))
    assert len(monitor.excess) == MOST_AMPLITUDES
    assert np.count_nonzero(monitor.excess == 2.0) == 1500


def test_without_a_largest_range_the_farthest_contact_so_far_bounds_the_rings() -> None:
    endless = replace(MODEL, maximum_range=np.inf)
    monitor = ClutterMonitor().with_unexplained(np.zeros(2), np.array([10.0, 700.0]), endless)
    monitor = monitor.with_unexplained(np.zeros(1), np.array([300.0]), endless)
    assert monitor.profile.reach == 700.0
    assert np.sum(monitor.profile.counted) == pytest.approx(2.0 * 0.95 + 1.0)
