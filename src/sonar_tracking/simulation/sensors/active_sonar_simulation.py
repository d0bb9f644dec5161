"""Simulation of the active sonar of a scenario: pings with own ship and truth.

A ping is complete when its last echo has been received. The random numbers of a ping are drawn
together and in order, so that the data are a function of the scenario alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import END_OF_DATA, seconds
from sonar_tracking.simulation.scenarios.contact_configuration import number_of_pings
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.target import TargetConfiguration
from sonar_tracking.simulation.sensors.contact_simulation import ContactSimulation, ContactTarget
from sonar_tracking.simulation.world.world_state import own_ship_at, true_tracks

RANDOM_STREAM = 100
"""Of the sonar among those of the seed; the array of the same scenario has the first ones."""


@dataclass(frozen=True)
class ReceivedPing:
    """Everything that belongs to one ping.

    Attributes
    ----------
    contacts : Contacts
        The data.
    truth_tracks : TruthTracks
        True positions at the transmit time.
    own_ship : tuple of OwnShipState
        At the transmit time, unless the ping before has told it, and at the end of the reception.
    due_stamp : int
        End of the reception, ns.
    """

    contacts: Contacts
    truth_tracks: TruthTracks
    own_ship: tuple[OwnShipState, ...]
    due_stamp: int

    @property
    def start_stamp(self) -> int:
        """Transmit time, ns."""
        return self.contacts.stamp


class ActiveSonarSimulation:
    """Makes the pings of a scenario, one after the other.

    Parameters
    ----------
    scenario : Scenario
        With a section ``active_sonar``.

    Raises
    ------
    ConfigurationError
        If the scenario has no active sonar, lasts no ping, or has targets it cannot see.
    """

    def __init__(self, scenario: Scenario) -> None:
        if scenario.active_sonar is None:
            raise ConfigurationError(
                f"The scenario {scenario.name} has no section active_sonar to simulate."
            )
        self._scenario = scenario
        self._sensor = scenario.active_sonar
        self._n_pings = number_of_pings(self._sensor, scenario.duration)
        seed = np.random.SeedSequence(scenario.seed, spawn_key=(RANDOM_STREAM,))
        self._simulation = ContactSimulation(
            self._sensor,
            self._sensor.trajectory(scenario.platforms),
            [
                part
                for n, one in enumerate(scenario.targets, 1)
                for part in _contact_targets(n, one)
                if one.echoes
            ],
            np.random.default_rng(seed),
            scenario.epoch,
            scenario.start,
        )

    def __iter__(self) -> Iterator[ReceivedPing]:
        """Yield the pings in order; once."""
        told = 0
        for number in range(self._n_pings):
            sent = self._scenario.start + number * self._sensor.ping_interval
            received = self._scenario.stamp(sent + self._sensor.reception_time)
            ping = self._simulation.ping(number)
            last = number == self._n_pings - 1
            next_stamp = END_OF_DATA if last else ping.contacts.next_stamp
            stamps = sorted({ping.contacts.stamp, received} - {told})
            told = received
            yield ReceivedPing(
                contacts=replace(ping.contacts, next_stamp=next_stamp),
                truth_tracks=true_tracks(self._scenario, sent, next_stamp),
                own_ship=tuple(
                    own_ship_at(self._scenario, seconds(stamp - self._scenario.epoch))
                    for stamp in stamps
                ),
                due_stamp=received,
            )


def _contact_targets(number: int, target: TargetConfiguration) -> Iterator[ContactTarget]:
    """Yield a target once for each time that it is there."""
    motion = target.motion
    if not isinstance(motion, KinematicMotion):
        raise ConfigurationError(
            f"The target {target.name} gives bearings only, which an active sonar cannot see; give "
            "it a motion of kind: kinematic, with a position in map."
        )
    ends = target.present or (-np.inf, np.inf)
    for begin, end in zip(ends[::2], ends[1::2], strict=True):
        # The intervals of a scenario are half open.
        last = float(np.nextafter(end, -np.inf))
        yield ContactTarget(number, motion.trajectory, begin, last, target.echo_level_db)
