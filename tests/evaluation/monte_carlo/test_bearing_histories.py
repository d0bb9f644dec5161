"""Protects: what counts as success, over which runs errors are averaged, and picked runs."""

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.bearing_histories import (
    BearingHistories,
    bearing_metrics,
    joined,
    mean_square_error_deg2,
    normalised_innovation_squared,
    successful,
)
from sonar_tracking.evaluation.monte_carlo.history_swaps import lasting_swaps
from sonar_tracking.evaluation.studies.doa_fusion.figures import failed_run, typical_run

TRUTH = np.radians(np.array([[0.0, 20.0]] * 12))


def histories(errors_deg: list[np.ndarray]) -> BearingHistories:
    angle = TRUTH + np.radians(np.array(errors_deg))
    swaps = np.arange(len(errors_deg), dtype=np.float64)
    return BearingHistories(angle, np.ones_like(angle), np.full_like(angle, 0.5), swaps)


def test_only_the_last_five_steps_decide_success() -> None:
    early, late = np.zeros((12, 2)), np.zeros((12, 2))
    early[:7, 0] = 50.0
    late[7, 1] = 3.1
    angle = histories([early, late, np.full((12, 2), 2.9)]).angle
    assert successful(angle, TRUTH).tolist() == [True, False, True]


def test_a_run_without_tracks_at_the_end_is_not_successful() -> None:
    missing = np.zeros((12, 2))
    missing[11, 1] = np.nan
    assert not successful(histories([missing]).angle, TRUTH)[0]


def test_error_is_over_the_steps_that_have_a_track() -> None:
    late_start = np.full((12, 2), 2.0)
    late_start[:4] = np.nan
    never = np.full((12, 2), np.nan)
    errors = mean_square_error_deg2(histories([late_start, never]).angle, TRUTH)
    assert errors.tolist() == pytest.approx([4.0, np.inf])


def test_published_error_is_over_successful_runs_and_the_median_over_all() -> None:
    runs = [np.full((12, 2), 1.0), np.full((12, 2), 2.0), np.full((12, 2), 10.0)]
    metrics = bearing_metrics(histories(runs), TRUTH)
    assert metrics["mse_deg2"] == pytest.approx((1 + 4) / 2)
    assert metrics["median_mse_deg2"] == pytest.approx(4.0)
    assert metrics["success_percent"] == pytest.approx(200 / 3)
    assert metrics["lost_percent"] == pytest.approx(100 / 3)
    assert metrics["rmse_deg"] == pytest.approx(np.sqrt(105 / 3))
    assert metrics["rmse_successful_deg"] == pytest.approx(np.sqrt(2.5))
    assert metrics["swaps_per_run"] == pytest.approx(1.0)
    assert metrics["nis_per_dimension"] == pytest.approx(1.0)
    assert metrics["nees_per_dimension"] == pytest.approx(0.5)
    assert metrics["nis_band_low"] < 1 < metrics["nis_band_high"]


def test_no_success_at_all_leaves_its_error_undefined() -> None:
    metrics = bearing_metrics(histories([np.full((12, 2), 10.0)]), TRUTH)
    assert np.isnan(metrics["mse_deg2"]) and metrics["success_percent"] == 0.0
    assert "nis_per_dimension" not in metrics


def test_batches_join_along_the_runs() -> None:
    one = histories([np.zeros((12, 2))])
    assert joined([one, one, one]).angle.shape == (3, 12, 2)


def test_typical_and_failed_runs_are_what_they_say() -> None:
    ryu = histories([np.full((12, 2), error) for error in (4.0, 1.0, 9.0, 8.0, 1.1)]).angle
    proposed = histories([np.full((12, 2), error) for error in (0.5, 0.5, 9.0, 0.5, 0.1)]).angle
    assert typical_run([ryu, proposed], TRUTH) == 1
    assert failed_run(ryu, proposed, TRUTH) == 3
    assert failed_run(proposed[:2], ryu[:2], TRUTH) is None


def test_nis_from_published_figures_equals_the_definition() -> None:
    predicted, variance, innovation = 3.0, 2.0, 1.7
    filtered = predicted * variance / (predicted + variance)
    nis = normalised_innovation_squared(
        np.array(innovation), np.array(variance), np.array(filtered)
    )
    assert nis == pytest.approx(innovation**2 / (predicted + variance))


def test_only_an_exchange_that_lasts_is_a_swap() -> None:
    exchanged = TRUTH[:, ::-1]
    briefly, lasting = TRUTH.copy(), TRUTH.copy()
    briefly[4] = exchanged[4]
    lasting[6:] = exchanged[6:]
    no_track = np.full_like(TRUTH, np.nan)
    swaps = lasting_swaps(np.stack([TRUTH, briefly, lasting, no_track]), TRUTH)
    assert swaps.tolist() == [0, 0, 2, 0]
