"""What the trackers of every place make of what its sensors receive, by stamp and topic.

Own ship, its consort, stations and buoys each have a namespace, below which their topics are; of
several nodes of one kind, a topic is for that of the nearest place. The same stage objects as in
the nodes, fed with the same data.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_defaults import (
    ContactDefaultsConfiguration,
    with_defaults,
)
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.multi_target_tracker import trackers_together as contacts_together
from sonar_tracking.evaluation.offline.alike_scenarios import first_alike
from sonar_tracking.evaluation.offline.known_world import KnownWorld
from sonar_tracking.evaluation.offline.offline_bearing_chain import (
    run_offline_chain,
    stage_configuration,
)
from sonar_tracking.evaluation.offline.offline_sample_chain import heard_on_hydrophones
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.station_name import station_name
from sonar_tracking.simulation.scenarios.scenario import NodeParameters, Scenario
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage, update_together

CONTACT_TRACKER, TMA = "hpda_tracker", "tma_tracker"
ECHOES, POSITIONS = "active/tracks", "passive/tracks"
BEARINGS, LINES = "passive/bearing_tracks", "passive/frequency_lines"

Record = TypeVar("Record")


@dataclass
class ToldByTopic(Generic[Record]):
    """Records of one kind.

    Attributes
    ----------
    topics : list of str
        In the order of the graph.
    at : dict of int to dict of str to record
        By stamp, ns, and topic.
    """

    topics: list[str]
    at: dict[int, dict[str, Record]]

    def of(self, topics: Iterable[str], stamp: int) -> dict[str, Record]:
        """Return what some topics tell at a stamp, ns, in their order."""
        told = self.at.get(stamp, {})
        return {topic: told[topic] for topic in topics if topic in told}

    def add(self, topic: str, stamp: int, record: Record) -> None:
        """Add what a topic tells at a stamp, ns."""
        self.at.setdefault(stamp, {})[topic] = record


@dataclass
class PlaceTracks:
    """What all trackers tell before any fusion.

    Attributes
    ----------
    contacts : ToldByTopic of Contacts
        By the topic of the tracks that they make.
    active, passive : ToldByTopic of PositionTracks
        Of echoes; of bearings.
    bearings : ToldByTopic of BearingTracks
        Of arrays and bearing sensors.
    lines : ToldByTopic of FrequencyLines
        Of them, too.
    """

    contacts: ToldByTopic[Contacts]
    active: ToldByTopic[PositionTracks]
    passive: ToldByTopic[PositionTracks]
    bearings: ToldByTopic[BearingTracks]
    lines: ToldByTopic[FrequencyLines]

    def passive_frame(
        self, place: str, places: Iterable[str], stamp: int, ship: KinematicState | None
    ) -> PassiveFrame:
        """Return what a place hears at a stamp.

        Parameters
        ----------
        place : str
            Whose node takes it.
        places : iterable of str
            All that have such a node.
        stamp : int
            ns.
        ship : KinematicState or None
            The ship of the place at the stamp; None = not known.
        """
        known = tuple(places)
        bearings = belonging(self.bearings.topics, place, known)
        lines = belonging(self.lines.topics, place, known)
        return PassiveFrame(
            stamp=stamp,
            bearings=tuple(self.bearings.of(bearings, stamp).values()),
            lines=tuple(self.lines.of(lines, stamp).values()),
            own_ship=ship,
        )


def below(namespace: str, name: str) -> str:
    """Return the name of a topic of a place."""
    return f"{namespace}/{name}" if namespace else name


def node_at(namespace: str, name: str) -> str:
    """Return the name of a node of a place."""
    return f"{station_name(namespace)}_{name}" if namespace else name


def nodes_asked_for(scenario: Scenario, name: str) -> list[str]:
    """Return the namespaces that have a node under ``nodes``, own ship's first."""
    places = ("", *scenario.station_namespaces)
    return [place for place in places if node_at(place, name) in scenario.nodes]


def belonging(topics: Iterable[str], place: str, places: Iterable[str]) -> list[str]:
    """Return the topics that are for the node of a place, of those that have such a node."""

    def is_of(topic: str, namespace: str) -> bool:
        return not namespace or topic.startswith(f"{namespace}/")

    known = tuple(places)
    return [
        topic
        for topic in topics
        if place == max((one for one in known if is_of(topic, one)), key=len, default=None)
    ]


@dataclass(frozen=True)
class PlaceTopics:
    """The topics of all places, in the order of the graph.

    Attributes
    ----------
    active, passive, bearings, lines : list of str
        By kind, as in :class:`PlaceTracks`.
    """

    active: list[str]
    passive: list[str]
    bearings: list[str]
    lines: list[str]


def topics_of(scenario: Scenario) -> PlaceTopics:
    """Return the topics on which the trackers of a scenario tell what they find."""
    sensors = [one.namespace for one in scenario.bearing_sensors]
    places = _simulated_places(scenario)
    arrays = [name for name, place in places.items() if place.array_given]
    wet = [name for name in arrays if places[name].hydrophones is not None]
    sonars = [name for name, place in places.items() if place.active_sonar is not None]
    return PlaceTopics(
        active=[below(name, ECHOES) for name in sonars],
        passive=[below(name, POSITIONS) for name in nodes_asked_for(scenario, TMA)],
        bearings=[below(name, BEARINGS) for name in (*sensors, *arrays)],
        lines=[below(name, LINES) for name in (*sensors, *wet)],
    )


def place_tracks(scenario: Scenario, world: KnownWorld) -> PlaceTracks:
    """Simulate the sensors of all places, and follow what they receive.

    Parameters
    ----------
    scenario : Scenario
        Its ``nodes`` configure the trackers; target motion analysis is done where it is asked for.
    world : KnownWorld
        What odometry tells.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    return place_tracks_together([scenario], [world])[0]


def place_tracks_together(
    scenarios: Sequence[Scenario], worlds: Sequence[KnownWorld]
) -> list[PlaceTracks]:
    """Simulate the sensors of all places in several runs, and follow what they receive.

    Parameters
    ----------
    scenarios : sequence of Scenario
        With the same nodes and places.
    worlds : sequence of KnownWorld
        What odometry tells in each.

    Raises
    ------
    ConfigurationError
        If a scenario or the parameters cannot be used.
    """
    told = [_bearings_and_lines(scenario) for scenario in scenarios]
    places = [_simulated_places(scenario) for scenario in scenarios]
    for namespace, place in places[0].items():
        if place.active_sonar is not None:
            sonars = [own[namespace] for own in places]
            _follow_sonars(sonars, namespace, told, first_alike(scenarios))
    for namespace in nodes_asked_for(scenarios[0], TMA):
        _find_positions(scenarios, namespace, worlds, told)
    return told


def _bearings_and_lines(scenario: Scenario) -> PlaceTracks:
    """Return what arrays and bearing sensors tell: nothing yet of echoes and positions."""
    topics = topics_of(scenario)
    told = PlaceTracks(
        contacts=ToldByTopic(topics.active, {}),
        active=ToldByTopic(topics.active, {}),
        passive=ToldByTopic(topics.passive, {}),
        bearings=ToldByTopic(topics.bearings, {}),
        lines=ToldByTopic(topics.lines, {}),
    )
    if scenario.bearing_sensors:
        _follow_bearing_sensors(scenario, told)
    for namespace, place in _simulated_places(scenario).items():
        if place.array_given:
            _follow_array(place, namespace, told)
    return told


def _simulated_places(scenario: Scenario) -> dict[str, Scenario]:
    """Return what concerns each place, nodes included, as if it was own ship."""
    places = scenario.places
    order = ("", *(one for one in scenario.station_namespaces if one in places))
    return {name: replace(places[name], nodes=_nodes_of(scenario, name)) for name in order}


def _nodes_of(scenario: Scenario, namespace: str) -> NodeParameters:
    """Return the parameters of the nodes of a place, as if it was own ship."""
    prefix = node_at(namespace, "")
    return {
        name.removeprefix(prefix): values
        for name, values in scenario.nodes.items()
        if name.startswith(prefix)
    }


def _follow_bearing_sensors(scenario: Scenario, told: PlaceTracks) -> None:
    places = [sensor.namespace for sensor in scenario.bearing_sensors]
    for reports in iter(BearingSimulation(scenario).next_reports, ()):
        for report in reports:
            place, stamp = places[report.station], report.truth.stamp
            if report.bearings is not None:
                told.bearings.add(below(place, BEARINGS), stamp, report.bearings)
            if report.lines is not None:
                told.lines.add(below(place, LINES), stamp, report.lines)


def _follow_array(place: Scenario, namespace: str, told: PlaceTracks) -> None:
    topic = below(namespace, BEARINGS)
    if place.hydrophones is None:
        bearings = run_offline_chain(place).tracks
    else:
        bearings, lines = heard_on_hydrophones(place)
        for heard in lines:
            told.lines.add(below(namespace, LINES), heard.stamp, heard)
    for tracks in bearings:
        told.bearings.add(topic, tracks.stamp, tracks)


def _follow_sonars(
    places: Sequence[Scenario],
    namespace: str,
    every: Sequence[PlaceTracks],
    same: Sequence[int],
) -> None:
    """Let the trackers of echoes of a place follow what its sonar receives, all runs at once.

    Runs of the same number, that of one of them, receive the same.
    """
    given, topic = places[0].nodes.get(CONTACT_TRACKER, {}), below(namespace, ECHOES)
    where = f"{places[0].name}: nodes.{node_at(namespace, CONTACT_TRACKER)}"
    defaults = stage_configuration(ContactDefaultsConfiguration, given, where)
    configuration = stage_configuration(ContactTrackerConfiguration, given, where)
    heard = sorted(set(same))
    trackers = [make_contact_tracker(configuration) for _ in heard]
    for pings in zip(*(ActiveSonarSimulation(places[one]) for one in heard), strict=True):
        contacts = [with_defaults(ping.contacts, defaults) for ping in pings]
        found = zip(pings, contacts_together(trackers, contacts), strict=True)
        known = dict(zip(heard, found, strict=True))
        for told, one in zip(every, same, strict=True):
            ping, update = known[one]
            told.contacts.add(topic, ping.start_stamp, ping.contacts)
            told.active.add(topic, ping.start_stamp, update.tracks)


def _find_positions(
    scenarios: Sequence[Scenario],
    namespace: str,
    worlds: Sequence[KnownWorld],
    every: Sequence[PlaceTracks],
) -> None:
    """Let the trackers of a place find positions, those of all runs at once."""
    places, name = nodes_asked_for(scenarios[0], TMA), node_at(namespace, TMA)
    configuration = stage_configuration(
        TmaTrackerConfiguration, scenarios[0].nodes[name], f"{scenarios[0].name}: nodes.{name}"
    )
    topics = belonging(every[0].bearings.topics, namespace, places)
    stages = [TmaTrackerStage(configuration, len(topics)) for _ in scenarios]
    for stamp in sorted({one for told in every for one in (*told.bearings.at, *told.lines.at)}):
        frames = [
            told.passive_frame(namespace, places, stamp, world.ship(namespace, stamp))
            for told, world in zip(every, worlds, strict=True)
        ]
        heard = [run for run, frame in enumerate(frames) if frame.bearings or frame.lines]
        updates = update_together([stages[run] for run in heard], [frames[run] for run in heard])
        for run, update in zip(heard, updates, strict=True):
            if update.tracks is not None:
                every[run].passive.add(below(namespace, POSITIONS), stamp, update.tracks)
