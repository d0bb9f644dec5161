"""The bearing tracker: against the equations by the letter, coasting, endfire, consistency."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict
from sonar_tracking.passive.bearings.bearing_track_list import folded_angles
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates, TrackStatus
from sonar_tracking.records.time import END_OF_DATA
from tests.passive.crossing_scene import (
    EPOCH,
    POSITIONS,
    ComplexArray,
    FloatArray,
    blocks_of,
    crossing_angles,
    crossing_data,
    crossing_rates,
    snapshots_of,
)
from tests.passive.subspaces.test_past import past_by_the_letter

PAST = SubspaceConfiguration(
    method="past", forgetting_factor=0.86, period=1.0, source_count=5, n_subspaces=7
)


def given(**changes: object) -> BearingTrackerConfiguration:
    """Return the published tracker started from the truth of the crossing scene."""
    values: dict[str, object] = {
        "method": "ml_fusion",
        "start": "given",
        "initial_bearings_deg": tuple(np.rad2deg(crossing_angles(0.0))),
        "initial_rates_deg": tuple(np.rad2deg(crossing_rates(0.0))),
        "process_noise_deg2": 1.0,
        "measurement_variance_deg2": 36.0,
        "fused_variance": "independent",
        "phase_reference": "first_element",
    }
    return BearingTrackerConfiguration(**{**values, **changes})  # type: ignore[arg-type]


def estimated(
    data: ComplexArray, configuration: SubspaceConfiguration = PAST
) -> list[SubspaceEstimates]:
    """Return the subspace estimates of snapshots that begin at t = -1 s."""
    stage = SubspaceStage(configuration)
    return [e for block in blocks_of(data, 100) for e in stage.update(block).estimates]


def tracked(
    estimates: list[SubspaceEstimates], configuration: BearingTrackerConfiguration
) -> list[BearingTracks]:
    """Return the tracks of all estimates."""
    stage = BearingTrackerStage(configuration)
    return [stage.update(estimate).tracks for estimate in estimates]


def chain_by_the_letter(
    data: ComplexArray, n_subspaces: int, centred: bool, steps: int
) -> FloatArray:
    """Return the angles in deg of the published chain, written equation by equation."""
    m = np.arange(15) - (7 if centred else 0)
    F, H = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([1.0, 0.0])
    Q, R = np.array([[1 / 3, 1 / 2], [1 / 2, 1.0]]), 36.0 / n_subspaces
    states = [
        (np.rad2deg([angle, rate]), np.diag([6.0, 1.0]))
        for angle, rate in zip(crossing_angles(0.0), crossing_rates(0.0), strict=True)
    ]
    half = (n_subspaces - 1) // 2
    result = []
    for k in range(1, steps + 1):
        centre = 200 + 200 * k
        bases = [
            past_by_the_letter(data[: centre + offset + 1], 5, 0.86)
            for offset in range(-half, half + 1)
        ]
        updated = []
        for x, P in states:
            x, P = F @ x, F @ P @ F.T + Q
            theta = np.deg2rad(x[0])
            a = np.exp(1j * np.pi * m * np.sin(theta))
            slope = 1j * np.pi * m * np.cos(theta) * a
            measured = []
            for W in bases:
                complement = np.eye(15) - W @ np.linalg.inv(W.conj().T @ W) @ W.conj().T
                y, u = complement @ a, complement @ slope
                delta = -np.real(np.vdot(u, y)) / np.real(np.vdot(u, u))
                measured.append(x[0] + np.rad2deg(delta))
            gain = P @ H / (H @ P @ H + R)
            x = x + gain * (np.mean(measured) - x[0])
            updated.append((x, P - np.outer(gain, H @ P)))
        states = updated
        result.append([x[0] for x, _ in states])
    return np.array(result)


@pytest.mark.slow
@pytest.mark.parametrize(("n_subspaces", "centred"), [(1, False), (7, False), (7, True)])
def test_chain_is_the_published_one(n_subspaces: int, centred: bool) -> None:
    data = crossing_data(1, -3.0, 6.0)
    reference = "array_centre" if centred else "first_element"
    tracks = tracked(
        estimated(data, replace(PAST, n_subspaces=n_subspaces)),
        given(phase_reference=reference),
    )
    angles = np.rad2deg([track.arrival_angle for track in tracks])
    assert angles[0] == pytest.approx(np.rad2deg(crossing_angles(0.0)), abs=1e-12)
    expected = chain_by_the_letter(data, n_subspaces, centred, 6)
    assert np.abs(angles[1:] - expected).max() < 1e-8


def test_single_subspace_tracker_uses_the_one_at_the_sample_time() -> None:
    data = crossing_data(2, 0.0, 4.0)
    of_seven = tracked(estimated(data), given(method="ryu"))
    of_one = tracked(estimated(data, replace(PAST, n_subspaces=1)), given())
    for first, second in zip(of_seven, of_one, strict=True):
        assert np.array_equal(first.arrival_angle, second.arrival_angle)
        assert np.array_equal(first.covariance, second.covariance)


def test_claimed_variance_of_the_measurement() -> None:
    estimates = estimated(crossing_data(3, 0.0, 1.0))
    square_degree = np.deg2rad(1.0) ** 2
    independent = tracked(estimates, given())[-1]
    assert independent.measurement_variance == pytest.approx(36.0 / 7.0 * square_degree)
    correlated = tracked(estimates, given(fused_variance="correlated"))[-1]
    assert correlated.measurement_variance == pytest.approx(0.730 * 36.0 * square_degree, rel=1e-3)
    innovation = correlated.measurement - correlated.innovation
    assert np.allclose(innovation, crossing_angles(0.0) + crossing_rates(0.0))


@pytest.mark.parametrize("changes", [{}, {"measurement_variance_deg2": 0.0}])
def test_batch_is_many_single_runs(changes: dict[str, object]) -> None:
    data = crossing_data(4, 0.0, 5.0, batch=(3,))
    together = tracked(estimated(data), given(**changes))
    assert together[-1].arrival_angle.shape == (3, 5)
    for run in range(3):
        alone = tracked(estimated(data[run]), given(**changes))
        for batch, single in zip(together, alone, strict=True):
            assert np.abs(batch.arrival_angle[run] - single.arrival_angle).max() < 1e-10
            assert np.allclose(batch.covariance[run], single.covariance, atol=1e-12)


def test_first_estimate_tells_only_the_instant() -> None:
    track = tracked(estimated(crossing_data(5, 0.0, 0.0)), given(first_id=7))[0]
    assert track.stamp == EPOCH
    assert list(track.id) == [7, 8, 9, 10, 11]
    assert np.isnan(track.measurement).all()
    assert set(track.status) == {TrackStatus.CONFIRMED}
    assert track.ambiguous.all()
    square_degree = np.deg2rad(1.0) ** 2
    assert np.allclose(track.covariance[0], np.diag([6.0, 1.0]) * square_degree)


def test_without_subspaces_tracks_are_predicted() -> None:
    estimates = estimated(crossing_data(6, 0.0, 3.0))
    empty = replace(
        estimates[2],
        basis=estimates[2].basis[:0],
        time_offsets=np.empty(0),
        covariance=None,
        noise_power=np.array(np.nan),
    )
    stage = BearingTrackerStage(given())
    before = [stage.update(e).tracks for e in estimates[:2]][-1]
    update = stage.update(empty)
    after = update.tracks
    assert set(after.status) == {TrackStatus.COASTED}
    assert np.allclose(after.arrival_angle, before.arrival_angle + before.arrival_angle_rate)
    assert np.isnan(after.measurement).all()
    assert [notice.culprit for notice in update.notices] == ["subspace"]
    assert set(stage.update(estimates[3]).tracks.status) == {TrackStatus.CONFIRMED}
    last = replace(empty, stamp=estimates[3].stamp + 10**9, next_stamp=END_OF_DATA)
    assert stage.update(last).notices == ()


def test_rejected_estimates_leave_the_tracker_as_it_was() -> None:
    estimates = estimated(crossing_data(7, 0.0, 2.0))
    stage = BearingTrackerStage(given())
    stage.update(estimates[0])
    stage.update(estimates[1])
    spoiled = estimates[2].basis.copy()
    spoiled[3, 4, 1] = np.nan
    for bad, sentence in [
        (replace(estimates[2], basis=spoiled), "not finite"),
        (replace(estimates[2], basis=estimates[2].basis[:, :14]), "15 elements"),
        (replace(estimates[2], time_offsets=np.zeros(3)), "3 time offsets"),
        (replace(estimates[2], basis=np.ones((7, 15, 15), complex)), "between 1 and 14"),
        (estimates[1], "repeats it"),
    ]:
        with pytest.raises(InputError, match=sentence):
            stage.update(bad)
    expected = tracked(estimates, given())[2]
    assert np.array_equal(stage.update(estimates[2]).tracks.arrival_angle, expected.arrival_angle)


def test_variance_needs_a_covariance_when_it_is_not_given() -> None:
    estimates = estimated(crossing_data(8, 0.0, 1.0), replace(PAST, covariance_snapshots=0))
    stage = BearingTrackerStage(given(measurement_variance_deg2=0.0))
    stage.update(estimates[0])
    update = stage.update(estimates[1])
    assert "covariance_snapshots" in update.notices[0].text
    assert set(update.tracks.status) == {TrackStatus.COASTED}


def test_signal_to_noise_ratio_is_reported() -> None:
    data = snapshots_of(
        np.random.default_rng(9),
        np.broadcast_to(np.deg2rad([-30.0, 20.0]), (604, 2)),
        [0.0, 10.0],
    )
    estimates = estimated(
        data,
        SubspaceConfiguration(period=1.0, source_count=2, covariance_snapshots=400, n_subspaces=1),
    )
    ratios = tracked(
        estimates,
        given(initial_bearings_deg=(-30.0, 20.0), initial_rates_deg=(0.0, 0.0)),
    )[-1].signal_to_noise_ratio
    assert 10.0 * np.log10(ratios) == pytest.approx([0.0, 10.0], abs=0.6)


def test_fold_is_what_a_line_array_can_tell() -> None:
    angles = np.deg2rad([10.0, 95.0, -100.0, 179.0, 270.0, 365.0, np.nan])
    folded, signs = folded_angles(angles, POSITIONS)
    expected = [10.0, 85.0, -80.0, 1.0, -90.0, 5.0, np.nan]
    assert np.rad2deg(folded) == pytest.approx(expected, nan_ok=True)
    assert np.allclose(np.sin(folded[:6]), np.sin(angles[:6]))
    assert list(signs[:4]) == [1.0, -1.0, -1.0, -1.0]
    around, _ = folded_angles(angles, POSITIONS[:, [1, 0, 2]])
    assert np.rad2deg(around[3:5]) == pytest.approx([179.0, -90.0])


def test_target_that_passes_endfire_stays_tracked() -> None:
    # sin(theta) rises to 1 at t = 5 s and falls again: 78 -> 90 -> 78 deg.
    times = np.arange(-200, 2100) / 200.0
    unfolded = np.deg2rad(78.0 + 2.4 * times)
    truth = np.arcsin(np.sin(unfolded))
    data = snapshots_of(np.random.default_rng(10), truth[:, None], 20.0)
    tracks = tracked(
        estimated(data, SubspaceConfiguration(period=1.0, source_count=1)),
        given(
            initial_bearings_deg=(78.0,),
            initial_rates_deg=(2.4,),
            measurement_variance_deg2=0.0,
            process_noise_deg2=0.01,
        ),
    )
    angles = np.rad2deg([track.arrival_angle[0] for track in tracks])
    expected = np.rad2deg(np.arcsin(np.sin(np.deg2rad(78.0 + 2.4 * np.arange(11)))))
    assert np.abs(angles).max() <= 90.0
    assert np.abs(angles - expected).max() < 2.0
    assert tracks[-1].arrival_angle_rate[0] < 0.0
    # Hardly any information at endfire: the variance says so.
    variances = [track.measurement_variance[0] for track in tracks[1:]]
    assert max(variances) > 10.0 * min(variances)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["past", "covariance"])
def test_calibrated_tracker_knows_its_errors(method: str) -> None:
    # Well separated bearings, correlated fusion, variance from the Fisher information: NIS near 1.
    times = np.arange(-200, 30 * 200 + 100) / 200.0
    truth = np.deg2rad([-50.0, -25.0, 0.0, 25.0, 50.0]) + np.deg2rad(
        0.3 * times[:, None] * np.array([1, -1, 1, -1, 1])
    )
    data = snapshots_of(np.random.default_rng(11), truth, 0.0, batch=(10,))
    tracks = tracked(
        estimated(data, replace(PAST, method=method, forgetting_factor=0.95)),
        given(
            initial_bearings_deg=(-50.0, -25.0, 0.0, 25.0, 50.0),
            initial_rates_deg=(0.3, -0.3, 0.3, -0.3, 0.3),
            measurement_variance_deg2=0.0,
            fused_variance="correlated",
            phase_reference="array_centre",
            process_noise_deg2=1e-4,
        ),
    )[5:]
    predicted = [
        predict(
            KalmanState(np.zeros(2), track.covariance),
            transition_matrix(1.0),
            process_noise_matrix(1e-4 * np.deg2rad(1.0) ** 2, 1.0),
        ).covariance
        for track in tracks[:-1]
    ]
    # Of a target measured where it was 19 snapshots ago (the mean age of the window).
    H = np.array([1.0, -19.0 / 200.0])
    nis = [
        track.innovation**2 / (np.einsum("i,...ij,j", H, P, H) + track.measurement_variance)
        for track, P in zip(tracks[1:], predicted, strict=True)
    ]
    assert 0.8 < np.mean(nis) < 1.25


def test_parameters_that_do_not_fit_together() -> None:
    for configuration, sentence in [
        (BearingTrackerConfiguration(start="given"), "initial_bearings_deg is empty"),
        (given(initial_rates_deg=(1.0,)), "one rate for each bearing"),
        (given(start="automatic"), "need start = given"),
    ]:
        with pytest.raises(ConfigurationError, match=sentence):
            BearingTrackerStage(configuration)
    estimates = estimated(crossing_data(12, 0.0, 0.0))
    many = given(
        initial_bearings_deg=tuple(np.linspace(-60.0, 60.0, 15)), initial_rates_deg=(0.0,) * 15
    )
    with pytest.raises(InputError, match="15 bearings but the array has only 15 elements"):
        BearingTrackerStage(many).update(estimates[0])


def test_identifiers_are_not_used_again_after_a_reset() -> None:
    estimates = estimated(crossing_data(13, 0.0, 1.0))
    stage = BearingTrackerStage(given())
    first = stage.update(estimates[0]).tracks.id
    stage.reset()
    again = stage.update(estimates[0]).tracks.id
    assert not set(first.tolist()) & set(again.tolist())
