"""Targets nearer than 2 aperture^2 / wavelength are reported, others are not."""

from __future__ import annotations

from sonar_tracking.simulation.scenarios.scenario_mapping import scenario_from_mapping
from sonar_tracking.simulation.signals.near_targets import near_target_notices

ARRAY = {"n_elements": 16}


def passing(distance: float, **values: object) -> dict[str, object]:
    """Return a target that passes abeam at a distance in m."""
    motion = {"kind": "kinematic", "position": [-50.0, distance], "course_deg": 90.0, "speed": 5.0}
    return {"motion": motion, **values}


def test_only_targets_that_come_near_are_told() -> None:
    world = scenario_from_mapping({"duration": 20.0, "array": ARRAY}, "test")
    aperture = 15.0 * (world.array.element_positions()[1, 0])
    limit = 2.0 * aperture**2 * world.array.wavenumber() / 6.283185307
    targets = [
        passing(0.5 * limit, name="near"),
        passing(1.01 * limit),
        passing(0.5 * limit, present=[100.0, 200.0]),
        {"motion": {"kind": "linear"}},
    ]
    world = scenario_from_mapping({"duration": 20.0, "array": ARRAY, "targets": targets}, "test")
    (notice,) = near_target_notices(world)
    assert notice.culprit == "near"
    assert "nearer than 2 aperture^2 / wavelength" in notice.text
