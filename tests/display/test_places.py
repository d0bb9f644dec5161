"""Places on pictures and in tables: as the geodesy has them, and never of sixty minutes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.display.chart_graticule import draw_graticule
from sonar_tracking.display.picture_files import new_figure
from sonar_tracking.display.place_text import LATITUDE, LONGITUDE, angle_text, place_text
from sonar_tracking.display.plot_bag import plot_bag
from sonar_tracking.geodesy import surface_places, surface_positions
from sonar_tracking.records.datum import Datum
from tests.bags.bag_fixtures import EPOCH, SECOND
from tests.bags.position_fixtures import POSITIONS, position_tracks_cdr
from tests.display.position_pictures import position_tracks

DATUM = Datum(54.18, 7.89)


def test_a_place_is_in_degrees_and_minutes() -> None:
    assert place_text(np.zeros(2), DATUM) == "54°10.800'N 007°53.400'E"
    assert place_text(np.array([np.nan, 0.0]), DATUM) == "-"
    assert angle_text(-0.9999999, *LONGITUDE) == "001°00.000'W"
    assert angle_text(33.5, *LATITUDE, decimals=0) == "33°30'N"


@pytest.mark.parametrize("datum", [DATUM, Datum(-33.9, 179.99), Datum(0.0, -0.001)])
@pytest.mark.parametrize("half", [20.0, 3000.0, 60_000.0])
def test_ticks_of_a_chart_are_round_angles_where_they_are(datum: Datum, half: float) -> None:
    axes = new_figure(4.0, 4.0).add_subplot()
    low, high = np.array([-half, -half]), np.array([half, half])
    axes.set(xlim=(-half, half), ylim=(-half, half))
    draw_graticule(axes, low, high, 1.0, datum)
    right, top = axes.child_axes
    centre = surface_places(np.zeros(2), datum)
    for axis, ticks, labels, (digits, sides) in (
        (1, right.get_yticks(), right.get_yticklabels(), LATITUDE),
        (0, top.get_xticks(), top.get_xticklabels(), LONGITUDE),
    ):
        texts = [label.get_text() for label in labels]
        assert 2 <= len(ticks) <= 8 and len(set(texts)) == len(texts)
        assert np.all(np.abs(ticks) <= 1.01 * half)
        for tick, text in zip(ticks.tolist(), texts, strict=True):
            whole, _, minutes = text[:-2].partition("°")
            assert len(whole) == digits and float(minutes) < 60.0
            told = (int(whole) + float(minutes) / 60.0) * (1 if text[-1] == sides[0] else -1)
            place = [told, centre[1]] if axis else [centre[0], told]
            there = surface_positions(np.array(place[0]), np.array(place[1]), datum)
            assert there[axis] == pytest.approx(tick, abs=1e-3)


@pytest.mark.slow
def test_a_recording_with_a_datum_has_places_in_its_table(tmp_path: Path) -> None:
    for name, scenario in (("with", {"datum": DATUM.to_mapping()}), ("without", {})):
        writer = BagWriter(tmp_path / name, RecordingInformation(scenario))
        writer.add_topic("/tracks", POSITIONS)
        for second in range(5):
            tracks = position_tracks(second, [[1000.0, -500.0, 1.0, 0.0]])
            writer.write("/tracks", (EPOCH + second) * SECOND, position_tracks_cdr(tracks))
        writer.close()
        plot_bag(tmp_path / name, tmp_path / f"{name}_pictures")
    place = place_text(np.array([1000.0, -500.0]), DATUM)
    told = (tmp_path / "with_pictures" / "tracks.txt").read_text(encoding="utf-8")
    assert place in told and "latitude" in told
    assert "latitude" not in (tmp_path / "without_pictures" / "tracks.txt").read_text()
