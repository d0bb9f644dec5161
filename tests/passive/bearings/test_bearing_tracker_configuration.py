"""When tracks end by themselves: from nothing, with a variance that the data tell."""

from __future__ import annotations

import pytest

from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)


@pytest.mark.parametrize(
    ("method", "variance_deg2", "start", "ends"),
    [
        ("joint_map", 0.0, "automatic", True),
        ("coherent", 0.0, "automatic", True),
        ("ml_fusion", 0.0, "automatic", True),
        ("joint_map", 0.0, "given", False),
        ("ml_fusion", 0.0, "given", False),
        ("ryu", 0.5, "automatic", False),  # as published: nobody knows how good a bearing is
        ("ml_fusion", 0.5, "automatic", False),
    ],
)
def test_tracks_end_where_nobody_said_that_they_stay(
    method: str, variance_deg2: float, start: str, ends: bool
) -> None:
    configuration = BearingTrackerConfiguration(
        method=method,
        measurement_variance_deg2=variance_deg2,
        start=start,
        initial_bearings_deg=() if start == "automatic" else (3.0,),
    )
    assert configuration.ends_tracks == ends
