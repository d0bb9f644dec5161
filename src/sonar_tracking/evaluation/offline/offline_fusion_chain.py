"""Stations, active sonar, their trackers and the fusion of all in one process.

The same stage objects as in the nodes, fed with the same frames: the reference the graph is
compared with, bit for bit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_defaults import (
    ContactDefaultsConfiguration,
    with_defaults,
)
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.evaluation.offline.offline_tma_chain import passive_frame
from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.motion import KinematicState
from sonar_tracking.own_ship_interpolation import motion_in_map
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import PositionTracks, TruthTracks
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation
from sonar_tracking.simulation.world.world_simulation import WorldSimulation
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.targets.tma_tracker_stage import TmaTrackerStage

ECHOES, POSITIONS = "active/tracks", "passive/tracks"
FUSION, CONTACT_TRACKER, TMA = "track_fusion", "hpda_tracker", "tma_tracker"


@dataclass
class FusedMoment:
    """What is known at one stamp before the fusion.

    Attributes
    ----------
    truth : TruthTracks
        Where the targets are.
    own_ship : KinematicState
        Where own ship is.
    contacts : Contacts or None
        Of a ping sent then.
    passive : PassiveFrame or None
        Of the stations that report then.
    frame : FusionFrame
        What the trackers made of it.
    """

    truth: TruthTracks
    own_ship: KinematicState
    contacts: Contacts | None = None
    passive: PassiveFrame | None = None
    frame: FusionFrame = field(default_factory=lambda: FusionFrame(0))


def fused_moments(scenario: Scenario) -> Iterator[FusedMoment]:
    """Yield what the trackers of a scenario find, stamp by stamp.

    Parameters
    ----------
    scenario : Scenario
        With an active sonar and stations; its ``nodes`` configure the trackers.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    given = scenario.nodes.get(CONTACT_TRACKER, {})
    where = f"{scenario.name}: nodes.{CONTACT_TRACKER}"
    defaults = stage_configuration(ContactDefaultsConfiguration, given, where)
    echoes = make_contact_tracker(stage_configuration(ContactTrackerConfiguration, given, where))
    where = f"{scenario.name}: nodes.{TMA}"
    told = stage_configuration(TmaTrackerConfiguration, scenario.nodes.get(TMA, {}), where)
    positions = TmaTrackerStage(told, len(scenario.bearing_sensors))
    for stamp, moment in sorted(_received(scenario).items()):
        active: dict[str, PositionTracks] = {}
        passive: dict[str, PositionTracks] = {}
        if moment.contacts is not None:
            active[ECHOES] = echoes.update(with_defaults(moment.contacts, defaults)).tracks
        if moment.passive is not None:
            found = positions.update(moment.passive).tracks
            if found is not None:
                passive[POSITIONS] = found
        bearings = () if moment.passive is None else moment.passive.bearings
        if active or bearings or passive:
            moment.frame = FusionFrame(stamp, active, bearings, passive, moment.own_ship)
            yield moment


def make_track_fusion(scenario: Scenario) -> TrackFusionStage:
    """Return the stage of the fusion as a scenario configures it."""
    given = scenario.nodes.get(FUSION, {})
    where = f"{scenario.name}: nodes.{FUSION}"
    configuration = stage_configuration(TrackFusionConfiguration, given, where)
    return TrackFusionStage(configuration, 2 + len(scenario.bearing_sensors))


def run_offline_fusion_chain(
    scenario: Scenario,
) -> tuple[tuple[FusedMoment, ...], tuple[FusionUpdate, ...]]:
    """Return what the trackers found, and what the fusion made of it, one update a moment."""
    stage = make_track_fusion(scenario)
    moments = tuple(fused_moments(scenario))
    return moments, tuple(stage.update(one.frame) for one in moments)


def _received(scenario: Scenario) -> dict[int, FusedMoment]:
    """Return what the sensors receive, by stamp."""
    world = WorldSimulation(scenario)
    received: dict[int, FusedMoment] = {}
    while (instant := world.next_instant()) is not None:
        if instant.truth_tracks is not None and instant.own_ship is not None:
            own_ship = motion_in_map(instant.own_ship)
            received[instant.stamp] = FusedMoment(instant.truth_tracks, own_ship)
    for ping in ActiveSonarSimulation(scenario):
        received[ping.start_stamp].contacts = ping.contacts
    simulation = BearingSimulation(scenario)
    while (frame := simulation.next_frame()) is not None:
        passive = passive_frame(frame)
        if passive.bearings:
            received[frame.start_stamp].passive = passive
    return received
