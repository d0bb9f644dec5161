"""Protects what is refused of an observation, and the range a solution states."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.tma.targets.target_records import (
    MAXIMUM_LINES,
    TargetObservation,
    TargetSolution,
    check_observation,
)

GOOD = TargetObservation(
    stamp=1,
    sensor_id="bow",
    position=(10.0, 20.0),
    velocity=(1.0, 2.0),
    azimuths=(0.3, -0.3),
    azimuth_variance=1e-4,
    line_ids=(1, 2),
    frequencies=(300.0, 200.0),
    frequency_deviations=(0.1, 0.2),
)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"azimuths": (), "azimuth_variance": np.nan},
        {"azimuths": (0.3,)},
        {"elevation": 0.1, "elevation_variance": 1e-4},
        {"line_ids": (), "frequencies": (), "frequency_deviations": ()},
        {
            "line_ids": tuple(range(MAXIMUM_LINES)),
            "frequencies": (100.0,) * MAXIMUM_LINES,
            "frequency_deviations": (0.1,) * MAXIMUM_LINES,
        },
    ],
)
def test_what_is_in_order_passes(changes: dict[str, Any]) -> None:
    check_observation(replace(GOOD, **changes))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"position": (np.nan, 0.0)}, "where the sensor is"),
        ({"velocity": (0.0, np.inf)}, "where the sensor is"),
        ({"azimuths": (0.1, 0.2, 0.3)}, "one or two finite azimuths"),
        ({"azimuths": (np.nan,)}, "one or two finite azimuths"),
        ({"azimuth_variance": 0.0}, "azimuth without a positive variance"),
        ({"azimuth_variance": np.nan}, "azimuth without a positive variance"),
        ({"line_ids": (1,)}, "unequal length"),
        ({"frequencies": (1.0, 2.0, 3.0)}, "unequal length"),
        ({"frequency_deviations": (0.1,)}, "unequal length"),
        ({"line_ids": (2, 2)}, "a line twice"),
        (
            {
                "line_ids": tuple(range(17)),
                "frequencies": (100.0,) * 17,
                "frequency_deviations": (0.1,) * 17,
            },
            "more than 16 lines",
        ),
        ({"frequencies": (300.0, 0.0)}, "frequency or deviation is not positive"),
        ({"frequency_deviations": (np.inf, 0.1)}, "frequency or deviation is not positive"),
        ({"elevation": 0.1}, "elevation without a positive variance"),
        ({"elevation": 0.1, "elevation_variance": -1.0}, "elevation without a positive variance"),
        ({"sound_speed": 0.0}, "sound speed"),
        ({"sound_speed": np.nan}, "sound speed"),
    ],
)
def test_what_contradicts_itself_is_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        check_observation(replace(GOOD, **changes))


def test_a_range_is_as_uncertain_as_the_place_along_the_line_of_sight() -> None:
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = [[500.0, 240.0], [240.0, 360.0]]
    solution = TargetSolution(
        stamp=1,
        side="single",
        probability=1.0,
        mean=np.array([310.0, 420.0, 0.0, 0.0]),
        covariance=covariance,
        observability=1.0,
        observable=True,
        line_ids=(),
        source_frequency=np.zeros(0),
        source_frequency_deviation=np.zeros(0),
        manoeuvre=False,
    )
    distance, deviation = solution.range_from((10.0, 20.0))
    assert distance == pytest.approx(500.0)
    sight = np.array([0.6, 0.8])
    assert deviation == pytest.approx(np.sqrt(sight @ covariance[:2, :2] @ sight))
