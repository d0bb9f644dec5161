"""Samples and LOFAR rows survive their messages; malformed ones are refused by name."""

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.sample_writing import (
    lofar_rows_to_message,
    samples_to_message,
)
from sonar_tracking.message_reading.sample_reading import (
    lofar_rows_from_message,
    samples_from_message,
)
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.lines import LofarRows
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA

GENERATOR = np.random.default_rng(3)


def samples() -> ArraySamples:
    return ArraySamples(
        stamp=1_767_225_600_123_456_789,
        data=GENERATOR.standard_normal((5, 3)).astype(np.float32).astype(np.float64),
        element_positions=GENERATOR.standard_normal((3, 3)),
        sample_rate=2000.0,
        sound_speed=1490.0,
        next_stamp=END_OF_DATA,
        sensor=Sensor("tow", "tow/array", (1.0, 2.0, 3.0), (0.0, 0.0, 0.6, 0.8), (4.0, 5.0, 0.0)),
    )


def rows(n_beams: int = 2) -> LofarRows:
    return LofarRows(
        stamp=1_767_225_600_000_000_001,
        track_id=np.array([7, (3 << 32) + 1], np.uint64)[:n_beams],
        first_frequency=10.5,
        bin_width=0.5,
        level_db=GENERATOR.standard_normal((n_beams, 9)).astype(np.float32),
        frame_id="own_ship/array",
    )


def test_samples_survive_their_message() -> None:
    record = samples()
    read = samples_from_message(samples_to_message(record))
    np.testing.assert_array_equal(read.data, record.data)
    np.testing.assert_array_equal(read.element_positions, record.element_positions)
    for name in ("stamp", "next_stamp", "sample_rate", "sound_speed", "sensor"):
        assert getattr(read, name) == getattr(record, name)


def test_lofar_rows_survive_their_image() -> None:
    record = rows()
    message = lofar_rows_to_message(record)
    assert (message.encoding, message.height, message.width) == ("32FC1", 2, 9)
    first_row = np.frombuffer(bytes(message.data[: 4 * message.width]), np.float32)
    np.testing.assert_array_equal(first_row, record.level_db[0])
    read = lofar_rows_from_message(message)
    np.testing.assert_array_equal(read.level_db, record.level_db)
    np.testing.assert_array_equal(read.track_id, record.track_id)
    for name in ("stamp", "first_frequency", "bin_width", "frame_id"):
        assert getattr(read, name) == getattr(record, name)


def test_rows_of_no_beam_are_an_empty_image() -> None:
    read = lofar_rows_from_message(lofar_rows_to_message(rows(0)))
    assert read.level_db.shape == (0, 9) and len(read.track_id) == 0


def test_malformed_messages_are_refused_by_name() -> None:
    message = samples_to_message(samples())
    message.n_samples = 6
    with pytest.raises(InputError, match=r"ArraySamples\.data has 15 values.*6 x 3"):
        samples_from_message(message)
    image = lofar_rows_to_message(rows())
    image.encoding = "mono8"
    with pytest.raises(InputError, match="encoding mono8"):
        lofar_rows_from_message(image)
    image = lofar_rows_to_message(rows())
    image.height = 3
    with pytest.raises(InputError, match="height x step"):
        lofar_rows_from_message(image)
