"""Snapshots made of samples: phases of the wave, instants, gaps, the end of the data."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import steering_vectors, wavenumber
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import (
    BandDemodulatorStage,
    chosen_bandwidth,
)
from sonar_tracking.records.bearings import ArraySnapshots, Sensor
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS
from tests.passive.sample_scene import EPOCH, POSITIONS, SOUND_SPEED, Tone, blocks, element_samples

CONFIGURATION = BandDemodulatorConfiguration(300.0, 4.0, 3)


def run(
    stream: list[ArraySamples], configuration: BandDemodulatorConfiguration = CONFIGURATION
) -> list[ArraySnapshots]:
    stage = BandDemodulatorStage(configuration)
    return [block for samples in stream for block in stage.update(samples)]


def joined(snapshots: list[ArraySnapshots]) -> np.ndarray:
    return np.concatenate([block.data for block in snapshots])


def test_a_tone_in_the_band_has_the_phases_of_its_direction() -> None:
    snapshots = run(blocks(element_samples([Tone(300.4, 25.0, 60.0)], 10.0)))
    steering = steering_vectors(POSITIONS, np.radians([25.0]), wavenumber(300.4, SOUND_SPEED))
    data = joined(snapshots)
    np.testing.assert_allclose(
        data / data[:, :1], np.broadcast_to(steering[:, 0], data.shape), atol=0.02
    )


def test_snapshots_are_stamped_where_the_filter_is_centred() -> None:
    """The phase of a tone half a hertz off the centre tells the instant of each snapshot."""
    data = element_samples([Tone(300.5, 0.0, 80.0)], 10.0)
    snapshots = run(blocks(data))
    period = snapshots[0].sample_period
    times = np.concatenate(
        [
            (block.stamp - EPOCH) / NANOSECONDS + period * np.arange(len(block.data))
            for block in snapshots
        ]
    )
    turns = np.angle(joined(snapshots)[:, 0] * np.exp(-2j * np.pi * 0.5 * times))
    np.testing.assert_allclose(turns, turns[0], atol=0.01)


def test_blocks_are_contiguous_and_the_last_one_ends_the_data() -> None:
    snapshots = run(blocks(element_samples([], 10.0)))
    for block, following in pairwise(snapshots):
        assert block.next_stamp == following.stamp
        length = round(len(block.data) * block.sample_period * NANOSECONDS)
        assert following.stamp == block.stamp + length
        assert len(block.data) == 3
    assert snapshots[-1].next_stamp == END_OF_DATA
    assert 1 <= len(snapshots[-1].data) <= 3


def test_the_size_of_the_sample_blocks_does_not_change_a_bit() -> None:
    data = element_samples([Tone(300.4, 25.0, 10.0)], 10.0)
    expected, other = run(blocks(data)), run(blocks(data, 417))
    assert [each.stamp for each in other] == [each.stamp for each in expected]
    np.testing.assert_array_equal(joined(other), joined(expected))


def test_after_a_gap_snapshots_stay_on_the_same_grid() -> None:
    stream = blocks(element_samples([], 20.0), 217)
    whole = run(stream)
    snapshots = run(stream[:25] + stream[28:])
    grid = {block.stamp % round(block.sample_period * NANOSECONDS) for block in whole + snapshots}
    assert len(grid) == 1
    assert snapshots[-1].next_stamp == END_OF_DATA
    kept = {round((block.stamp - EPOCH) / NANOSECONDS / block.sample_period) for block in snapshots}
    assert len(kept) == len(snapshots)


def test_the_default_bandwidth_is_narrow_for_the_array() -> None:
    snapshots = run(blocks(element_samples([], 10.0)), BandDemodulatorConfiguration(300.0))
    assert snapshots[0].bandwidth * np.ptp(POSITIONS[:, 0]) / SOUND_SPEED == pytest.approx(0.05)


def test_what_cannot_be_used_is_refused_with_its_name() -> None:
    first = blocks(element_samples([], 1.0))[0]
    with pytest.raises(InputError, match=r"bandwidth is 30 Hz.*below 5\.556 Hz"):
        BandDemodulatorStage(BandDemodulatorConfiguration(300.0, 30.0)).update(first)
    with pytest.raises(InputError, match="half the sample rate"):
        BandDemodulatorStage(BandDemodulatorConfiguration(700.0, 3.0)).update(first)
    stage = BandDemodulatorStage(CONFIGURATION)
    stage.update(first)
    with pytest.raises(InputError, match="before the end"):
        stage.update(first)
    with pytest.raises(InputError, match="sound_speed changed"):
        stage.update(replace(first, stamp=first.end_stamp, sound_speed=1400.0))


@pytest.mark.parametrize(
    ("center", "bandwidth", "chosen"),
    [
        (300.0, 0.0, 0.05 * 1500.0 / 27.0),  # half of what is narrow for 27 m
        (20.0, 0.0, 2.0),  # but at most a tenth of the centre
        (300.0, 4.0, 4.0),
    ],
)
def test_the_bandwidth_is_the_one_asked_for_or_suits_array_and_centre(
    center: float, bandwidth: float, chosen: float
) -> None:
    configuration = BandDemodulatorConfiguration(center, bandwidth)
    assert chosen_bandwidth(configuration, POSITIONS, SOUND_SPEED) == pytest.approx(chosen)
    one_element = chosen_bandwidth(configuration, POSITIONS[:1], SOUND_SPEED)
    assert one_element == (bandwidth or 0.1 * center)


@pytest.mark.parametrize(("late", "contiguous"), [(0.4, True), (-0.4, True), (0.6, False)])
def test_stamps_may_be_half_a_sample_off(late: float, contiguous: bool) -> None:
    stream = blocks(element_samples([Tone(300.4, 25.0, 10.0)], 6.0))
    off = round(late / 1000.0 * NANOSECONDS)
    snapshots = run(stream[:12] + [replace(each, stamp=each.stamp + off) for each in stream[12:]])
    expected = run(stream)
    same = len(joined(snapshots)) == len(joined(expected))
    assert same == contiguous
    if contiguous:
        np.testing.assert_array_equal(joined(snapshots), joined(expected))


def test_an_overlap_by_a_sample_is_refused() -> None:
    stream = blocks(element_samples([], 2.0))
    stage = BandDemodulatorStage(CONFIGURATION)
    stage.update(stream[0])
    overlap = replace(stream[1], stamp=stream[1].stamp - round(0.6e-3 * NANOSECONDS))
    with pytest.raises(InputError, match="begins 1 samples before the end"):
        stage.update(overlap)
    stage.update(stream[1])


def test_a_snapshot_carries_its_band_and_the_sensor_at_its_instant() -> None:
    stream = [
        replace(
            each,
            sensor=Sensor(
                position=(5.0 * (each.stamp - EPOCH) / NANOSECONDS, 0.0, 0.0),
                velocity=(5.0, 0.0, 0.0),
            ),
        )
        for each in blocks(element_samples([], 4.0))
    ]
    for block in run(stream):
        assert block.sensor.position[0] == pytest.approx(5.0 * (block.stamp - EPOCH) / NANOSECONDS)
        assert (block.center_frequency, block.bandwidth, block.sound_speed) == (300.0, 4.0, 1500.0)
        assert block.sample_period == 0.25
        np.testing.assert_array_equal(block.element_positions, POSITIONS)
