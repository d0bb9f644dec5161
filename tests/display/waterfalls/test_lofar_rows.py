"""Levels must be calibrated: density of noise, power of a tone, in the beam that points at it."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.display.waterfalls.lofar_rows import MOST_COLUMNS, LofarBeams, LofarRow
from sonar_tracking.geometry import line_array
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS
from tests.display.test_bearing_time_record import tracks

POSITIONS = line_array(8, 0.5)
SPEED = 1500.0
BEGIN = 1_767_225_600 * NANOSECONDS


def block(data: np.ndarray, rate: float = 2000.0, begin: int = BEGIN) -> ArraySamples:
    return ArraySamples(begin, data, POSITIONS, rate, SPEED)


def tone(frequency: float, angle: float, amplitude: float, seconds: float = 6.0) -> ArraySamples:
    times = np.arange(round(2000.0 * seconds)) / 2000.0
    lead = POSITIONS[:, 0] * np.sin(angle) / SPEED
    return block(amplitude * np.cos(2.0 * np.pi * frequency * (times[:, None] + lead)))


def rows_at(samples: ArraySamples, *angles: float) -> list[LofarRow]:
    beams = LofarBeams()
    beams.directions = angles
    return beams.rows(samples)


def test_white_noise_has_its_density() -> None:
    noise = np.random.default_rng(2).normal(scale=3.0, size=(40_000, 8))
    rows = rows_at(block(noise), 0.2)
    density = np.mean([10.0 ** (row.level_db / 10.0) for row in rows])
    # Averaging M elements leaves one M-th of the noise: 2 sigma^2 / f_s / M.
    assert density == pytest.approx(2.0 * 9.0 / 2000.0 / 8.0, rel=0.05)


def test_a_tone_has_its_power_over_the_bandwidth_of_the_window() -> None:
    row = rows_at(tone(300.0, 0.5, 4.0), 0.5)[1]
    column = round((300.0 - row.first_frequency) / row.bin_width)
    assert np.argmax(row.level_db) == column
    expected = 10.0 * np.log10(0.5 * 4.0**2 / (1.5 * row.bin_width))
    assert row.level_db[column] == pytest.approx(expected, abs=0.01)
    assert row.bin_width == 0.5


def test_a_beam_elsewhere_hears_less() -> None:
    here, there = rows_at(tone(600.0, 0.5, 4.0), 0.5, -0.6)[:2]
    assert (here.angle, there.angle) == (0.5, -0.6)
    assert here.level_db.max() - there.level_db.max() > 10.0


def test_rows_follow_on_one_another_and_beams_follow_their_tracks() -> None:
    beams = LofarBeams()
    heard: BearingTracks = replace(
        tracks(0),
        stamp=BEGIN,
        arrival_angle=np.array([0.1, 0.3]),
        arrival_angle_rate=np.array([0.01, np.nan]),
        status=np.array([TrackStatus.CONFIRMED, TrackStatus.TENTATIVE], np.uint8),
    )
    beams.take_tracks(heard)
    rows = beams.rows(tone(300.0, 0.5, 1.0))
    assert {row.track_id for row in rows} == {4}
    assert all(a.end == b.begin for a, b in itertools.pairwise(rows))
    middle = (rows[2].begin + rows[2].end) / 2
    assert rows[2].angle == pytest.approx(0.1 + 0.01 * (middle - BEGIN) / NANOSECONDS)


def test_columns_are_few_whatever_the_sample_rate() -> None:
    noise = np.random.default_rng(2).normal(size=(100_000, 8))
    row = rows_at(block(noise, 40_000.0), 0.0)[0]
    assert len(row.level_db) <= MOST_COLUMNS
    top = row.first_frequency + row.bin_width * len(row.level_db)
    assert top == pytest.approx(20_000.0, rel=0.01)


def test_samples_that_fit_nothing_begin_anew() -> None:
    beams = LofarBeams()
    beams.directions = (0.0,)
    assert beams.rows(tone(300.0, 0.0, 1.0))
    assert beams.rows(tone(300.0, 0.0, 1.0)) == []
    assert beams.rows(replace(tone(300.0, 0.0, 1.0), stamp=BEGIN + 60 * NANOSECONDS))
