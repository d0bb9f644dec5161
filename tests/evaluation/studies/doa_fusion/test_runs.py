"""Protects: the study's conventions, against an independent coding, and who is whose track."""

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.batch_runner import run_batches
from sonar_tracking.evaluation.monte_carlo.run_synthesis import snapshot_blocks, true_bearings
from sonar_tracking.evaluation.studies.doa_fusion.runs import (
    LEVELS_DB,
    STEP_TIMES,
    fusion_scenario,
    matched_to_targets,
    track_batch,
)
from sonar_tracking.evaluation.studies.doa_fusion.systems import PROPOSED, RYU
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import BearingTracks, TrackStatus

ELEMENTS, TARGETS, SNAPSHOTS_A_SECOND = 15, 5, 200


def plain_past(data: ComplexArray) -> list[ComplexArray]:
    basis = np.eye(ELEMENTS, TARGETS, dtype=complex)
    inverse = np.eye(TARGETS, dtype=complex)
    bases = []
    for snapshot in data:
        projected = basis.conj().T @ snapshot
        weighted = inverse @ projected
        gain = weighted / (0.86 + np.vdot(projected, weighted).real)
        inverse = (inverse - np.outer(gain, weighted.conj())) / 0.86
        inverse = (inverse + inverse.conj().T) / 2
        basis = basis + np.outer(snapshot - basis @ projected, gain.conj())
        bases.append(basis)
    return bases


def plain_innovations(basis: ComplexArray, angles: FloatArray) -> FloatArray:
    element = np.arange(ELEMENTS)[:, None]
    steering = np.exp(1j * np.pi * element * np.sin(angles))
    derivative = 1j * np.pi * element * np.cos(angles) * steering
    outside = np.eye(ELEMENTS) - basis @ np.linalg.pinv(basis)
    y, u = outside @ steering, outside @ derivative
    return -np.sum(u.conj() * y, axis=0).real / np.sum(np.abs(u) ** 2, axis=0)


def plain_tracker(bases: list[ComplexArray], n_subspaces: int) -> FloatArray:
    """Track in degrees from the truth at time 0; the first basis is that of time -1 s."""
    rates, crossings = np.radians([2.6, 3.0, 0.9, -2.6, -2.5]), np.array([23, 35, 35, 36, -3])
    slope = 1 + (rates * crossings) ** 2
    state = np.degrees([np.arctan(-rates * crossings), rates / slope])
    covariances = [np.diag([6.0, 1.0]) for _ in range(TARGETS)]
    transition = np.array([[1.0, 1.0], [0.0, 1.0]])
    noise = np.array([[1 / 3, 1 / 2], [1 / 2, 1.0]])
    half = (n_subspaces - 1) // 2
    history = []
    for step in range(1, 41):
        state = transition @ state
        centre = (step + 1) * SNAPSHOTS_A_SECOND
        window = range(centre - half, centre + half + 1)
        innovations = [plain_innovations(bases[n], np.radians(state[0])) for n in window]
        innovation = np.degrees(np.mean(innovations, axis=0))
        for target in range(TARGETS):
            predicted = transition @ covariances[target] @ transition.T + noise
            gain = predicted[:, 0] / (predicted[0, 0] + 36.0 / n_subspaces)
            covariances[target] = predicted - np.outer(gain, predicted[0])
            state[:, target] += gain * innovation[target]
        history.append(state[0].copy())
    return np.array(history)


def test_both_trackers_equal_an_independent_coding() -> None:
    (batch,) = run_batches(2, seed=7)
    histories = track_batch(batch)
    blocks = snapshot_blocks(fusion_scenario(), batch.seeds, LEVELS_DB, 200)
    data = np.concatenate([block.data[1, 1] for block in blocks])
    bases = plain_past(data)
    for name, n_subspaces in ((RYU, 1), (PROPOSED, 7)):
        tracked = np.degrees(histories[name].angle[1, 1])
        assert tracked == pytest.approx(plain_tracker(bases, n_subspaces), abs=1e-8)


def track_list(
    identities: list[int], angles_deg: list[float], tentative: int = -1
) -> BearingTracks:
    count = len(identities)
    status = [
        TrackStatus.TENTATIVE if one == tentative else TrackStatus.CONFIRMED for one in identities
    ]
    zeros = np.zeros(count)
    return BearingTracks(
        stamp=1,
        id=np.array(identities, dtype=np.uint64),
        status=np.array(status, dtype=np.uint8),
        arrival_angle=np.radians(angles_deg),
        arrival_angle_rate=zeros,
        covariance=np.tile(np.eye(2), (count, 1, 1)),
        measurement=zeros,
        measurement_variance=zeros + 1.0,
        innovation=zeros,
        signal_to_noise_ratio=zeros,
        existence_probability=zeros,
        ambiguous=zeros.astype(bool),
    )


def test_an_identity_keeps_the_target_it_was_first_confirmed_on() -> None:
    truth = np.radians([[0.0, 10.0], [0.0, 10.0], [0.0, 10.0]])
    tracks = [
        track_list([5, 9], [9.0, 0.5], tentative=9),
        track_list([5, 9], [1.0, 11.0]),
        track_list([9, 5], [12.0, 2.0]),
    ]
    matched = matched_to_targets(tracks, truth)
    angles = np.degrees([one.arrival_angle for one in matched])
    assert np.isnan(angles[0, 0])
    assert angles[:, 1] == pytest.approx([9.0, 1.0, 2.0])
    assert angles[1:, 0] == pytest.approx([11.0, 12.0])


def test_an_extra_track_belongs_to_no_target() -> None:
    truth = np.radians([[0.0, 10.0]])
    (matched,) = matched_to_targets([track_list([1, 2, 3], [0.1, 5.0, 10.1])], truth)
    assert np.degrees(matched.arrival_angle) == pytest.approx([0.1, 10.1])


def test_scored_steps_are_the_forty_seconds_after_the_start() -> None:
    angles, _ = true_bearings(fusion_scenario(), STEP_TIMES)
    assert angles.shape == (40, TARGETS)
    assert np.degrees(angles[22, 0]) == pytest.approx(0.0, abs=1e-9)
