"""Stations, active sonars, their trackers and the fusions of all in one process.

The same stage objects as in the nodes, fed with the same frames: the reference the graph is
compared with, bit for bit. Ships that exchange what they have found each have a fusion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from sonar_tracking.configuration import parameter
from sonar_tracking.evaluation.offline.alike_scenarios import first_alike
from sonar_tracking.evaluation.offline.known_world import KnownWorld
from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.evaluation.offline.place_tracks import (
    ECHOES,
    PlaceTracks,
    belonging,
    below,
    node_at,
    nodes_asked_for,
    place_tracks,
    place_tracks_together,
    topics_of,
)
from sonar_tracking.fusion.foreign_lists import ForeignLists
from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.tma.targets.passive_frame import PassiveFrame

FUSION, OWN_LIST = "track_fusion", "own_tracks"


@dataclass(frozen=True)
class ForeignTopics:
    """What a fusion takes of other ships."""

    foreign_topics: tuple[str, ...] = parameter((), "fused tracks of other ships")


@dataclass
class FusedMoment:
    """What is known at one stamp before the fusion.

    Attributes
    ----------
    truth : TruthTracks
        Where the targets are.
    own_ship : KinematicState or None
        Where the ship of the fusion is.
    contacts : Contacts or None
        Of a ping sent then by its own sonar.
    passive : PassiveFrame or None
        Of the stations that report then.
    frame : FusionFrame
        What the trackers made of it.
    """

    truth: TruthTracks
    own_ship: KinematicState | None
    contacts: Contacts | None = None
    passive: PassiveFrame | None = None
    frame: FusionFrame = field(default_factory=lambda: FusionFrame(0))


def fused_moments(scenario: Scenario, place: str = "") -> Iterator[FusedMoment]:
    """Yield what the trackers of a scenario find for the fusion of a place, stamp by stamp.

    Parameters
    ----------
    scenario : Scenario
        Its ``nodes`` configure the trackers.
    place : str
        Namespace of the fusion; empty = own ship's.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    yield from fused_moments_together([scenario], place)[0]


def fused_moments_together(
    scenarios: Sequence[Scenario], place: str = ""
) -> list[Iterator[FusedMoment]]:
    """Return what the trackers find for the fusion of a place in several runs, stamp by stamp.

    Parameters
    ----------
    scenarios : sequence of Scenario
        With the same nodes and places.
    place : str
        Namespace of the fusion; empty = own ship's.

    Raises
    ------
    ConfigurationError
        If a scenario or the parameters cannot be used.
    """
    same = first_alike(scenarios)
    known = {one: KnownWorld(scenarios[one]) for one in set(same)}
    worlds = [known[one] for one in same]
    runs = zip(scenarios, worlds, place_tracks_together(scenarios, worlds), strict=True)
    return [_moments(scenario, place, world, told) for scenario, world, told in runs]


def make_track_fusion(scenario: Scenario, place: str = "") -> TrackFusionStage:
    """Return the stage of the fusion of a place as a scenario configures it."""
    name = node_at(place, FUSION)
    given, where = scenario.nodes.get(name, {}), f"{scenario.name}: nodes.{name}"
    configuration = stage_configuration(TrackFusionConfiguration, given, where)
    topics, places = topics_of(scenario), _fusions(scenario)
    kinds = (topics.active, topics.bearings, topics.passive)
    return TrackFusionStage(configuration, sum(len(belonging(one, place, places)) for one in kinds))


def run_offline_fusion_chain(
    scenario: Scenario, place: str = ""
) -> tuple[tuple[FusedMoment, ...], tuple[FusionUpdate, ...]]:
    """Return what the trackers found, and what a fusion made of it, one update a moment.

    Parameters
    ----------
    scenario : Scenario
        Its ``nodes`` configure the trackers and fusions.
    place : str
        Namespace of the fusion; empty = own ship's.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    world = KnownWorld(scenario)
    told = place_tracks(scenario, world)
    moments = tuple(_moments(scenario, place, world, told))
    stage = make_track_fusion(scenario, place)
    own = [stage.own_picture(one.frame) for one in moments]
    lists = ForeignLists(_foreign_topics(scenario, place))
    others = {below(one, OWN_LIST): one for one in _fusions(scenario) if one != place}
    known = [topic for topic in _foreign_topics(scenario, place) if topic in others]
    for topic in known:
        other = make_track_fusion(scenario, others[topic])
        for moment in _moments(scenario, others[topic], world, told):
            lists.add(topic, other.own_picture(moment.frame).tracks)
    updates = []
    for picture in own:
        lists.add_own(picture)
        for each, foreign in lists.ready(known):
            tracks, notices = stage.with_foreign(each, foreign)
            every = (*each.notices, *notices)
            updates.append(FusionUpdate(tracks, each.tracks, each.alignments, every))
    return moments, tuple(updates)


def _fusions(scenario: Scenario) -> list[str]:
    """Return the places that have a fusion; without one that is asked for, own ship."""
    return nodes_asked_for(scenario, FUSION) or [""]


def _foreign_topics(scenario: Scenario, place: str) -> tuple[str, ...]:
    name = node_at(place, FUSION)
    given, where = scenario.nodes.get(name, {}), f"{scenario.name}: nodes.{name}"
    return stage_configuration(ForeignTopics, given, where).foreign_topics


def _moments(
    scenario: Scenario, place: str, world: KnownWorld, told: PlaceTracks
) -> Iterator[FusedMoment]:
    places = _fusions(scenario)
    kinds = (told.active, told.bearings, told.passive)
    active, bearings, passive = (belonging(one.topics, place, places) for one in kinds)
    for stamp in sorted({stamp for one in kinds for stamp in one.at}):
        ship = world.ship(place, stamp)
        frame = FusionFrame(
            stamp,
            active=told.active.of(active, stamp),
            bearings=tuple(told.bearings.of(bearings, stamp).values()),
            passive=told.passive.of(passive, stamp),
            own_ship=ship,
        )
        if frame.active or frame.bearings or frame.passive:
            contacts = told.contacts.of([below(place, ECHOES)], stamp)
            heard = told.passive_frame(place, places, stamp, ship)
            yield FusedMoment(
                truth=world.truth(stamp),
                own_ship=ship,
                contacts=next(iter(contacts.values()), None),
                passive=heard if heard.bearings else None,
                frame=frame,
            )
