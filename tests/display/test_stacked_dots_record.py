"""A recording must show the dots of its solutions, with those of the sensors that heard them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.display.page.own_ship_legs import Leg
from sonar_tracking.display.page.stacked_dots import DotStack
from sonar_tracking.display.stacked_dots_record import (
    MOST_COLUMNS,
    TrackDots,
    draw_stacked_dots,
)
from tests.display.position_pictures import EPOCH, SECOND

START = EPOCH * SECOND


def stack(label: str, frequency: float = np.nan) -> DotStack:
    stamps = START + SECOND * np.arange(10, dtype=np.int64)
    residual = np.linspace(-0.1, 0.1, 10)
    residual[3] = np.nan
    return DotStack(label, stamps, residual, np.full(10, 0.01), frequency)


@pytest.mark.parametrize("n_tracks", [1, pytest.param(MOST_COLUMNS, marks=pytest.mark.slow)])
def test_dots_are_drawn_of_any_number_of_tracks(tmp_path: Path, n_tracks: int) -> None:
    tracks = [
        TrackDots(str(number), (stack("array"), stack("array 300 Hz", 300.0)))
        for number in range(n_tracks)
    ]
    legs = [Leg(START, START + 5 * SECOND, True, 40.0), Leg(START + 5 * SECOND, START, False, 40.0)]
    picture, drawing = draw_stacked_dots(tracks, legs, START, tmp_path / "dots.png", "a")
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert drawing.name == "dots.svg" and drawing.stat().st_size > 5000
