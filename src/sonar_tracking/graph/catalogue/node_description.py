"""What is known of a node before it is started (no ROS import)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from sonar_tracking.configuration import ParameterDescription, describe
from sonar_tracking.graph.catalogue.topics import Topic, TopicRole
from sonar_tracking.records.station_name import station_name


@dataclass(frozen=True)
class NodeDescription:
    """One node of the graph.

    Attributes
    ----------
    name : str
        Default name of the node and of its executable.
    module : str
        Run as ``python -m module``; empty = not started by the orchestration.
    description : str
        One line of what it does.
    configurations : tuple of type
        Configuration dataclasses its ROS parameters are declared from.
    inputs, outputs : tuple of Topic
        Data topics it subscribes to and publishes.
    optional_inputs : tuple of Topic
        Data topics it subscribes to, but does without where nobody publishes them.
    section : str
        Of a source of data: the section of a scenario it simulates, ``own_ship`` for the world. It
        emits everything due up to ``/clock``.
    on_request : bool
        Started only if the scenario names it under ``nodes``, not whenever its inputs are there.
    is_live : bool
        It brings in what others send while they send it. No run or replay starts it: their clocks
        wait for nobody outside.
    topic_parameters : mapping of str to Topic
        Inputs that may be several topics of one kind, by the parameter that lists their names;
        a scenario that does not set the parameter gets whatever its nodes publish. The first kind
        is needed, the others are optional.
    named_inputs : mapping of str to Topic
        Inputs that are only those whose names a parameter lists, by the parameter.
    station_outputs : tuple of Topic
        Published once for every namespace of the section, in it: of each bearing sensor, or of a
        ship beside own one.
    markers : tuple of Topic
        Pictures for RViz and Foxglove; they are recorded, but neither played nor compared.
    is_display : bool
        It only shows what the others find: nobody waits for it, and a run goes on without it. It
        is started wherever one of its inputs is there.
    commanded_topic : Topic or None
        The track list about which operators may tell it something; None = it takes no commands.
    station : str
        Namespace of the sensor or ship it is for; empty = of own ship.
    """

    name: str
    module: str = ""
    description: str = ""
    configurations: tuple[type, ...] = ()
    inputs: tuple[Topic, ...] = ()
    outputs: tuple[Topic, ...] = ()
    section: str = ""
    on_request: bool = False
    is_live: bool = False
    topic_parameters: Mapping[str, Topic] = field(default_factory=dict)
    station_outputs: tuple[Topic, ...] = ()
    markers: tuple[Topic, ...] = ()
    optional_inputs: tuple[Topic, ...] = ()
    is_display: bool = False
    commanded_topic: Topic | None = None
    named_inputs: Mapping[str, Topic] = field(default_factory=dict)
    station: str = ""

    @property
    def kind(self) -> str:
        """Name of the executable; that of the node begins with the station."""
        prefix = f"{station_name(self.station)}_" if self.station else ""
        return self.name.removeprefix(prefix)

    def at_station(self, station: str) -> NodeDescription:
        """Return the same node for the sensor or ship of a namespace; empty = for own ship."""
        if not station:
            return self
        commanded = self.commanded_topic

        def below(topics: tuple[Topic, ...]) -> tuple[Topic, ...]:
            return tuple(topic.below(station) for topic in topics)

        return replace(
            self,
            name=f"{station_name(station)}_{self.name}",
            station=station,
            inputs=below(self.inputs),
            optional_inputs=below(self.optional_inputs),
            outputs=below(self.outputs),
            markers=below(self.markers),
            commanded_topic=None if commanded is None else commanded.below(station),
        )

    @property
    def serves_clock(self) -> bool:
        """Whether it is a source of data."""
        return bool(self.section)

    @property
    def parameters(self) -> tuple[ParameterDescription, ...]:
        """Descriptions of all parameters of the node."""
        return tuple(entry for each in self.configurations for entry in describe(each))

    def published(self, namespaces: Mapping[str, tuple[str, ...]]) -> tuple[Topic, ...]:
        """Return the data topics of the node, with the role that they have as its own.

        What a sensor delivers is an input of the graph, even if another graph computes it; what is
        computed is an output, even if another sensor delivers it.

        Parameters
        ----------
        namespaces : mapping of str to tuple of str
            Of the stations of a sensor, by its section; absent = one station without a namespace.
        """
        stations = [
            topic.below(namespace)
            for namespace in namespaces.get(self.section, () if self.outputs else ("",))
            for topic in self.station_outputs
        ]
        is_source = self.section or self.is_live
        untrue = TopicRole.OUTPUT if is_source else TopicRole.INPUT
        role = TopicRole.INPUT if is_source else TopicRole.OUTPUT
        return tuple(
            replace(topic, role=role) if topic.role is untrue else topic
            for topic in (*self.outputs, *stations)
        )
