"""Scenarios: the world of a simulation, read from YAML into frozen dataclasses.

A scenario time t (s) is the stamp ``epoch + round(t * 1e9)`` ns. The resolved scenario, with all
defaults filled in, goes into recordings and reads back as the same scenario.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
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
    OwnShipConfiguration,
    Platforms,
    Receiver,
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

OTHER_SENSORS = (BEARING_SENSORS, "active_sonar")
"""Sections of the sensors beside the narrowband array."""

NodeParameters = dict[str, dict[str, Value]]
Configuration = TypeVar("Configuration")


@dataclass(frozen=True)
class Scenario:
    """A world, the sensors in it and the parameters of the nodes that listen to them.

    Each sensor is a section. A file that gives none of them has the default ``array``, which
    ``array_given`` tells.
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
    hydrophones: HydrophoneConfiguration | None = field(default=None, metadata=SECTION)
    active_sonar: ContactSensorConfiguration | None = field(default=None, metadata=SECTION)
    bearing_sensors: tuple[BearingSensorConfiguration, ...] = field(default=(), metadata=SECTION)
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
        """Namespaces of the stations of a sensor, by its section; absent = one without."""
        stations = tuple(sensor.namespace for sensor in self.bearing_sensors)
        return {BEARING_SENSORS: stations} if stations else {}

    @property
    def step(self) -> float:
        """Shortest time between two data of a sensor, s."""
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
        """Size of the data in one message of the array, as it travels; 0 = there is no array."""
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
