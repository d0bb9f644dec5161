"""Protects which bins are analysed and what a beam may hear, by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sonar_tracking.passive.lines.line_analysis import LineAnalysis
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.lines.sample_frames import SampleFrame
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.lines import Beams
from sonar_tracking.records.samples import ArraySamples
from tests.passive.sample_scene import POSITIONS, SOUND_SPEED, Tone, element_samples


def analysis(
    rate: float = 1000.0, positions: FloatArray = POSITIONS, **parameters: Any
) -> LineAnalysis:
    samples = ArraySamples(
        stamp=1,
        data=np.zeros((1, len(positions))),
        element_positions=positions,
        sample_rate=rate,
        sound_speed=SOUND_SPEED,
    )
    return LineAnalysis(LineTrackerConfiguration(**parameters), samples)


@pytest.mark.parametrize(
    ("parameters", "bins", "inside"),
    [
        # Half a hertz a bin: to 0.8 of 500 Hz, and 40 + 3 bins beyond for the background; not
        # below bin 3 nor above 2 bins under half the sample rate.
        ({}, (3, 844), (20, 800)),
        ({"minimum_frequency": 100.0, "maximum_frequency": 300.0}, (157, 644), (200, 600)),
        ({"minimum_frequency": 99.9, "maximum_frequency": 300.2}, (157, 644), (200, 600)),
        ({"background_half_width": 5.0}, (7, 814), (20, 800)),
        ({"maximum_frequency": 499.0}, (3, 998), (20, 997)),
        ({"maximum_frequency": 1e6, "minimum_frequency": 600.0}, (1157, 1160), (0, 0)),
        ({"background_half_width": 0.1, "minimum_frequency": 100.0}, (195, 806), (200, 800)),
    ],
)
def test_bins_analysed_and_bins_looked_at_for_their_background(
    parameters: dict[str, Any], bins: tuple[int, int], inside: tuple[int, int]
) -> None:
    made = analysis(**parameters)
    assert (made.frame_length, made.bin_width) == (2.0, 0.5)
    assert (made.first_bin, made.last_bin) == bins
    numbers = np.arange(*bins)[made.inside]
    assert ((numbers[0], numbers[-1]) if len(numbers) else (0, 0)) == inside


def test_frames_have_an_even_number_of_samples() -> None:
    made = analysis(rate=1003.0, frame_length=1.0)  # 501.5 samples a half: 502
    assert made.frame_length == pytest.approx(1004.0 / 1003.0)
    assert made.bin_width == pytest.approx(1003.0 / 1004.0)


def test_aliasing_is_judged_at_the_highest_frequency_looked_at() -> None:
    """Elements 1.8 m apart are half a wavelength at 416.7 Hz."""
    assert analysis(maximum_frequency=416.0).notices() == ()
    assert len(analysis(maximum_frequency=417.0).notices()) == 1
    assert analysis(maximum_frequency=20.0, minimum_frequency=30.0).notices() == ()


def heard(tones: list[Tone], beam_deg: float = 20.0, **parameters: Any) -> list[tuple[int, float]]:
    made = analysis(**parameters)
    spectra = made.spectra(element_samples(tones, 2.0))
    used = np.ones(16, dtype=bool)
    power = made.beam_powers(spectra, used, np.radians([beam_deg]))
    normalised = made.normaliser.normalise(power)
    lines = made.hear(spectra, used, power, normalised, np.array([7], dtype=np.uint64))
    return [(line.track_id, round(line.frequency)) for line, _ in lines]


def test_lines_of_own_ship_are_left_out_to_the_edge_of_the_tolerance() -> None:
    tones = [Tone(150.0, 20.0, 50.0), Tone(220.0, 20.0, 50.0)]
    assert heard(tones) == [(7, 150), (7, 220)]
    for tolerance, left in [(1.1, [(7, 220)]), (0.9, [(7, 150), (7, 220)])]:
        own: dict[str, Any] = {
            "own_ship_frequencies": (151.0, 90.0),
            "own_ship_tolerance": tolerance,
        }
        assert heard(tones, **own) == left


def test_lines_outside_the_band_are_not_heard() -> None:
    tones = [Tone(150.0, 20.0, 50.0), Tone(220.0, 20.0, 50.0), Tone(290.0, 20.0, 50.0)]
    assert heard(tones, minimum_frequency=200.0, maximum_frequency=250.0) == [(7, 220)]
    assert heard(tones, minimum_frequency=220.0, maximum_frequency=290.0) == [(7, 220), (7, 290)]


def test_a_line_that_another_direction_hears_louder_by_the_margin_is_none_of_this_beam() -> None:
    """5 deg beside the tone a beam of 16 elements is 3.4 dB down at 301 Hz."""
    tone = [Tone(301.0, 25.0, 60.0)]
    for margin, expected in [(3.0, []), (4.0, [(7, 301)])]:
        assert heard(tone, ownership_margin_db=margin) == expected


def test_a_row_is_the_level_over_the_background_in_decibel() -> None:
    made = analysis(minimum_frequency=100.0, maximum_frequency=200.0)
    normalised = np.ones((1, made.last_bin - made.first_bin))
    normalised[0, made.inside] = 100.0
    normalised[0, np.flatnonzero(made.inside)[1]] = 0.0
    frame = SampleFrame(5, 6, None, Sensor(frame_id="there"))
    beams = Beams(np.array([7], dtype=np.uint64), np.zeros(1), np.ones(1))
    rows = made.rows(frame, beams, normalised)
    assert (rows.stamp, rows.frame_id, rows.bin_width) == (5, "there", 0.5)
    assert rows.first_frequency == 100.0
    assert rows.level_db.shape == (1, 201)
    assert rows.level_db[0, :3].tolist() == [20.0, -100.0, 20.0]
