"""The picture must show power where the sources are, and a table what became of the tracks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.display.bearing_time_record import N_BEAMS, beam_picture
from sonar_tracking.display.plot_bag import plot_bag
from sonar_tracking.display.summary_table import bearing_summary
from sonar_tracking.display.track_history import track_histories
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.records.bearings import AngleKind, ArraySnapshots, BearingTracks, TrackStatus
from tests.bags.bag_fixtures import CLOCK, EPOCH, SECOND, TRACKS, open_writer, write_messages

POSITIONS = line_array(10, 0.5)


def block(second: int, angle_deg: float) -> ArraySnapshots:
    """Return four snapshots of one source in wavelength units."""
    vector = steering_vectors(POSITIONS, np.radians([angle_deg]), wavenumber(1500.0, 1500.0))
    return ArraySnapshots(
        stamp=(EPOCH + second) * SECOND,
        data=np.tile(3.0 * vector.T, (4, 1)),
        element_positions=POSITIONS,
        sample_period=0.25,
        center_frequency=1500.0,
        bandwidth=4.0,
        sound_speed=1500.0,
    )


def tracks(second: int, **columns: object) -> BearingTracks:
    nan = np.full(2, np.nan)
    values = BearingTracks(
        stamp=(EPOCH + second) * SECOND,
        id=np.array([4, 9], np.uint64),
        status=np.array([TrackStatus.CONFIRMED, TrackStatus.TENTATIVE], np.uint8),
        arrival_angle=np.radians([10.0 + second, -20.0]),
        arrival_angle_rate=nan,
        covariance=np.full((2, 2, 2), np.radians(0.5) ** 2),
        measurement=nan,
        measurement_variance=nan,
        innovation=nan,
        signal_to_noise_ratio=nan,
        existence_probability=nan,
        ambiguous=np.zeros(2, np.bool_),
    )
    return replace(values, **columns)  # type: ignore[arg-type]


def test_the_strongest_beam_points_at_the_source() -> None:
    picture = beam_picture([block(0, -30.0), block(1, 45.0)], 1)
    assert picture.levels_db.shape == (2, N_BEAMS)
    strongest = np.degrees(picture.angles[np.argmax(picture.levels_db, axis=1)])
    np.testing.assert_allclose(strongest, [-30.0, 45.0], atol=0.5)
    np.testing.assert_array_equal(picture.levels_db.max(axis=1), 0.0)


def test_a_line_holds_the_mean_of_its_blocks() -> None:
    picture = beam_picture([block(0, -30.0), block(1, 30.0), block(2, 30.0)], 2)
    assert list(picture.stamps) == [EPOCH * SECOND, (EPOCH + 2) * SECOND]
    both = picture.levels_db[0, [120, 240]]
    np.testing.assert_allclose(both, 0.0, atol=0.1)


def test_blocks_that_are_not_finite_are_left_out() -> None:
    spoilt = replace(block(0, 0.0), data=np.full((4, 10), np.nan, complex))
    assert len(beam_picture([spoilt, block(1, 0.0)], 1).stamps) == 1
    assert len(beam_picture([], 1).stamps) == 0


def test_histories_follow_identifiers_and_do_not_jump_across_the_half_circle() -> None:
    wrapped = tracks(1, arrival_angle=np.radians([10.0, 89.0]))
    far = tracks(2, arrival_angle=np.radians([10.0, -89.0]))
    first, second = track_histories([wrapped, far])
    assert (first.id, second.id) == (4, 9)
    assert first.confirmed and not second.confirmed
    assert np.isnan(second.degrees_with_gaps()).tolist() == [True, False]
    assert not np.isnan(first.degrees_with_gaps()).any()


def test_azimuths_are_compass_bearings_and_do_not_jump_across_north() -> None:
    west = tracks(1, arrival_angle=np.radians([89.0, 0.0]), angle_kind=AngleKind.AZIMUTH)
    east = tracks(2, arrival_angle=np.radians([92.0, 0.0]), angle_kind=AngleKind.AZIMUTH)
    first, second = track_histories([west, east])
    np.testing.assert_allclose(first.degrees, [1.0, 358.0])
    assert np.isnan(first.degrees_with_gaps()).tolist() == [True, False]
    np.testing.assert_allclose(second.degrees_with_gaps(), [90.0, 90.0])
    row = bearing_summary("", [first], EPOCH * SECOND).rows[0]
    assert row[3:5] == ("1.0", "358.0")


def test_the_table_says_when_and_where_a_track_was() -> None:
    from rich.console import Console

    console = Console(width=100)
    with console.capture() as capture:
        histories = track_histories([tracks(1), tracks(5)])
        console.print(bearing_summary("bearings", histories, EPOCH * SECOND).to_rich())
    row = next(line for line in capture.get().splitlines() if line.strip().startswith("4"))
    assert row.split() == ["4", "1.0", "5.0", "+11.0", "+15.0", "0.50", "0"]


@pytest.mark.slow
def test_a_bag_is_drawn_with_its_table(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "run")
    writer.add_topic("/passive/bearing_tracks", TRACKS, role="output")
    writer.close()
    with pytest.raises(ConfigurationError, match="neither snapshots nor contacts nor confirmed"):
        plot_bag(tmp_path / "run", tmp_path / "empty")
    full = open_writer(tmp_path / "full")
    write_messages(full, 5)
    full.close()
    image, *_ = plot_bag(tmp_path / "full", tmp_path / "pictures")
    assert image.read_bytes().startswith(b"\x89PNG") and image.stat().st_size > 5000


def test_a_bag_that_is_not_whole_is_drawn_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    writer = open_writer(tmp_path / "run")
    writer.add_topic("/other", CLOCK)
    write_messages(writer, 5)
    writer.close()
    file = tmp_path / "run" / "run_0.mcap"
    file.write_bytes(file.read_bytes()[:-2500])
    plot_bag(tmp_path / "run", tmp_path / "pictures")
    assert "messages were recovered" in capsys.readouterr().out
