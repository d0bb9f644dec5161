"""A further place with sensors: an array, an active sonar, or both, in a namespace of its own.

What a station receives is simulated as for own ship, seen from what carries it:
:meth:`sonar_tracking.simulation.scenarios.scenario.Scenario.of_station` gives the scenario in
which that is own ship and the sensors of the station are the only ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.configuration import SECTION, parameter
from sonar_tracking.records.station_name import station_name
from sonar_tracking.simulation.scenarios.array_configuration import (
    ArrayConfiguration,
    NoiseConfiguration,
)
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.scenarios.hydrophone_configuration import HydrophoneConfiguration
from sonar_tracking.simulation.scenarios.platforms import (
    CONSORT,
    FIXED,
    OWN_SHIP,
    OwnShipConfiguration,
    Platforms,
)

RANDOM_STREAM = 102
"""Of the stations among those of the seed, beside the sensors that are in no station."""


@dataclass(frozen=True)
class StationConfiguration:
    """An array or an active sonar on own ship, moored, or aboard the second ship.

    Its sections ``array``, ``noise``, ``hydrophones`` and ``active_sonar`` are those of a scenario.
    """

    namespace: str = parameter("", "of its topics and its trackers, e.g. bow")
    platform: str = parameter("own_ship", "what carries it", choices=(OWN_SHIP, FIXED, CONSORT))
    position: tuple[float, ...] = parameter((0.0, 0.0), "x, y in map of a fixed one", unit="m")
    course_deg: float = parameter(0.0, "compass heading of a fixed one", unit="deg")
    array: ArrayConfiguration | None = field(default=None, metadata=SECTION)
    noise: NoiseConfiguration = field(default_factory=NoiseConfiguration, metadata=SECTION)
    hydrophones: HydrophoneConfiguration | None = field(default=None, metadata=SECTION)
    active_sonar: ContactSensorConfiguration | None = field(default=None, metadata=SECTION)

    @property
    def name(self) -> str:
        """Namespace as a part of the names of nodes and sensors."""
        return station_name(self.namespace)

    def motion(self, platforms: Platforms) -> OwnShipConfiguration:
        """Return how the station moves."""
        if self.platform == OWN_SHIP:
            return platforms.own_ship
        if self.platform == CONSORT and platforms.consort is not None:
            return platforms.consort
        return OwnShipConfiguration(position=self.position, course_deg=self.course_deg)


def station_seed(seed: int, number: int) -> int:
    """Return the seed of the sensors of a station, by its number from 0."""
    stream = np.random.SeedSequence(seed, spawn_key=(RANDOM_STREAM, number))
    return int(stream.generate_state(1, np.uint64)[0])


def with_sensor_names(station: StationConfiguration, named: Sequence[str]) -> StationConfiguration:
    """Return a station whose sensors have names of their own where none are given.

    Parameters
    ----------
    station : StationConfiguration
        As read.
    named : sequence of str
        Sections that give a ``sensor_id``.
    """
    array, sonar = station.array, station.active_sonar
    if array is not None and "array" not in named:
        array = replace(array, sensor_id=f"{station.name}_array")
    if sonar is not None and "active_sonar" not in named:
        sonar = replace(sonar, sensor_id=f"{station.name}_sonar")
    return replace(station, array=array, active_sonar=sonar)
