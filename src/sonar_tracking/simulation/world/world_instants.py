"""The instants at which the sensors of a scenario need own ship and the truth.

Whoever joins data with odometry needs own ship at both ends of what was received: a block of an
array from its first snapshot to the begin of the next one, a ping from its transmission to its last
echo, a frame of a station at its stamp. The truth is told at the stamps of the data, for scoring.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from sonar_tracking.records.time import seconds
from sonar_tracking.simulation.scenarios.contact_configuration import number_of_pings
from sonar_tracking.simulation.scenarios.scenario import Scenario

Instant = tuple[int, float]
"""Stamp, ns, and scenario time, s."""


class Instants(Protocol):
    """Ascending instants, numbered from 0."""

    def at(self, number: int) -> Instant | None:
        """Return an instant, None after the last one."""


@dataclass(frozen=True)
class BlockEdges:
    """Where the blocks of the array begin, and the last one ends.

    Attributes
    ----------
    scenario : Scenario
        With an array.
    has_end : bool
        Whether the end of the last block is one of them.
    """

    scenario: Scenario
    has_end: bool

    def at(self, number: int) -> Instant | None:
        """Return an instant, None after the last one."""
        scenario = self.scenario
        length, total = scenario.block_length, scenario.n_samples
        begun = number * length
        if begun >= total + (length if self.has_end else 0):
            return None
        time = scenario.start + min(begun, total) / scenario.sample_rate
        return scenario.stamp(time), time


@dataclass(frozen=True)
class Repeated:
    """Instants at a constant interval.

    Attributes
    ----------
    scenario : Scenario
        Whose begin is the first of them.
    interval : float
        s.
    count : int
        Of them.
    delay : float
        Of all of them, s.
    """

    scenario: Scenario
    interval: float
    count: int
    delay: float = 0.0

    def at(self, number: int) -> Instant | None:
        """Return an instant, None after the last one."""
        if number >= self.count:
            return None
        time = self.scenario.start + number * self.interval + self.delay
        return self.scenario.stamp(time), time


@dataclass(frozen=True)
class AsStamped:
    """Instants at the times that their stamps tell, which are whole nanoseconds."""

    instants: Repeated

    def at(self, number: int) -> Instant | None:
        """Return an instant, None after the last one."""
        exact = self.instants.at(number)
        if exact is None:
            return None
        return exact[0], seconds(exact[0] - self.instants.scenario.epoch)


@dataclass(frozen=True)
class NeededInstants:
    """What all sensors of a scenario need; of one stamp in several, the last one counts.

    Attributes
    ----------
    own_ship, truth : tuple of Instants
        When the state of own ship and its consort, and those of the targets, are needed.
    """

    own_ship: tuple[Instants, ...]
    truth: tuple[Instants, ...]


def needed_instants(scenario: Scenario) -> NeededInstants:
    """Return the instants that the sensors of a scenario need."""
    own_ship: list[Instants] = []
    truth: list[Instants] = []
    for place in scenario.places.values():
        if place.array_given:
            own_ship.append(BlockEdges(place, has_end=True))
            truth.append(BlockEdges(place, has_end=False))
        for station in place.bearing_sensors:
            n_frames = station.number_of_frames(scenario.duration)
            frames = Repeated(scenario, station.frame_interval, n_frames)
            own_ship.append(frames)
            truth.append(frames)
        sonar = place.active_sonar
        if sonar is not None:
            n_pings = number_of_pings(sonar, scenario.duration)
            sent = Repeated(scenario, sonar.ping_interval, n_pings)
            received = Repeated(scenario, sonar.ping_interval, n_pings, sonar.reception_time)
            own_ship += [AsStamped(sent), AsStamped(received)]
            truth.append(sent)
    return NeededInstants(tuple(own_ship), tuple(truth))
