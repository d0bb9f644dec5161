"""Checks of a scenario that concern several of its values together."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geometry import aperture
from sonar_tracking.passive.subspaces.block_checks import MAXIMUM_RELATIVE_BANDWIDTH
from sonar_tracking.simulation.scenarios.array_configuration import ArrayConfiguration
from sonar_tracking.simulation.scenarios.bearing_motion import TableMotion
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import check_bearing_sensors
from sonar_tracking.simulation.scenarios.contact_configuration import (
    ContactSensorConfiguration,
    check_contact_sensor,
    number_of_pings,
)
from sonar_tracking.simulation.scenarios.hydrophone_configuration import check_hydrophones
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import CONSORT, OwnShipConfiguration
from sonar_tracking.simulation.scenarios.scenario import STATIONS, Scenario
from sonar_tracking.simulation.scenarios.station_checks import (
    check_platforms,
    check_sensor_names,
    check_stations,
)
from sonar_tracking.simulation.scenarios.target import TargetConfiguration


def check_scenario(scenario: Scenario, where: str) -> None:
    """Raise a sentence on the first value that does not fit the others.

    Raises
    ------
    ConfigurationError
        Naming the value and what to do.
    """
    check_stations(scenario, where)
    check_platforms(scenario, where)
    stations = (f"{where}{STATIONS}[{index}]." for index in range(len(scenario.stations)))
    for place, name in zip(scenario.places.values(), (where, *stations), strict=True):
        _check_sensors(place, name)
    check_bearing_sensors(scenario.bearing_sensors, f"{where}bearing_sensors")
    check_sensor_names(scenario, where)
    _check_platform(scenario.own_ship, f"{where}own_ship")
    if scenario.consort is not None:
        _check_platform(scenario.consort, f"{where}{CONSORT}")
    names: set[str] = set()
    for index, target in enumerate(scenario.targets):
        name = f"{where}targets[{index}]"
        if target.name in names:
            raise ConfigurationError(f"{name}.name {target.name} is used twice; choose another.")
        names.add(target.name)
        _check_target(target, name)
        _check_bearings(scenario, target, name)


def _check_sensors(scenario: Scenario, where: str) -> None:
    """Check the array and the sonar of one place."""
    if scenario.array_given:
        _check_array(scenario.array, f"{where}array")
    if scenario.active_sonar is not None:
        _check_active_sonar(scenario.active_sonar, scenario.duration, where)
    if scenario.hydrophones is not None:
        check_hydrophones(scenario.hydrophones, scenario.targets, where)


def _check_active_sonar(sensor: ContactSensorConfiguration, duration: float, where: str) -> None:
    try:
        check_contact_sensor(sensor)
        number_of_pings(sensor, duration)
    except ConfigurationError as error:
        raise ConfigurationError(f"{where}active_sonar: {error}") from error


def _check_array(array: ArrayConfiguration, where: str) -> None:
    lengths = {"element_y": array.element_y, "element_z": array.element_z}
    n_elements = len(array.element_x) or array.n_elements
    for name, values in lengths.items():
        if values and len(values) != len(array.element_x):
            raise ConfigurationError(
                f"{where}.{name} has {len(values)} entries and element_x {len(array.element_x)}; "
                "give one coordinate for each element."
            )
    if array.element_x and array.n_elements not in (0, len(array.element_x)):
        raise ConfigurationError(
            f"{where}.n_elements is {array.n_elements} but element_x has {len(array.element_x)} "
            "entries; leave n_elements out."
        )
    if n_elements < 2:
        raise ConfigurationError(
            f"{where} has {n_elements} elements; give n_elements (at least 2) and a spacing, or "
            "the coordinates element_x."
        )
    ratio = array.bandwidth * aperture(array.element_positions()) / array.sound_speed
    if ratio >= MAXIMUM_RELATIVE_BANDWIDTH:
        raise ConfigurationError(
            f"{where}: bandwidth * aperture / sound_speed is {ratio:.3g}; the narrowband model "
            f"needs less than {MAXIMUM_RELATIVE_BANDWIDTH:g}: reduce the bandwidth or the array."
        )


def _check_platform(platform: OwnShipConfiguration | KinematicMotion, where: str) -> None:
    if len(platform.position) != 2:
        raise ConfigurationError(
            f"{where}.position has {len(platform.position)} entries; give x and y in m."
        )
    _check_ascending([turn.time for turn in platform.turns], f"{where}.turns", "times")


def _check_target(target: TargetConfiguration, where: str) -> None:
    _check_schedule(target.present, f"{where}.present")
    if not target.heard and not target.echoes:
        raise ConfigurationError(
            f"{where}: heard and echoes are both false, so that nothing receives {target.name}; "
            "leave one of them out."
        )
    for number, line in enumerate(target.lines):
        _check_schedule(line.present, f"{where}.lines[{number}].present")
    motion = target.motion
    if isinstance(motion, KinematicMotion):
        _check_platform(motion, f"{where}.motion")
    if isinstance(motion, TableMotion):
        if len(motion.times) < 2 or len(motion.times) != len(motion.bearings_deg):
            raise ConfigurationError(
                f"{where}.motion has {len(motion.times)} times and {len(motion.bearings_deg)} "
                "bearings_deg; give as many of one as of the other, two at least."
            )
        _check_ascending(motion.times, f"{where}.motion.times", "times")


def _check_schedule(schedule: tuple[float, ...], where: str) -> None:
    if len(schedule) % 2:
        raise ConfigurationError(
            f"{where} has {len(schedule)} entries; give pairs of times from, to."
        )
    _check_ascending(schedule, where, "times")


def _check_ascending(values: tuple[float, ...] | list[float], where: str, what: str) -> None:
    if np.any(np.diff(values) <= 0.0):
        raise ConfigurationError(f"{where}: the {what} must ascend; put them in order.")


def _check_bearings(scenario: Scenario, target: TargetConfiguration, where: str) -> None:
    if isinstance(target.motion, KinematicMotion):
        speed, sound_speed = target.motion.speed, scenario.array.sound_speed
        if max(speed, scenario.own_ship.speed) >= sound_speed:
            raise ConfigurationError(
                f"{where}.motion.speed must be below sound_speed ({sound_speed:g} m/s), and so "
                "must be own_ship.speed."
            )
        return
    others = scenario.bearing_sensors or scenario.active_sonar or scenario.stations
    if not scenario.array_given or others:
        raise ConfigurationError(
            f"{where}.motion gives bearings only, which nothing but an array alone can hear; give "
            "kind: kinematic, with a position in map."
        )
    times = np.linspace(scenario.start, scenario.start + scenario.duration, 1001)
    times = times[target.is_present(times)]
    angle, _ = target.motion.arrival(times, scenario.receiver())
    outside = np.abs(angle) > np.pi / 2.0 + 1e-9
    if np.any(outside):
        first = int(np.argmax(outside))
        raise ConfigurationError(
            f"{where}.motion takes the bearing to {np.degrees(angle[first]):.2f} deg at "
            f"t = {times[first]:.2f} s; bearings must stay between -90 and 90 deg while present."
        )
