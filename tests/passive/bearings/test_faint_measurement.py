"""Score and information of faint sources: those of the Gaussian likelihood; when none is taken."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.passive.bearings.faint_measurement import fit_with_faint
from sonar_tracking.passive.directions.signal_subspace import signal_subspace
from sonar_tracking.passive.directions.weighted_subspace_fit import SubspaceFit
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

POSITIONS = line_array(15, 0.5)
NUMBER = wavenumber(1500.0, 1500.0)
SNAPSHOTS = 100
POWER = 0.02
FAINT = np.array([15 * POWER])


def wave(angle: float, power: float) -> ComplexArray:
    vector = steering_vectors(POSITIONS, np.array([angle]), NUMBER)
    return np.asarray(power * vector @ vector.conj().T)


ESTIMATES = SubspaceEstimates(
    stamp=0,
    method="covariance",
    basis=np.empty((0, 15, 0), dtype=np.complex128),
    time_offsets=np.empty(0),
    element_positions=POSITIONS,
    sample_period=0.005,
    center_frequency=1500.0,
    bandwidth=100.0,
    sound_speed=1500.0,
    effective_snapshots=100.0,
    covariance_snapshots=SNAPSHOTS,
    noise_power=np.array(1.0),
)


def measured(covariance: ComplexArray, angles: FloatArray, excess: FloatArray) -> SubspaceFit:
    return fit_with_faint(None, None, ESTIMATES, covariance, excess)(angles)


def test_score_is_the_slope_of_the_gaussian_log_likelihood() -> None:
    generator = np.random.default_rng(1)
    drawn = generator.standard_normal((2, SNAPSHOTS, 15))
    snapshots = (drawn[0] + 1j * drawn[1]) / np.sqrt(2.0)
    covariance = np.asarray(snapshots.T @ snapshots.conj() / SNAPSHOTS + wave(0.3, POWER))

    def likelihood(angle: float) -> float:
        model = np.eye(15) + wave(angle, POWER)
        left = np.trace(np.linalg.solve(model, covariance)).real
        return float(-SNAPSHOTS * (np.linalg.slogdet(model)[1] + left))

    step = 1e-5
    slope = (likelihood(0.32 + step) - likelihood(0.32 - step)) / (2.0 * step)
    assert measured(covariance, np.array([0.32]), FAINT).score[0] == pytest.approx(slope, rel=1e-4)


def test_information_is_how_fast_the_expected_score_falls_off_the_source() -> None:
    covariance = np.asarray(np.eye(15) + wave(0.3, POWER))
    step = 1e-4
    before, after = (
        measured(covariance, np.array([0.3 + side]), FAINT).score[0] for side in (-step, step)
    )
    information = measured(covariance, np.array([0.3]), FAINT).information[0, 0]
    assert information == pytest.approx((before - after) / (2.0 * step), rel=1e-3)


def test_a_strong_source_does_not_pull_the_faint_one_beside_it() -> None:
    angles = np.array([0.3, -0.2])
    excess = np.array([FAINT[0], np.nan])
    covariance = np.asarray(np.eye(15) + wave(0.3, POWER) + wave(-0.2, 100.0))
    fit = measured(covariance, angles, excess)
    alone = measured(np.asarray(np.eye(15) + wave(0.3, POWER)), angles[:1], FAINT)
    deviation = 1.0 / np.sqrt(alone.information[0, 0])
    assert abs(fit.score[0]) * deviation < 0.1
    assert fit.information[0, 0] == pytest.approx(alone.information[0, 0], rel=0.1)
    assert fit.score[1] == 0.0 and not fit.information[1].any()


def test_a_source_without_a_track_stops_the_measurement_instead_of_pulling() -> None:
    covariance = np.asarray(np.eye(15) + wave(0.3, POWER) + wave(-0.2, 1.0))
    subspace = signal_subspace(covariance, 1)
    fit = fit_with_faint(None, subspace, ESTIMATES, covariance, FAINT)(np.array([0.3]))
    assert fit.score[0] == 0.0 and fit.information[0, 0] == 0.0
    own = np.asarray(np.eye(15) + wave(0.3, 0.1))
    fit = fit_with_faint(None, signal_subspace(own, 1), ESTIMATES, own, FAINT)(np.array([0.3]))
    assert fit.information[0, 0] > 0.0


def test_told_noise_is_whitened_before_anything_is_measured() -> None:
    lags = np.abs(np.subtract.outer(np.arange(15), np.arange(15)))
    noise = (0.5**lags).astype(np.complex128)
    estimates = replace(ESTIMATES, noise_covariance=noise)
    covariance = np.asarray(noise + wave(0.3, POWER))
    fit = fit_with_faint(None, None, estimates, covariance, FAINT)(np.array([0.3]))
    assert abs(fit.score[0]) < 1e-6 * np.sqrt(fit.information[0, 0])
