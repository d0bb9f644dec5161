"""Base of the nodes that simulate the world or a sensor: they publish whatever is due.

With simulation time a simulator emits, at each ``/clock``, everything due up to it, so that
skipped ticks do no harm, and reports on ``flow/done`` how far it has served the clock. A simulator
of a run follows the orchestration of that run alone, on ``flow/time``: a ``/clock`` of somebody
else would make it publish more than its consumers can take. Without simulation time, the scenario
begins at the present time of the node's clock, when somebody subscribes to its data: a real sensor
has no other stamps. See :mod:`sonar_tracking.graph.node_base.scenario_begin`.
"""

from __future__ import annotations

import pickle
from abc import abstractmethod
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Any, Protocol

import yaml
from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_configuration import SimulatorConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.resumption import resumes_after
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE, own_identity, signed
from sonar_tracking.graph.catalogue.topics import CLOCK_TOPIC, TIME_TOPIC
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
)

TOGETHER = 16
"""Most data that are simulated before the first of them is published."""

Snapshot = tuple[int, bytes]
"""Stamp of the last datum published, ns, and the pickled data that follow it."""


class SimulatedDatum(Protocol):
    """Everything a simulation delivers at once, e.g. a block or a ping."""

    @property
    def start_stamp(self) -> int:
        """Stamp of its data, ns."""

    @property
    def due_stamp(self) -> int:
        """Instant at which the last of it was received, ns."""


class SimulatorNode(SonarNode):
    """Publishes the data of a simulation when they are due.

    A subclass makes its publishers, calls :meth:`begin`, and overrides :meth:`data`,
    :meth:`publish` and :meth:`began`.

    Parameters
    ----------
    description : NodeDescription
        Name, parameters and topics, from the node catalogue.
    """

    def __init__(self, description: NodeDescription) -> None:
        super().__init__(description)
        self._section = description.section
        self._ticks = 0
        self._published = 0
        self._kept: deque[Snapshot] = deque(maxlen=2)
        self._data: Iterator[Any] = iter(())
        self._next: Any = None
        self._step = 0

    @abstractmethod
    def data(self, scenario: Scenario) -> Iterator[SimulatedDatum]:
        """Return the data of a scenario from their begin, in the order they are due.

        Raises
        ------
        ConfigurationError
            If the scenario cannot be simulated.
        """

    @abstractmethod
    def publish(self, datum: Any) -> None:
        """Publish one datum."""

    @abstractmethod
    def began(self, scenario: Scenario, now: int) -> int | None:
        """Return when the scenario has begun, ns of a clock without simulation time.

        It is asked again and again, with the present of that clock, until it knows; None = not yet.
        """

    def begin(self) -> None:
        """Read the scenario of the parameters and wait for the clock.

        Raises
        ------
        ConfigurationError
            If there is no such scenario, or nothing in it for this simulator.
        """
        configuration = self.configuration(SimulatorConfiguration)
        try:
            scenario = read_scenario(configuration.scenario)
            station = self.node_configuration.station
            if self._section not in scenario.simulated_in(station):
                place = f" in the station {station}" if station else ""
                raise ConfigurationError(
                    f"The scenario {scenario.name or configuration.scenario} has no section "
                    f"{self._section}{place} to simulate."
                )
            scenario = scenario.of_station(station)
            self._prepare(scenario)
        except ConfigurationError as error:
            raise ConfigurationError(f"{self.get_name()}.scenario: {error}") from error
        if self.get_parameter("use_sim_time").value:
            self._follow_time()
            return
        self._waiting: Scenario | None = scenario
        self.create_timer(scenario.step, self._pace)

    def serve(self, now: int) -> None:
        """Publish everything due up to a scenario stamp, ns."""
        while due := self._simulated(now):
            for datum in due:
                self.publish(datum)
            self.diagnostics.advance(due[-1].start_stamp)
            if self._kept and self._kept[-1][0] >= due[0].start_stamp:
                self._checkpoint.keep(due[-1].start_stamp)

    def _simulated(self, now: int) -> list[Any]:
        """Return data that are due, a few at once: one kind of work at a time is faster."""
        due: list[Any] = []
        while self._next is not None and self._next.due_stamp <= now and len(due) < TOGETHER:
            due.append(self._next)
            self._published += 1
            self._keep(self._next.start_stamp)
            self._next = next(self._data, None)
        return due

    def state(self) -> tuple[Snapshot, ...] | None:
        """Return the simulation after data some time ago, and before; None = it cannot be kept."""
        return tuple(self._kept) or None

    def take_state(self, state: tuple[Snapshot, ...]) -> None:
        """Go on with the latest of them that leaves out nothing that was not received."""
        received = resumes_after()
        self._kept.extend(each for each in state if received is not None and each[0] <= received)
        if self._kept:
            self._data = pickle.loads(self._kept[-1][1])
            self._next = next(self._data, None)

    def _keep(self, stamp: int) -> None:
        """Keep the simulation now and then, for a process in the place of this one.

        Consumers are never a whole history behind, so that one of the last two snapshots is not
        ahead of any of them. What cannot be pickled is simulated from its begin, which takes long
        for element data only.
        """
        if self._published % self.node_configuration.flow_depth == 0:
            with suppress(TypeError):
                self._kept.append((stamp, pickle.dumps(self._data)))

    def _follow_time(self) -> None:
        profile = quality_of_service.CLOCK
        if own_identity():
            self.create_subscription(Progress, TIME_TOPIC, self._take_time, profile)
        else:
            self.create_subscription(Clock, CLOCK_TOPIC, self._take_clock, profile)

    def _take_clock(self, clock: Clock) -> None:
        self._tick(clock.clock)

    def _take_time(self, told: Progress) -> None:
        if told.node == signed(CONTROL_NODE):
            self._tick(told.header.stamp)

    def _tick(self, time: Time) -> None:
        now = stamp_from_time(time)
        if self._ticks == 0:
            self._checkpoint.take_up(now)
            self._skip_past(now)
        self.serve(now)
        self._ticks += 1
        self.progress.report(CLOCK_TOPIC, self._ticks, now)

    def _prepare(self, scenario: Scenario) -> None:
        self._step = nanoseconds(scenario.step)
        self._data = self.data(scenario)
        self._next = next(self._data, None)

    def _pace(self) -> None:
        now = self.get_clock().now().nanoseconds
        if self._waiting is not None:
            begun = self.began(self._waiting, now)
            if begun is None:
                return
            self._prepare(replace(self._waiting, epoch=begun - nanoseconds(self._waiting.start)))
            self._skip_past(now)
            self._waiting = None
        self.serve(now)

    def _skip_past(self, now: int) -> None:
        """Leave out what was published before this process was started (again).

        What may have been lost with the previous process is repeated: what all consumers have
        finished is not, and of what is not known consumers ignore duplicates.
        """
        repeated = self.node_configuration.flow_depth // 2
        received = resumes_after()
        while self._next is not None:
            length = max(self._next.due_stamp - self._next.start_stamp, self._step)
            known = received is not None and self._next.start_stamp <= received
            if not known and self._next.due_stamp > now - repeated * length:
                return
            self._next = next(self._data, None)


def read_scenario(value: str) -> Scenario:
    """Return the scenario a parameter names, or spells out as YAML text of several lines.

    Raises
    ------
    ConfigurationError
        When there is none of that name, or it is malformed.
    """
    if "\n" not in value:
        return load_scenario(value)
    try:
        mapping = yaml.safe_load(value)
    except yaml.YAMLError as error:
        raise ConfigurationError(f"The text of the scenario is not YAML: {error}.") from error
    if not isinstance(mapping, dict):
        raise ConfigurationError("The text of the scenario must be a mapping of names to values.")
    return scenario_from_mapping(mapping, "scenario")
