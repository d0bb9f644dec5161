"""The active chain in one process: simulated pings -> position tracks.

The same stage object as in the node, fed with the same pings: the reference the graph is compared
with, bit for bit.
"""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_defaults import (
    ContactDefaultsConfiguration,
    with_defaults,
)
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks
from sonar_tracking.evaluation.metrics.position_truth import truth_as_tracks
from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.records.contacts import ContactTrackerUpdate
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.active_sonar_simulation import (
    ActiveSonarSimulation,
    ReceivedPing,
)

TRACKER = "hpda_tracker"


@dataclass(frozen=True)
class OfflineActiveRun:
    """What the chain took and gave.

    Attributes
    ----------
    pings : tuple of ReceivedPing
        Contacts, truth and own ship.
    updates : tuple of ContactTrackerUpdate
        Tracks, thresholds and notices, one a ping.
    """

    pings: tuple[ReceivedPing, ...]
    updates: tuple[ContactTrackerUpdate, ...]

    def score(self) -> PositionScore:
        """Return the score of the tracks against the truth."""
        truth = [truth_as_tracks(ping.truth_tracks) for ping in self.pings]
        return score_position_tracks(truth, [update.tracks for update in self.updates])


def run_offline_active_chain(scenario: Scenario) -> OfflineActiveRun:
    """Run the active chain on a simulated scenario.

    Parameters
    ----------
    scenario : Scenario
        With an active sonar; its ``nodes.hpda_tracker`` configures the stage.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    given = scenario.nodes.get(TRACKER, {})
    where = f"{scenario.name}: nodes.{TRACKER}"
    defaults = stage_configuration(ContactDefaultsConfiguration, given, where)
    tracker = make_contact_tracker(stage_configuration(ContactTrackerConfiguration, given, where))
    pings = tuple(ActiveSonarSimulation(scenario))
    updates = tuple(tracker.update(with_defaults(ping.contacts, defaults)) for ping in pings)
    return OfflineActiveRun(pings, updates)
