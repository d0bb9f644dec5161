"""Protects: the pings of a scenario, complete when received, with own ship and truth beside."""

from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import scenario_from_mapping
from sonar_tracking.simulation.sensors.active_sonar_simulation import (
    ActiveSonarSimulation,
    ReceivedPing,
)

SECOND = 1_000_000_000
RECEPTION = 8 * SECOND

SCENE: dict[str, Any] = {
    "start": 5.0,
    "duration": 60.0,
    "active_sonar": {"ping_interval": 10.0, "maximum_range": 6000.0},
    "own_ship": {
        "position": [100.0, 0.0],
        "course_deg": 90.0,
        "speed": 5.0,
        "turns": [{"time": 30.0, "course_deg": 0.0, "rate_deg": 2.0}],
    },
    "targets": [
        {"motion": {"kind": "kinematic", "position": [2000.0, 1000.0], "speed": 6.0}},
        {
            "present": [15.0, 25.0, 45.0, 55.0],
            "motion": {"kind": "kinematic", "position": [-2000.0, 1000.0], "speed": 4.0},
        },
    ],
}


def scenario(**changes: Any) -> Scenario:
    return scenario_from_mapping({**SCENE, **changes}, "scene")


def pings(**changes: Any) -> list[ReceivedPing]:
    return list(ActiveSonarSimulation(scenario(**changes)))


def test_pings_follow_each_other_until_the_last_echo_fits_no_more() -> None:
    made = pings()
    epoch = scenario().epoch
    sent = [epoch + (5 + 10 * number) * SECOND for number in range(6)]
    assert [ping.start_stamp for ping in made] == sent
    assert [ping.due_stamp for ping in made] == [stamp + RECEPTION for stamp in sent]
    assert [ping.contacts.next_stamp for ping in made] == [*sent[1:], END_OF_DATA]
    for ping in made:
        assert ping.truth_tracks.stamp == ping.contacts.stamp
        assert ping.truth_tracks.next_stamp == ping.contacts.next_stamp
        assert ping.contacts.ping_interval == 10.0
    assert len(pings(duration=57.9)) == 5
    assert len(pings(duration=58.0)) == 6


def test_own_ship_is_told_at_both_ends_of_a_ping_and_never_twice() -> None:
    stamps = [state.stamp for ping in pings() for state in ping.own_ship]
    expected = [stamp for ping in pings() for stamp in (ping.start_stamp, ping.due_stamp)]
    assert stamps == expected
    joined = pings(active_sonar={"ping_interval": 8.0, "maximum_range": 6000.0})
    stamps = [state.stamp for ping in joined for state in ping.own_ship]
    assert stamps == [joined[0].start_stamp, *(ping.due_stamp for ping in joined)]


def test_the_sensor_is_where_own_ship_is() -> None:
    ship = scenario().own_ship.trajectory()
    for number, ping in enumerate(pings()):
        state = ship.state(5.0 + 10.0 * number)
        assert ping.contacts.sensor_position == pytest.approx(state.position)
        assert ping.contacts.sensor_velocity == pytest.approx(state.velocity)
        assert ping.own_ship[0].position == pytest.approx(state.position)
        assert ping.own_ship[0].yaw == pytest.approx(ping.contacts.sensor_yaw)


def test_targets_come_and_go_as_the_scenario_says() -> None:
    """Intervals are half open; a target that comes again has its identifier."""
    there = [ping.truth_tracks.id.tolist() for ping in pings()]
    assert there == [[1], [1, 2], [1], [1], [1, 2], [1]]
    motion = scenario().targets[0].motion
    assert isinstance(motion, KinematicMotion)
    state = motion.trajectory.state(15.0)
    assert pings()[1].truth_tracks.position[0] == pytest.approx(state.position)
    assert pings()[1].truth_tracks.velocity[0] == pytest.approx(state.velocity)


def test_pings_are_a_function_of_the_scenario_alone() -> None:
    one, other, later = pings(), pings(), pings(seed=2)
    for first, second in zip(one, other, strict=True):
        assert np.array_equal(first.contacts.range, second.contacts.range)
        assert np.array_equal(first.contacts.amplitude, second.contacts.amplitude)
    assert not np.array_equal(one[0].contacts.range, later[0].contacts.range)


@pytest.mark.slow
def test_louder_echoes_are_found_more_often() -> None:
    def found(level_db: float) -> float:
        """Return the contacts near the target per ping."""
        target = {
            "echo_level_db": level_db,
            "motion": {"kind": "kinematic", "position": [3000.0, 0.0]},
        }
        sonar = {
            "ping_interval": 10.0,
            "maximum_range": 6000.0,
            "signal_to_noise_ratio_db": 10.0,
            "range_standard_deviation": 5.0,
        }
        made = pings(duration=3000.0, active_sonar=sonar, targets=[target], own_ship={})
        offsets = [
            np.hypot((p.contacts.range - 3000.0) / 25.0, p.contacts.azimuth / 0.01) for p in made
        ]
        return float(np.mean([np.count_nonzero(offset < 1.0) for offset in offsets]))

    for level in (-3.0, 3.0):
        ratio = 10.0 ** ((10.0 + level) / 10.0)
        assert found(level) == pytest.approx(1e-3 ** (1.0 / (1.0 + ratio)), abs=0.1)
    assert found(3.0) > found(-3.0) + 0.15


def test_a_level_that_depends_on_the_range_is_not_told() -> None:
    sonar = {"ping_interval": 10.0, "maximum_range": 6000.0, "reference_range": 2000.0}
    contacts = pings(active_sonar=sonar)[0].contacts
    assert np.isnan(contacts.signal_to_noise_ratio_linear)
    assert np.isnan(contacts.detection_probability)
    assert np.isfinite(contacts.false_alarm_probability)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"duration": 7.0}, r"active_sonar: duration is 7 s.*8\.0 s"),
        ({"active_sonar": {"ping_interval": 2.0}}, r"active_sonar: Sound takes"),
        ({"targets": [{"motion": {"kind": "linear"}}]}, r"targets\[0\].*kinematic"),
    ],
)
def test_a_scenario_that_cannot_be_simulated_is_refused(changes: Any, text: str) -> None:
    with pytest.raises(ConfigurationError, match=text):
        scenario(**changes)


def test_a_scenario_without_a_sonar_is_refused() -> None:
    passive = scenario(active_sonar=None, array={"n_elements": 4}, targets=[])
    with pytest.raises(ConfigurationError, match="no section"):
        ActiveSonarSimulation(passive)


def test_a_moored_sonar_stays_where_it_is_while_own_ship_moves() -> None:
    sonar = {**SCENE["active_sonar"], "platform": "fixed", "position": [-500.0, 300.0]}
    for moored, aboard in zip(pings(active_sonar=sonar), pings(), strict=True):
        assert moored.contacts.sensor_position == (-500.0, 300.0)
        assert moored.contacts.sensor_velocity == (0.0, 0.0)
        assert moored.own_ship == aboard.own_ship


def test_a_moored_sonar_has_a_position_of_two_coordinates() -> None:
    sonar = {**SCENE["active_sonar"], "platform": "fixed", "position": [1.0, 2.0, 3.0]}
    with pytest.raises(ConfigurationError, match="active_sonar: position has 3 entries; give x"):
        scenario(active_sonar=sonar)
