"""Protects that bearings of something silent are not taken for bearings of it."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.tma.targets.hearing import Hearing
from sonar_tracking.tma.targets.target_records import TargetObservation

USUAL = float(np.radians(1.0))


def reported(second: float, deviation: float, elevation: float = np.nan) -> TargetObservation:
    """Return an azimuth with the deviation given; where it has an elevation that is as usual."""
    return TargetObservation(
        stamp=int(second * 1e9),
        sensor_id="east",
        position=(0.0, 0.0),
        velocity=(0.0, 0.0),
        azimuths=(0.3,),
        azimuth_variance=deviation**2,
        elevation=elevation,
        elevation_variance=np.nan if np.isnan(elevation) else USUAL**2,
    )


def listened(hearing: Hearing, deviations: list[float], begin: float) -> list[bool]:
    return [hearing.take(reported(begin + n, one)) for n, one in enumerate(deviations)]


def usual() -> Hearing:
    hearing = Hearing()
    assert all(listened(hearing, [USUAL] * 200, 0.0))
    return hearing


@pytest.mark.parametrize("chance", [0, 5])
def test_much_worse_bearings_are_of_nothing_also_where_some_agree_by_chance(chance: int) -> None:
    hearing = usual()
    worse = [USUAL if chance and n % chance == 0 else 30.0 * USUAL for n in range(300)]
    heard = listened(hearing, worse, 200.0)
    assert not any(heard[20:]), "and it does not become usual within five minutes"
    assert any(listened(hearing, [USUAL] * 10, 500.0))


@pytest.mark.parametrize("factor", [2.0, 5.0])
def test_bearings_overhead_are_worse_and_heard(factor: float) -> None:
    assert all(listened(usual(), [factor * USUAL] * 100, 200.0))


def test_what_fades_slowly_is_heard() -> None:
    fading = (USUAL * np.geomspace(1.0, 50.0, 3000)).tolist()
    assert all(listened(usual(), fading, 200.0))


def test_an_elevation_tells_how_good_the_direction_is() -> None:
    hearing = usual()
    assert all(hearing.take(reported(200.0 + n, 30.0 * USUAL, 1.5)) for n in range(60))
