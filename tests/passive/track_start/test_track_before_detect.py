"""The Bernoulli filter of one faint source: what it finds, what it does not believe."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, wavenumber
from sonar_tracking.passive.directions.beam_excess import BeamExcess, BeamGrid, beam_grid
from sonar_tracking.passive.track_start.track_before_detect import (
    STARTING_ODDS,
    TrackBeforeDetect,
)
from sonar_tracking.records.arrays import FloatArray

INTERVAL, SNAPSHOTS = 2.0, 240.0


def grid() -> BeamGrid:
    made = beam_grid(line_array(15, 0.5), wavenumber(1500.0, 1500.0))
    assert made is not None
    return made


GRID = grid()


def beams(excess: FloatArray, received: float = 0.0) -> BeamExcess:
    return BeamExcess(excess, np.ones(len(excess), dtype=bool), SNAPSHOTS, received, False)


def lobe(angle: float, power: float) -> FloatArray:
    """Return the power that a source brings into all beams, on average."""
    apart = (np.sin(GRID.angles) - np.sin(angle)) / GRID.width
    return np.asarray(power * np.sinc(apart) ** 2)


def drawn(generator: np.random.Generator, mean: FloatArray) -> FloatArray:
    """Return powers about their mean, as smooth from beam to beam as an array makes them."""
    independent = generator.standard_normal(len(mean) + 12)
    smooth = np.convolve(independent, np.hanning(13) / np.linalg.norm(np.hanning(13)), "valid")
    return np.asarray(mean + (1.0 + mean) * smooth / np.sqrt(SNAPSHOTS))


def followed(power: float, rate_deg: float, count: int = 20, seed: int = 1) -> TrackBeforeDetect:
    generator, detector = np.random.default_rng(seed), TrackBeforeDetect()
    for number in range(count):
        angle = np.radians(-20.0 + rate_deg * INTERVAL * number)
        measured = drawn(generator, lobe(angle, power))
        detector = detector.predict(INTERVAL).update(beams(measured), GRID)
    return detector


def test_a_faint_source_is_found_where_it_is_and_as_fast_as_it_is() -> None:
    found = followed(0.4, 0.4).believed(GRID.width)
    assert found is not None
    error = found.mean - np.radians([-20.0 + 0.4 * INTERVAL * 19, 0.4])
    assert 0.5 * error @ np.linalg.solve(found.covariance, error) < 3.0
    assert np.degrees(np.sqrt(found.covariance[0, 0])) < 2.0
    assert found.excess == pytest.approx(0.4, rel=0.5)


@pytest.mark.slow
def test_noise_is_not_believed() -> None:
    generator, detector, most = np.random.default_rng(2), TrackBeforeDetect(), 0.0
    for _ in range(2000):
        measured = drawn(generator, np.zeros(len(GRID.angles)))
        detector = detector.predict(INTERVAL).update(beams(measured), GRID)
        most = max(most, detector.total)
    assert most < 0.1 * STARTING_ODDS


def test_what_lasts_for_one_update_starts_nothing_however_loud() -> None:
    detector = TrackBeforeDetect()
    quiet = np.zeros(len(GRID.angles))
    for number in range(10):
        now = lobe(0.2, 100.0) if number == 5 else quiet
        detector = detector.predict(INTERVAL).update(beams(now), GRID)
        assert detector.believed(GRID.width) is None


def test_what_strong_sources_may_leak_is_not_believed() -> None:
    constant = lobe(0.2, 0.4)
    for received, error, believed in ((0.0, 0.0, True), (50.0, 0.0, False), (10.0, 0.1, False)):
        detector = TrackBeforeDetect()
        for _ in range(30):
            detector = detector.predict(INTERVAL).update(beams(constant, received), GRID, error)
        assert (detector.believed(GRID.width) is not None) is believed


def test_odds_move_with_their_rates_and_leave_no_beam_that_is_not_free() -> None:
    detector = followed(0.4, 0.0)
    later = detector.predict(10.0)
    means = later.odds.sum(axis=-1) @ GRID.angles / later.odds.sum(axis=(-1, -2))
    assert np.all(np.diff(means) > 0.0)
    taken = np.abs(GRID.angles - np.radians(-20.0)) < 0.1
    blocked = BeamExcess(lobe(np.radians(-20.0), 0.4), ~taken, SNAPSHOTS, 0.0, False)
    assert detector.update(blocked, GRID).odds[:, taken].sum() == 0.0


def test_total_odds_stay_finite_beside_a_lasting_source() -> None:
    assert np.isfinite(followed(5.0, 0.0, count=200).total)
