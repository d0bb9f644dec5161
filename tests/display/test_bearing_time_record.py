"""The picture must show power where the sources are, and a table what became of the tracks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.display.bearing_time_record import MOST_LINES, Waterfall, beam_picture
from sonar_tracking.display.plot_bag import plot_bag
from sonar_tracking.display.summary_table import bearing_summary
from sonar_tracking.display.track_history import track_histories
from sonar_tracking.display.waterfalls.beam_rows import BeamAxis, BeamRow
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.bearings import AngleKind, BearingTracks, TrackStatus
from tests.bags.bag_fixtures import CLOCK, EPOCH, SECOND, TRACKS, open_writer, write_messages

AXIS = BeamAxis(-1.0, 0.1, 21, sine=True)


def row(begin: float, duration: float, sine: float, power: float = 100.0) -> BeamRow:
    """Return a row with one source over noise of power 1."""
    stamp = EPOCH * SECOND + round(begin * SECOND)
    levels = np.ones(AXIS.count)
    levels[round((sine + 1.0) / AXIS.step)] = power
    return BeamRow(stamp, stamp + round(duration * SECOND), AXIS, levels, duration)


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


def test_the_source_stands_over_the_noise_at_its_angle_and_time() -> None:
    picture = beam_picture([row(0.0, 1.0, -0.5), row(1.0, 1.0, 0.5)], EPOCH * SECOND)
    np.testing.assert_allclose(picture.edges, [0.0, 1.0, 2.0])
    assert picture.levels_db.shape == (2, AXIS.count)
    assert len(picture.degrees) == AXIS.count + 1
    np.testing.assert_allclose(picture.levels_db.max(axis=1), 20.0, atol=1e-4)
    loudest = np.argmax(picture.levels_db, axis=1)
    inside = picture.degrees[loudest] < [-30.0, 30.0]
    assert inside.all() and (picture.degrees[loudest + 1] > [-30.0, 30.0]).all()
    np.testing.assert_allclose(picture.degrees[[0, -1]], [-90.0, 90.0])


def test_a_gap_is_left_empty_and_rows_keep_their_times() -> None:
    picture = beam_picture([row(0.0, 1.0, 0.0), row(5.0, 2.0, 0.0)], EPOCH * SECOND)
    np.testing.assert_allclose(picture.edges, [0.0, 1.0, 5.0, 7.0])
    assert np.isnan(picture.levels_db).all(axis=1).tolist() == [False, True, False]


@pytest.mark.slow
def test_a_waterfall_has_all_time_scales_in_bounded_memory() -> None:
    waterfall = Waterfall("narrowband")
    for second in range(3 * MOST_LINES):
        waterfall.add(row(second, 1.0, 0.0, power=float(second % 2) + 1.0))
    scales = waterfall.finished()
    assert list(scales) == [1.0, 5.0, 20.0]
    for rows in scales.values():
        assert len(rows) <= MOST_LINES
        assert sum(each.integrated for each in rows) == pytest.approx(3 * MOST_LINES)
        energy = sum(each.integrated * each.power[10] for each in rows)
        assert energy == pytest.approx(1.5 * 3 * MOST_LINES)


@pytest.mark.parametrize(
    ("duration", "part", "scales"),
    [(300, 0.1, [1.0, 5.0, 20.0]), (41, 0.1, [0.2, 1.0]), (41, 1.0, [1.0]), (3, 1.0, [0.2])],
)
def test_scales_are_drawn_that_have_lines(duration: int, part: float, scales: list[float]) -> None:
    waterfall = Waterfall("narrowband")
    for number in range(round(duration / part)):
        waterfall.add(row(number * part, part, 0.0))
    assert list(waterfall.finished()) == scales


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


@pytest.mark.slow
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
