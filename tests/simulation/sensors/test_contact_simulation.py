"""Protects: physics, level, threshold and clutter of the simulated active sonar."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import Trajectory, Turn
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.sensors.contact_simulation import ContactSimulation, ContactTarget

EPOCH = 1_000_000_000_000
QUIET = ContactSensorConfiguration(
    range_standard_deviation=1e-6,
    azimuth_standard_deviation_deg=1e-9,
    clutter="area",
    clutter_per_ping=1e-9,
    detection_probability=1.0,
)


def simulate(
    configuration: ContactSensorConfiguration,
    targets: tuple[ContactTarget, ...] = (),
    own_ship: Trajectory | None = None,
    seed: int = 1,
) -> ContactSimulation:
    ship = own_ship or Trajectory((0.0, 0.0), 0.0, 0.0)
    return ContactSimulation(configuration, ship, targets, np.random.default_rng(seed), EPOCH)


def test_contacts_lie_where_the_target_was_when_the_ping_arrived() -> None:
    target = Trajectory((4000.0, 3000.0), 2.0, 9.0, [Turn(20.0, 1.0, 0.01)])
    ship = Trajectory((100.0, -200.0), 0.3, 7.0)
    simulation = simulate(QUIET, (ContactTarget(1, target),), ship)
    for number in range(5):
        ping = simulation.ping(number)
        placed = place_contacts(ping.contacts, 1500.0)
        time = 10.0 * number
        there = target.state(time + placed.delay[0]).position
        assert placed.position[0] == pytest.approx(there, abs=0.05)
        travel = np.hypot(*(there - ship.state(time).position)) / 1500.0
        assert placed.delay[0] == pytest.approx(travel, abs=1e-4)
        assert ping.state[0, :2] == pytest.approx(target.state(time).position)
        assert ping.contacts.stamp == EPOCH + number * 10_000_000_000


def test_an_instantaneous_ping_sees_the_target_at_the_stamp() -> None:
    target = Trajectory((4000.0, 3000.0), 2.0, 9.0)
    simulation = simulate(replace(QUIET, sound_speed=0.0), (ContactTarget(1, target),))
    ping = simulation.ping(3)
    placed = place_contacts(ping.contacts, 0.0)
    assert placed.position[0] == pytest.approx(target.state(30.0).position, abs=1e-3)
    assert placed.delay[0] == 0.0


def test_targets_appear_and_leave() -> None:
    path = Trajectory((1000.0, 0.0), 0.0, 1.0)
    simulation = simulate(QUIET, (ContactTarget(7, path, 20.0, 40.0),))
    present = [len(simulation.ping(number).target_id) for number in range(7)]
    assert present == [0, 0, 1, 1, 1, 0, 0]


@pytest.mark.slow
def test_errors_have_the_stated_deviations() -> None:
    configuration = replace(
        QUIET, sound_speed=0.0, range_standard_deviation=30.0, azimuth_standard_deviation_deg=0.5
    )
    path = Trajectory((3000.0, 0.0), 0.0, 0.0)
    simulation = simulate(configuration, (ContactTarget(1, path),))
    contacts = [simulation.ping(number).contacts for number in range(2000)]
    ranges = np.concatenate([one.range for one in contacts])
    azimuths = np.concatenate([one.azimuth for one in contacts])
    assert np.std(ranges - 3000.0) == pytest.approx(30.0, rel=0.06)
    assert np.degrees(np.std(azimuths)) == pytest.approx(0.5, rel=0.06)


@pytest.mark.slow
def test_detection_and_false_alarms_follow_the_threshold() -> None:
    configuration = ContactSensorConfiguration(
        sound_speed=0.0, false_alarm_probability=1e-3, maximum_range=2000.0
    )
    path = Trajectory((1000.0, 0.0), 0.0, 0.0)
    silent = simulate(configuration)
    contacts = [silent.ping(number).contacts for number in range(400)]
    count = np.array([len(one.range) for one in contacts])
    expected = configuration.n_cells * 1e-3
    assert np.mean(count) == pytest.approx(expected, abs=4.0 * np.sqrt(expected / 400))
    amplitude = np.concatenate([one.amplitude for one in contacts])
    assert np.min(amplitude) > contacts[0].detection_threshold
    simulation = simulate(replace(configuration, false_alarm_probability=1e-2), seed=2)
    both = simulate(
        replace(configuration, false_alarm_probability=1e-2), (ContactTarget(1, path),), seed=3
    )
    extra = np.mean([len(both.ping(n).contacts.range) for n in range(2000)]) - np.mean(
        [len(simulation.ping(n).contacts.range) for n in range(2000)]
    )
    assert contacts[0].detection_probability == pytest.approx(1e-3 ** (1.0 / 11.0))
    assert extra == pytest.approx(1e-2 ** (1.0 / 11.0), abs=0.6)


@pytest.mark.parametrize(("clutter", "share"), [("area", 0.25), ("cell", 0.5)])
def test_clutter_is_uniform_per_area_or_per_cell(clutter: str, share: float) -> None:
    configuration = replace(QUIET, clutter=clutter, clutter_per_ping=200.0)
    simulation = simulate(configuration)
    ranges = np.concatenate([simulation.ping(number).contacts.range for number in range(50)])
    inner = np.mean(ranges < 0.5 * configuration.maximum_range)
    assert inner == pytest.approx(share, abs=0.02)
    density = simulation.ping(50).contacts.clutter_density
    area = np.pi * configuration.maximum_range**2
    assert np.isnan(density) if clutter == "cell" else density == pytest.approx(200.0 / area)


def test_far_targets_are_fainter() -> None:
    configuration = ContactSensorConfiguration(
        sound_speed=0.0,
        signal_to_noise_ratio_db=20.0,
        reference_range=1000.0,
        absorption_db_per_km=1.0,
        false_alarm_probability=1e-6,
    )
    found = []
    for distance in (1000.0, 3000.0):
        path = Trajectory((distance, 0.0), 0.0, 0.0)
        simulation = simulate(configuration, (ContactTarget(1, path),))
        found.append(sum(len(simulation.ping(number).contacts.range) for number in range(300)))
    level = 100.0 * 10.0 ** (-0.1 * (40.0 * np.log10(3.0) + 4.0))
    clutter = configuration.n_cells * 1e-6
    assert found[0] / 300 == pytest.approx(1e-6 ** (1.0 / 101.0) + clutter, abs=0.08)
    assert found[1] / 300 == pytest.approx(1e-6 ** (1.0 / (1.0 + level)) + clutter, abs=0.08)


def test_heavy_tailed_clutter_has_more_strong_contacts() -> None:
    configuration = ContactSensorConfiguration(sound_speed=0.0, false_alarm_probability=1e-3)
    counts = [
        sum(len(simulate(sensor).ping(number).contacts.range) for number in range(5))
        for sensor in (configuration, replace(configuration, clutter_shape=1.0))
    ]
    assert counts[1] > 3 * counts[0]


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"maximum_range": 10_000.0}, "ping_interval"),
        ({"clutter_per_ping": 5.0, "clutter_shape": 1.0}, "clutter_shape"),
        ({"clutter": "area"}, "clutter_per_ping"),
        ({"detection_probability": 0.9}, "detection_probability"),
    ],
)
def test_parameters_that_do_not_fit_are_refused(values: dict[str, float], text: str) -> None:
    with pytest.raises(ConfigurationError, match=text):
        simulate(ContactSensorConfiguration(**values))  # type: ignore[arg-type]


def test_the_same_seed_gives_the_same_pings() -> None:
    configuration = ContactSensorConfiguration(sound_speed=0.0)
    one, other = (simulate(configuration).ping(0).contacts for _ in range(2))
    assert np.array_equal(one.range, other.range)
    assert np.array_equal(one.amplitude, other.amplitude)
