"""Frames of a stream: aligned to stamps, independent of the blocks, honest about gaps."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.passive.lines.sample_frames import (
    MAXIMUM_GAP,
    SampleFrame,
    SampleFramer,
    check_samples_block,
    check_unchanged,
)
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS
from tests.passive.sample_scene import EPOCH, POSITIONS, RATE, blocks

RAMP = np.arange(7000.0)[:, None] * np.ones(len(POSITIONS))


def cut(stream: list[ArraySamples], framer: SampleFramer | None = None) -> list[SampleFrame]:
    framer = framer or SampleFramer(2.0)
    return [frame for block in stream for frame in framer.frames(block)]


def seconds(frames: list[SampleFrame]) -> list[float]:
    return [(frame.stamp - EPOCH) / NANOSECONDS for frame in frames]


def test_frames_overlap_by_half_and_are_stamped_in_their_middle() -> None:
    frames = cut(blocks(RAMP))
    assert seconds(frames) == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    for index, frame in enumerate(frames[:-1]):
        assert frame.samples is not None
        np.testing.assert_array_equal(frame.samples[:, 0], 1000 * index + np.arange(2000))


def test_each_frame_announces_the_next_and_the_unfinished_one_ends_the_data() -> None:
    frames = cut(blocks(RAMP))
    for frame, following in pairwise(frames):
        assert frame.next_stamp == following.stamp
    assert frames[-1].next_stamp == END_OF_DATA
    assert frames[-1].samples is None


@pytest.mark.parametrize("duration", [0.5, 3.0])
def test_frames_begin_at_multiples_of_half_their_length(duration: float) -> None:
    late = replace(blocks(RAMP, len(RAMP))[0], stamp=EPOCH + NANOSECONDS // 10)
    frames = cut([late], SampleFramer(duration))
    begins = [(frame.stamp - EPOCH) / NANOSECONDS - 0.5 * duration for frame in frames]
    np.testing.assert_allclose(np.diff(begins), 0.5 * duration, atol=1e-9)
    assert begins[0] >= 0.1
    assert begins[0] == pytest.approx(0.25 if duration == 0.5 else 1.5)


@pytest.mark.parametrize("block_samples", [7000, 333, 1000])
def test_the_size_of_the_blocks_does_not_matter(block_samples: int) -> None:
    expected, frames = cut(blocks(RAMP)), cut(blocks(RAMP, block_samples))
    assert [frame.stamp for frame in frames] == [frame.stamp for frame in expected]
    for frame, other in zip(frames[:-1], expected[:-1], strict=True):
        np.testing.assert_array_equal(frame.samples, other.samples)


def test_a_recording_that_begins_later_has_the_same_frames() -> None:
    late = blocks(RAMP)[5:]
    frames, expected = cut(late), cut(blocks(RAMP))[2:]
    assert seconds(frames) == seconds(expected)
    for frame, other in zip(frames[:-1], expected[:-1], strict=True):
        np.testing.assert_array_equal(frame.samples, other.samples)


def test_a_lost_block_empties_the_frames_it_belongs_to_and_no_other() -> None:
    stream = blocks(RAMP)
    del stream[13]  # 3.25 s to 3.5 s
    frames = cut(stream)
    assert seconds(frames) == seconds(cut(blocks(RAMP)))
    empty = [frame.samples is None for frame in frames]
    assert empty == [False, False, True, True, False, False, True]


def test_after_a_long_gap_the_stream_begins_again() -> None:
    framer = SampleFramer(2.0)
    before = cut(blocks(RAMP)[:-1], framer)
    jump = (2 * MAXIMUM_GAP + 10) * NANOSECONDS
    after = cut([replace(each, stamp=each.stamp + jump) for each in blocks(RAMP)], framer)
    assert len(before) == 5
    assert seconds(after)[0] == 2 * MAXIMUM_GAP + 11.0
    assert all(frame.samples is not None for frame in after[:-1])


def test_the_sensor_is_where_it_was_in_the_middle_of_the_frame() -> None:
    stream = [
        replace(
            block,
            sensor=Sensor(
                position=(5.0 * (block.stamp - EPOCH) / NANOSECONDS, 2.0, 0.0),
                velocity=(5.0, 0.0, 0.0),
            ),
        )
        for block in blocks(RAMP)
    ]
    for frame, time in zip(cut(stream), range(1, 8), strict=True):
        assert frame.sensor.position == pytest.approx((5.0 * time, 2.0, 0.0))


def test_unusable_blocks_are_refused_and_change_nothing() -> None:
    stream = blocks(RAMP)
    framer = SampleFramer(2.0)
    cut(stream[:4], framer)
    bad = stream[4].data.copy()
    bad[3, 2] = np.nan
    refused = {
        "not a finite number": replace(stream[4], data=bad),
        "one column": replace(stream[4], data=bad[:, :3]),
        "zero samples": replace(stream[4], data=bad[:0]),
        "before the end": stream[2],
        "sample_rate": replace(stream[4], sample_rate=2.0 * RATE),
        "at least 1000 Hz": replace(stream[4], sample_rate=500.0),
        "sound_speed": replace(stream[4], sound_speed=np.nan),
        "element_positions changed": replace(stream[4], element_positions=POSITIONS + 1.0),
        "second publisher": replace(stream[4], sensor=Sensor("other")),
    }
    for sentence, block in refused.items():
        with pytest.raises(InputError, match=sentence):
            framer.frames(block)
    assert seconds(cut(stream[4:], framer)) == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]


def test_data_that_end_before_the_first_frame_begins_end_it_all_the_same() -> None:
    """They begin 0.25 s after a frame did: the next one begins at 1 s, and its middle is at 2 s."""
    stream = blocks(RAMP[:500])
    late = [replace(each, stamp=each.stamp + NANOSECONDS // 4) for each in stream]
    (frame,) = cut(late)
    assert (seconds([frame]), frame.next_stamp, frame.samples) == ([2.0], END_OF_DATA, None)


@pytest.mark.parametrize(
    ("delay", "middle", "first_sample"),
    [
        (0, 1.0, 0),
        (-500, 1.0, 0),  # less than a thousandth of a sample is on time
        (-300_000, 1.0, 1),
        (-1_000_000, 1.0, 1),
        (-1_400_000, 1.0, 2),
        (300_000, 2.0, 1000),
    ],
)
def test_frames_begin_with_the_first_sample_at_or_after_their_instant(
    delay: int, middle: float, first_sample: int
) -> None:
    stream = [replace(each, stamp=each.stamp + delay) for each in blocks(RAMP)]
    frame = next(frame for frame in cut(stream) if frame.samples is not None)
    assert seconds([frame])[0] == pytest.approx(middle, abs=1.1e-3)
    assert frame.samples is not None
    assert frame.samples[0, 0] == first_sample


@pytest.mark.parametrize(
    ("jump", "frames_lost"), [(MAXIMUM_GAP, MAXIMUM_GAP), (MAXIMUM_GAP + 1, 0)]
)
def test_up_to_thirty_frames_in_a_row_are_reported_as_lost(jump: int, frames_lost: int) -> None:
    framer = SampleFramer(2.0)
    cut(blocks(RAMP)[:-1], framer)  # the last block is missing: data end at 6.75 s
    late = [
        replace(each, stamp=each.stamp + 6_750_000_000 + jump * NANOSECONDS)
        for each in blocks(RAMP)
    ]
    frames = [frame for frame in cut(late, framer)[:-1] if frame.samples is None]
    # Each of a second; two more overlap the ends of the data before and after.
    assert len(frames) == (frames_lost + 2 if frames_lost else 0)


def test_a_gap_does_not_move_the_frames_after_it() -> None:
    stream = blocks(RAMP, 333)
    frames = cut(stream[:6] + stream[9:])
    assert seconds(frames) == seconds(cut(stream))
    whole = {frame.stamp: frame.samples for frame in cut(stream)}
    for frame in frames:
        if frame.samples is not None:
            np.testing.assert_array_equal(frame.samples, whole[frame.stamp])


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"element_positions": np.zeros(3)}, r"shape \(3,\)"),
        ({"element_positions": np.zeros((16, 2))}, r"shape \(16, 2\)"),
        ({"element_positions": np.zeros((0, 3)), "data": np.zeros((5, 0))}, r"shape \(0, 3\)"),
        ({"data": np.zeros(16)}, r"shape \(16,\)"),
        ({"sound_speed": 0.0}, "sound_speed is 0"),
        ({"sound_speed": -1500.0}, "sound_speed is -1500"),
        ({"sound_speed": np.inf}, "sound_speed is inf"),
        ({"sample_rate": np.inf}, "sample_rate is inf"),
        ({"sample_rate": 999.9}, "sample_rate is 999.9"),
        ({"element_positions": np.full((16, 3), np.nan)}, "An element position"),
    ],
)
def test_what_is_wrong_with_a_block_is_named(changes: dict[str, Any], sentence: str) -> None:
    block = blocks(RAMP)[0]
    check_samples_block(block)
    with pytest.raises(InputError, match=sentence):
        check_samples_block(replace(block, **changes))


def test_what_changes_during_a_run_is_named() -> None:
    first = blocks(RAMP)[0]
    check_unchanged(first, first)
    for changes, sentence in (
        ({"sound_speed": 1501.0}, "sound_speed changed from 1500 to 1501"),
        ({"sample_rate": 2000.0}, "sample_rate changed from 1000 to 2000"),
        ({"element_positions": POSITIONS[:-1]}, "element_positions changed"),
    ):
        with pytest.raises(InputError, match=sentence):
            check_unchanged(replace(first, **changes), first)
