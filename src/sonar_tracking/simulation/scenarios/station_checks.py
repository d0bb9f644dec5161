"""Checks of the stations of a scenario, and of the names of all its sensors."""

from __future__ import annotations

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.simulation.scenarios.namespaces import check_namespace
from sonar_tracking.simulation.scenarios.platforms import CONSORT, OWN_SHIP
from sonar_tracking.simulation.scenarios.scenario import STATIONS, Scenario
from sonar_tracking.simulation.scenarios.station_configuration import StationConfiguration


def check_stations(scenario: Scenario, where: str) -> None:
    """Refuse stations that have no sensor, no place or no name of their own.

    The values of a section are checked where those of own ship are.

    Raises
    ------
    ConfigurationError
        With a sentence that names the station and what to do.
    """
    names: dict[str, str] = {}
    for index, station in enumerate(scenario.stations):
        name = f"{where}{STATIONS}[{index}]"
        if not station.namespace:
            raise ConfigurationError(
                f"{name} has no namespace; give it one of its own, e.g. namespace: station_2."
            )
        check_namespace(station.namespace, name)
        if station.name in names:
            raise ConfigurationError(
                f"{name}.namespace {station.namespace!r} is taken by {names[station.name]}; give "
                "every station its own."
            )
        names[station.name] = name
        _check_station(station, name)


def _check_station(station: StationConfiguration, where: str) -> None:
    if station.array is None and station.active_sonar is None:
        raise ConfigurationError(
            f"{where} has no sensor; give it an array or an active_sonar. One that reports "
            "bearings directly belongs under bearing_sensors."
        )
    if station.hydrophones is not None and station.array is None:
        raise ConfigurationError(
            f"{where} has hydrophones, but no array that says where they are; add "
            "the section array."
        )
    if len(station.position) != 2:
        raise ConfigurationError(
            f"{where}.position has {len(station.position)} entries; give x and y in m."
        )
    sonar = station.active_sonar
    if sonar is not None and (sonar.platform != OWN_SHIP or any(sonar.position)):
        raise ConfigurationError(
            f"{where}.active_sonar is where its station is; leave out its platform and position, "
            "and give those of the station."
        )


def check_platforms(scenario: Scenario, where: str) -> None:
    """Refuse sensors aboard a second ship that is not there.

    Raises
    ------
    ConfigurationError
        Naming the sensor.
    """
    if scenario.consort is not None:
        return
    carried: list[tuple[str, str]] = [
        (f"bearing_sensors[{index}]", sensor.platform)
        for index, sensor in enumerate(scenario.bearing_sensors)
    ]
    carried += [
        (f"{STATIONS}[{index}]", station.platform)
        for index, station in enumerate(scenario.stations)
    ]
    if scenario.active_sonar is not None:
        carried.append(("active_sonar", scenario.active_sonar.platform))
    for name, platform in carried:
        if platform == CONSORT:
            raise ConfigurationError(
                f"{where}{name}.platform is {CONSORT}, but there is none; say in the section "
                f"{CONSORT} where it is and how it moves."
            )


def check_sensor_names(scenario: Scenario, where: str) -> None:
    """Refuse two sensors of one name: a track could not tell who heard it.

    Raises
    ------
    ConfigurationError
        Naming both.
    """
    named: dict[str, str] = {}
    for section, name in _sensor_names(scenario):
        other = named.setdefault(name, section)
        if other != section:
            raise ConfigurationError(
                f"{where}{section}.sensor_id is {name!r} like that of {other}; give every sensor "
                "its own."
            )


def _sensor_names(scenario: Scenario) -> list[tuple[str, str]]:
    """Return the section and the name of every sensor."""
    names = [("array", scenario.array.sensor_id)] if scenario.array_given else []
    if scenario.active_sonar is not None:
        names.append(("active_sonar", scenario.active_sonar.sensor_id))
    for index, sensor in enumerate(scenario.bearing_sensors):
        names.append((f"bearing_sensors[{index}]", sensor.sensor_id))
    for index, station in enumerate(scenario.stations):
        if station.array is not None:
            names.append((f"{STATIONS}[{index}].array", station.array.sensor_id))
        if station.active_sonar is not None:
            names.append((f"{STATIONS}[{index}].active_sonar", station.active_sonar.sensor_id))
    return names
