"""Protects line trackers from parameters that contradict each other."""

from __future__ import annotations

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.lines.line_tracker_configuration import (
    LineTrackerConfiguration,
    check_line_tracker,
)


@pytest.mark.parametrize("values", [(3, 3, 0.0, 10.0), (2, 3, 10.1, 10.0), (1, 100, 0.0, 0.0)])
def test_what_fits_is_taken(values: tuple[int, int, float, float]) -> None:
    hits, frames, highest, lowest = values
    check_line_tracker(
        LineTrackerConfiguration(
            confirmation_hits=hits,
            confirmation_frames=frames,
            maximum_frequency=highest,
            minimum_frequency=lowest,
        )
    )


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"confirmation_hits": 6}, "confirmation_frames only 5"),
        ({"maximum_frequency": 10.0}, "give a higher maximum"),
        ({"maximum_frequency": 5.0}, "give a higher maximum"),
    ],
)
def test_what_does_not_is_refused(values: dict[str, object], sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        check_line_tracker(LineTrackerConfiguration(**values))  # type: ignore[arg-type]
