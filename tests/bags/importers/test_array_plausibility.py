"""An array that cannot give bearings is refused before anything is imported, with its cause."""

from __future__ import annotations

from typing import Any

import pytest

from sonar_tracking.bags.importers.array_geometry_file import array_from_mapping
from sonar_tracking.bags.importers.array_plausibility import check_bearings
from sonar_tracking.errors import ConfigurationError

LINE: dict[str, Any] = {"n_elements": 8, "spacing": 0.5, "sound_speed": 1500.0}


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"n_elements": 0, "spacing": 0.0, "element_x": [0, 0, 0], "element_z": [0, -1, -2]},
         "is vertical"),
        ({"spacing": 0.8}, "more than half a wavelength .* up to 937.5 Hz"),
        ({"spacing": 500.0}, "look like millimetres: 500 mm are 0.5 m"),
        ({"sound_speed": 343.0}, "that of air or less; in water it is about 1500 m/s"),
    ],
)  # fmt: skip
def test_the_likely_cause_is_named(changes: dict[str, Any], reason: str) -> None:
    array = array_from_mapping({**LINE, **changes}, "array.yaml")
    with pytest.raises(ConfigurationError, match=reason):
        check_bearings(array, 1000.0, "array.yaml")


def test_what_is_assumed_or_unusual_is_said() -> None:
    assert check_bearings(array_from_mapping(LINE, "a"), 1000.0, "a") == []
    assumed = {name: value for name, value in LINE.items() if name != "sound_speed"}
    (note,) = check_bearings(array_from_mapping(assumed, "a"), 1000.0, "a")
    assert "1500 m/s is assumed" in note
    (note,) = check_bearings(array_from_mapping({**LINE, "sound_speed": 5400.0}, "a"), 1000.0, "a")
    assert "sound_speed is 5400 m/s" in note
