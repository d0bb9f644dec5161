"""A plane wave must give its own power at its own angle, whatever the array; no beam is special."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.display.waterfalls.beam_power import beam_power_row
from sonar_tracking.display.waterfalls.broadband_energy import BroadbandEnergy, array_band
from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import ArraySnapshots, Sensor
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS

LINE = line_array(16, 0.5)
CIRCLE = np.array(
    [[2.0 * np.cos(a), 2.0 * np.sin(a), 0.0] for a in np.linspace(0.0, 2.0 * np.pi, 12, False)]
)
SPEED, RATE, POWER = 1500.0, 4000.0, 7.0
BEGIN = 1_767_225_600 * NANOSECONDS


def wave(positions: FloatArray, angle: float, count: int = 4) -> ArraySnapshots:
    """Return snapshots of a plane wave of power POWER."""
    vector = steering_vectors(positions, [angle], wavenumber(1000.0, SPEED))
    phases = np.exp(1j * np.arange(count))
    return ArraySnapshots(
        stamp=BEGIN,
        data=np.sqrt(POWER) * phases[:, None] * vector.T,
        element_positions=positions,
        sample_period=0.1,
        center_frequency=1000.0,
        bandwidth=9.0,
        sound_speed=SPEED,
        sensor=Sensor(orientation=(0.0, 0.0, np.sin(0.25), np.cos(0.25))),
    )


@pytest.mark.parametrize("positions", [LINE, CIRCLE, LINE[:, [1, 0, 2]]])
@pytest.mark.parametrize("degrees", [-90.0, -37.0, 0.0, 60.0, 90.0, 179.0])
def test_a_plane_wave_has_its_power_at_its_angle(positions: FloatArray, degrees: float) -> None:
    angle = np.radians(degrees)
    row = beam_power_row(wave(positions, angle))
    assert row is not None
    assert float(row.power.max()) == pytest.approx(POWER, rel=0.025)
    beams = row.axis.angles
    seen = np.stack([np.sin(beams), np.cos(beams)], axis=1)[np.argmax(row.power)]
    if positions is LINE:
        assert seen[0] == pytest.approx(np.sin(angle), abs=0.02)
    elif positions is CIRCLE:
        np.testing.assert_allclose(seen, [np.sin(angle), np.cos(angle)], atol=0.03)
    assert row.axis_azimuth == pytest.approx(0.5)
    assert row.integrated == pytest.approx(0.4)
    assert row.end - row.begin == 400_000_000


def test_beams_of_a_line_reach_endfire_and_others_close_the_circle() -> None:
    line, circle = beam_power_row(wave(LINE, 0.1)), beam_power_row(wave(CIRCLE, np.pi))
    assert line is not None and circle is not None
    np.testing.assert_allclose(line.axis.angles[[0, -1]], [-np.pi / 2, np.pi / 2])
    assert circle.axis.first + circle.axis.count * circle.axis.step == pytest.approx(np.pi)
    # The pattern goes on across the seam: its two neighbours see the wave alike.
    assert circle.power[1] == pytest.approx(circle.power[-1], rel=1e-3)


def test_white_noise_is_the_same_in_all_beams() -> None:
    generator = np.random.default_rng(3)
    noise = generator.normal(size=(20_000, 32)).view(np.complex128)
    row = beam_power_row(replace(wave(LINE, 0.0), data=noise))
    assert row is not None
    np.testing.assert_allclose(row.power, 2.0 / 16.0, rtol=0.06)


def test_elements_without_numbers_are_left_out() -> None:
    block = wave(LINE, 0.3)
    block.data[1, 4] = np.nan
    row = beam_power_row(block)
    assert row is not None and float(row.power.max()) == pytest.approx(POWER, rel=0.025)
    block.data[0, :8] = np.nan
    assert beam_power_row(block) is None
    assert beam_power_row(replace(block, data=np.empty((0, 16), complex))) is None


def samples(angle: float, frequency: float, seconds: float, begin: int = BEGIN) -> ArraySamples:
    """Return a tone of power POWER from an angle."""
    times = np.arange(round(seconds * RATE)) / RATE + (begin - BEGIN) / NANOSECONDS
    lead = LINE[:, 0] * np.sin(angle) / SPEED
    data = np.sqrt(2.0 * POWER) * np.cos(2.0 * np.pi * frequency * (times[:, None] + lead))
    return ArraySamples(begin, data, LINE, RATE, SPEED)


@pytest.mark.parametrize("degrees", [-90.0, -20.0, 45.0])
def test_broadband_energy_is_the_power_in_the_band(degrees: float) -> None:
    energy = BroadbandEnergy()
    row = energy.row(samples(np.radians(degrees), 1000.0, 1.0))
    assert row is not None
    assert float(row.power.max()) == pytest.approx(POWER, rel=0.025)
    best = np.argmax(row.power)
    assert np.sin(row.axis.angles[best]) == pytest.approx(np.sin(np.radians(degrees)), abs=0.03)
    outside = BroadbandEnergy().row(samples(0.0, 200.0, 1.0))
    assert outside is not None and outside.power.max() < 1e-3 * POWER


def test_the_band_is_the_highest_octave_with_one_beam() -> None:
    assert array_band(LINE, RATE, SPEED) == (750.0, 1500.0)
    assert array_band(LINE, 2000.0, SPEED) == (400.0, 800.0)
    assert array_band(LINE[:1], 2000.0, SPEED) == (400.0, 800.0)


def test_blocks_of_any_length_give_the_same_energy_and_touching_rows() -> None:
    whole = BroadbandEnergy().row(samples(0.4, 1000.0, 1.5))
    energy, rows = BroadbandEnergy(), []
    for index in range(15):
        begin = BEGIN + index * 100_000_000
        row = energy.row(samples(0.4, 1000.0, 0.1, begin))
        rows += [row] if row else []
    assert whole is not None
    assert rows[0].begin == whole.begin and rows[-1].end == whole.end
    assert all(a.end == b.begin for a, b in itertools.pairwise(rows))
    mean = np.average([r.power for r in rows], axis=0, weights=[r.integrated for r in rows])
    np.testing.assert_allclose(mean, whole.power, rtol=1e-4)


def test_a_gap_in_the_samples_is_not_bridged() -> None:
    energy = BroadbandEnergy()
    first = energy.row(samples(0.4, 1000.0, 1.0))
    later = energy.row(samples(0.4, 1000.0, 1.0, BEGIN + 5 * NANOSECONDS))
    assert first is not None and later is not None
    assert later.begin >= BEGIN + 5 * NANOSECONDS
    assert later.power.max() == pytest.approx(POWER, rel=0.025)
