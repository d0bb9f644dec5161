"""Existence of tracks: evidence, bounds, silence, and nothing decided where nothing is resolved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.bearings.track_existence import (
    CEILING,
    FLOOR,
    Evidence,
    existence_evidence,
)
from sonar_tracking.passive.directions.sources_at_angles import unresolved
from sonar_tracking.records.bearings import SubspaceEstimates
from tests.passive.block_scene import COHERENT, INCOHERENT, exact_covariance, noise_colour
from tests.passive.crossing_scene import (
    FREQUENCY,
    POSITIONS,
    SAMPLE_PERIOD,
    SOUND_SPEED,
    WAVENUMBER,
)

ANGLES = np.deg2rad([-10.0, 2.0, 40.0])
"""Two sources and a place without one."""


def estimates_of(sources: np.ndarray, correlation: float = 0.0) -> SubspaceEstimates:
    """Return estimates with an exact covariance of the two sources in noise of power 0.7."""
    return SubspaceEstimates(
        stamp=0,
        method="covariance",
        basis=np.eye(15, 2, dtype=complex)[None],
        time_offsets=np.zeros(1),
        element_positions=POSITIONS,
        sample_period=SAMPLE_PERIOD,
        center_frequency=FREQUENCY,
        bandwidth=10.0,
        sound_speed=SOUND_SPEED,
        effective_snapshots=100.0,
        covariance=exact_covariance(sources, correlation),
        covariance_snapshots=100,
        covariance_time_offset=0.0,
        noise_power=np.array(0.7),
        noise_covariance=noise_colour(correlation) if correlation else None,
    )


@pytest.mark.parametrize("sources", [INCOHERENT, COHERENT], ids=["incoherent", "coherent"])
@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_sources_are_seen_and_empty_places_are_not(sources: np.ndarray, correlation: float) -> None:
    evidence = existence_evidence(estimates_of(sources, correlation), ANGLES, np.zeros(3), 1.0)
    assert evidence.unseen.tolist() == [False, False, True]
    assert evidence.log_ratio[:2].min() > 20.0


def test_snapshots_that_were_used_before_do_not_count_again() -> None:
    whole = existence_evidence(estimates_of(INCOHERENT), ANGLES, np.zeros(3), 1.0)
    part = existence_evidence(estimates_of(INCOHERENT), ANGLES, np.zeros(3), 0.05)
    assert part.log_ratio == pytest.approx(0.1 * whole.log_ratio)


def test_a_fast_track_is_looked_for_where_it_was_in_the_middle_of_the_block() -> None:
    estimates = replace(estimates_of(INCOHERENT), covariance_time_offset=-2.0)
    late, rates = ANGLES[:2] + 0.2, np.array([0.1, 0.1])
    assert not existence_evidence(estimates, late, rates, 1.0).unseen.any()


def test_nothing_is_told_of_tracks_the_array_does_not_resolve() -> None:
    angles = np.deg2rad([-10.0, 39.0, 40.0])
    evidence = existence_evidence(estimates_of(INCOHERENT), angles, np.zeros(3), 1.0)
    assert np.isnan(evidence.log_ratio).tolist() == [False, True, True]
    probability = np.full(3, 0.5)
    assert evidence.update(probability, 1.0, 1.5)[1:] == pytest.approx(0.5)
    assert unresolved(angles, angles, estimates_of(INCOHERENT)).sum() == 5


def test_nothing_is_told_without_covariance_or_noise_power() -> None:
    estimates = estimates_of(INCOHERENT)
    for empty in (
        replace(estimates, covariance=None),
        replace(estimates, noise_power=np.array(np.nan)),
    ):
        assert np.isnan(existence_evidence(empty, ANGLES, np.zeros(3), 1.0).log_ratio).all()


def test_probability_stays_between_floor_and_ceiling() -> None:
    for log_ratio, bound in ((500.0, CEILING), (-500.0, FLOOR)):
        probability = np.array([0.5])
        for _ in range(60):
            probability = Evidence(np.array([log_ratio])).update(probability, 1.0, 1.5)
        assert probability == pytest.approx(bound)


def test_silence_counts_by_its_duration_and_not_by_its_number_of_blocks() -> None:
    silent = Evidence(np.array([-np.inf]))
    long = silent.update(np.array([0.99]), 2.0, 1.5)
    short = np.array([0.99])
    for _ in range(20):
        short = silent.update(short, 0.1, 1.5)
    # The odds fall by e in each silence_time.
    assert short == pytest.approx(long)
    assert long / (1.0 - long) == pytest.approx(99.0 * np.exp(-2.0 / 1.5))


@pytest.mark.parametrize(("log_ratio", "interval"), [(2.0, 0.5), (-3.0, 0.5), (50.0, 1.0)])
def test_evidence_counts_for_the_part_of_the_silence_time_that_has_passed(
    log_ratio: float, interval: float
) -> None:
    """A source may fall silent: odds times e^-t/tau + (1 - e^-t/tau) times the ratio."""
    silent = np.exp(-interval / 4.0)
    ratio = silent + (1.0 - silent) * np.exp(min(log_ratio, 20.0))
    odds = 0.3 / 0.7 * ratio
    expected = min(max(odds / (1.0 + odds), 0.01), 0.99)
    evidence = Evidence(np.array([log_ratio, np.nan]))
    updated = evidence.update(np.array([0.3, 0.3]), interval, 4.0)
    assert updated == pytest.approx([expected, 0.3])
    assert evidence.unseen.tolist() == [log_ratio < 0.0, False]


def test_the_ratio_of_likelihoods_is_that_of_the_power_along_the_track() -> None:
    """N (r x / (1 + x) - ln(1 + x)) with the excess x = r - 1, or 5 / sqrt(N) if that is more."""
    angles = np.array([0.3])
    vector = steering_vectors(POSITIONS, angles, WAVENUMBER)
    for ratio in (0.9, 1.2, 3.0):
        covariance = np.eye(15) + (ratio - 1.0) / 15.0 * vector @ vector.conj().T
        seen = replace(estimates_of(INCOHERENT), covariance=covariance, noise_power=np.array(1.0))
        for interval, share in [(2.0, 1.0), (0.25, 0.5)]:
            evidence = existence_evidence(seen, angles, np.zeros(1), interval)
            excess = max(ratio - 1.0, 0.5)
            expected = 100.0 * share * (ratio * excess / (1.0 + excess) - np.log1p(excess))
            assert evidence.log_ratio == pytest.approx([expected])
