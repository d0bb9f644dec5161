"""Scenarios: the world of a simulation, read from YAML into frozen dataclasses.

A scenario time t (s) is the stamp ``epoch + round(t * 1e9)`` ns. The resolved scenario, with all
defaults filled in, goes into recordings and reads back as the same scenario.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TypeVar

from sonar_tracking.configuration import SECTION, Value, parameter
from sonar_tracking.geometry import is_line
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.time import NANOSECONDS, nanoseconds
from sonar_tracking.simulation.scenarios.array_configuration import (
    ArrayConfiguration,
    NoiseConfiguration,
)
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.scenarios.hydrophone_configuration import HydrophoneConfiguration
from sonar_tracking.simulation.scenarios.platforms import (
    CONSORT,
    OwnShipConfiguration,
    Platforms,
    Receiver,
)
from sonar_tracking.simulation.scenarios.station_configuration import (
    StationConfiguration,
    station_seed,
)
from sonar_tracking.simulation.scenarios.target import (
    TargetConfiguration,
)

DEFAULT_EPOCH = 1_767_225_600 * NANOSECONDS
"""2026-01-01T00:00:00Z, ns."""

LATEST_EPOCH_SECONDS = 2_000_000_000

ARRAY = "array"
HYDROPHONES = "hydrophones"
"""Section of the broadband samples of the array, which are then simulated instead of snapshots."""

BEARING_SENSORS = "bearing_sensors"
"""Section of the stations that report bearings and lines directly, a list."""

OWN_SHIP = "own_ship"
"""Section of own ship, which is part of every world."""

ACTIVE_SONAR = "active_sonar"
STATIONS = "stations"
"""Section of further arrays and active sonars, each with a namespace of its own, a list."""

OTHER_SENSORS = (BEARING_SENSORS, ACTIVE_SONAR)
"""Sections of the sensors beside the narrowband array."""

NodeParameters = dict[str, dict[str, Value]]
Configuration = TypeVar("Configuration")


@dataclass(frozen=True)
class Scenario:
    """A world, the sensors in it and the parameters of the nodes that listen to them.

    Each sensor is a section. A file that gives none of them has the default ``array``, which
    ``array_given`` tells. ``carrier`` is what the frames of own ship are called: another name where
    a station is what carries the sensors (:meth:`of_station`).
    """

    name: str = parameter("", "name of the scenario; empty = name of the file")
    description: str = parameter("", "what it shows")
    start: float = parameter(0.0, "scenario time of the first snapshot", unit="s")
    duration: float = parameter(60.0, "length of the data", unit="s", minimum=1e-3, maximum=1e7)
    seed: int = parameter(1, "of the random numbers", minimum=0)
    epoch: int = field(default=DEFAULT_EPOCH, metadata=SECTION)
    datum: Datum | None = field(default=None, metadata=SECTION)
    array: ArrayConfiguration = field(default_factory=ArrayConfiguration, metadata=SECTION)
    noise: NoiseConfiguration = field(default_factory=NoiseConfiguration, metadata=SECTION)
    own_ship: OwnShipConfiguration = field(default_factory=OwnShipConfiguration, metadata=SECTION)
    consort: OwnShipConfiguration | None = field(default=None, metadata=SECTION)
    targets: tuple[TargetConfiguration, ...] = field(default=(), metadata=SECTION)
    array_given: bool = field(default=True, metadata=SECTION)
    carrier: str = field(default=OWN_SHIP, metadata=SECTION)
    hydrophones: HydrophoneConfiguration | None = field(default=None, metadata=SECTION)
    active_sonar: ContactSensorConfiguration | None = field(default=None, metadata=SECTION)
    bearing_sensors: tuple[BearingSensorConfiguration, ...] = field(default=(), metadata=SECTION)
    stations: tuple[StationConfiguration, ...] = field(default=(), metadata=SECTION)
    nodes: NodeParameters = field(default_factory=dict, metadata=SECTION)

    @property
    def sensors(self) -> tuple[str, ...]:
        """Sections of the sensors that are simulated."""
        others = tuple(name for name in OTHER_SENSORS if getattr(self, name))
        array = ARRAY if self.hydrophones is None else HYDROPHONES
        return ((array,) if self.array_given else ()) + others

    @property
    def simulated(self) -> tuple[str, ...]:
        """Sections that are simulated: own ship in its world, and the sensors."""
        return (OWN_SHIP, *self.sensors)

    @property
    def namespaces(self) -> dict[str, tuple[str, ...]]:
        """Namespaces of what a section has several of: bearing sensors, and ships beside own one.

        Of a section that is absent there is one, without a namespace.
        """
        stations = tuple(sensor.namespace for sensor in self.bearing_sensors)
        known = {BEARING_SENSORS: stations} if stations else {}
        return known | ({OWN_SHIP: (CONSORT,)} if self.consort is not None else {})

    @property
    def station_namespaces(self) -> tuple[str, ...]:
        """Namespaces in which there may be trackers, besides that of own ship."""
        named = [station.namespace for station in self.stations]
        named += [sensor.namespace for sensor in self.bearing_sensors if sensor.namespace]
        named += [CONSORT] if self.consort is not None else []
        return tuple(dict.fromkeys(named))

    def simulated_in(self, namespace: str) -> tuple[str, ...]:
        """Return the sections that are simulated in a namespace, each by a node of its own there.

        Bearing sensors are all simulated by one node, in no namespace.
        """
        if not namespace:
            return self.simulated
        known = {station.namespace for station in self.stations}
        return self.of_station(namespace).sensors if namespace in known else ()

    def of_station(self, namespace: str) -> Scenario:
        """Return what concerns the sensors of a station: as if what carries it was own ship.

        Parameters
        ----------
        namespace : str
            Of the station; empty = the scenario itself.
        """
        if not namespace:
            return self
        names = [station.namespace for station in self.stations]
        number = names.index(namespace)
        station = self.stations[number]
        return replace(
            self,
            seed=station_seed(self.seed, number),
            array=station.array or ArrayConfiguration(),
            noise=station.noise,
            own_ship=station.motion(self.platforms),
            carrier=OWN_SHIP if station.platform == OWN_SHIP else station.name,
            consort=None,
            array_given=station.array is not None,
            hydrophones=station.hydrophones,
            active_sonar=station.active_sonar,
            bearing_sensors=(),
            stations=(),
        )

    @property
    def places(self) -> dict[str, Scenario]:
        """What concerns each station by its namespace, after all that is in none."""
        alone = replace(self, stations=()) if self.stations else self
        named = [station.namespace for station in self.stations]
        return {"": alone, **{namespace: self.of_station(namespace) for namespace in named}}

    @property
    def step(self) -> float:
        """Shortest time between two data of a sensor, s."""
        if self.stations:
            return min(place.step for place in self.places.values() if place.sensors)
        steps = []
        if self.array_given:
            steps.append(self.block_length / self.sample_rate)
        if self.active_sonar is not None:
            steps.append(self.active_sonar.ping_interval)
        steps += [sensor.frame_interval for sensor in self.bearing_sensors]
        return min(steps)

    @property
    def end(self) -> float:
        """Scenario time at which the last datum is complete, s."""
        if self.stations:
            return max(place.end for place in self.places.values() if place.sensors)
        ends = []
        if self.array_given:
            ends.append(self.start + self.n_samples / self.sample_rate)
        if self.bearing_sensors or self.active_sonar is not None:
            ends.append(self.start + self.duration)
        return max(ends)

    @property
    def sample_rate(self) -> float:
        """Snapshots or samples of the array a second."""
        return (
            self.array.snapshot_rate if self.hydrophones is None else self.hydrophones.sample_rate
        )

    @property
    def block_length(self) -> int:
        """Snapshots or samples in one message of the array."""
        if self.hydrophones is None:
            return self.array.block_snapshots
        return self.hydrophones.block_samples

    @property
    def n_samples(self) -> int:
        """Snapshots or samples of the array from begin to end."""
        return max(1, round(self.duration * self.sample_rate))

    @property
    def block_bytes(self) -> int:
        """Largest data in one message of an array, as they travel, bytes; 0 = there is none."""
        if self.stations:
            return max(place.block_bytes for place in self.places.values())
        if not self.array_given:
            return 0
        n_elements = len(self.array.element_positions())
        if self.hydrophones is not None:
            return 4 * self.hydrophones.block_samples * n_elements
        return 8 * self.array.block_snapshots * n_elements

    def stamp(self, time: float) -> int:
        """Return the stamp (ns) of a scenario time (s)."""
        return self.epoch + nanoseconds(time)

    @property
    def platforms(self) -> Platforms:
        """What may carry sensors."""
        return Platforms(self.own_ship, self.consort)

    def receiver(self) -> Receiver:
        """Return the array as the propagation geometry sees it."""
        array = self.array
        return Receiver(
            trajectory=self.own_ship.trajectory(),
            mounting_yaw=math.radians(array.mounting_yaw_deg),
            sound_speed=array.sound_speed,
            ambiguous=is_line(array.element_positions()),
        )
