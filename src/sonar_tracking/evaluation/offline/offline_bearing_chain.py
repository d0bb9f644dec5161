"""The passive chain in one process: simulation -> subspaces -> bearing tracks.

The same stage objects as in the nodes, fed with the same blocks: the reference the graph is
compared with, bit for bit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sonar_tracking.configuration import ConfigurationType, Value, describe, from_mapping
from sonar_tracking.errors import Notice
from sonar_tracking.evaluation.metrics.bearing_score import BearingScore, score_bearing_tracks
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
    check_estimator,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.subspaces.subspace_method import SubspaceMethod
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation


@dataclass(frozen=True)
class OfflineRun:
    """What the chain gave.

    Attributes
    ----------
    truth : tuple of BearingTracks
        True bearings, one a block.
    tracks : tuple of BearingTracks
        Tracks, one a sample time.
    notices : tuple of Notice
        Of both stages, in order.
    """

    truth: tuple[BearingTracks, ...]
    tracks: tuple[BearingTracks, ...]
    notices: tuple[Notice, ...]

    def score(self) -> BearingScore:
        """Return the score of the tracks against the truth."""
        return score_bearing_tracks(self.truth, self.tracks)


def stage_configuration(
    configuration: type[ConfigurationType], parameters: Mapping[str, Value], where: str
) -> ConfigurationType:
    """Return the configuration of a stage from the parameters of its node.

    Parameters of the node that are none of the stage, like the depth of its queues, are left out.
    """
    known = {description.name for description in describe(configuration)}
    values = {name: value for name, value in parameters.items() if name in known}
    return from_mapping(configuration, values, where)


def run_offline_chain(scenario: Scenario) -> OfflineRun:
    """Run the passive chain on a simulated scenario.

    Parameters
    ----------
    scenario : Scenario
        Its ``nodes.subspace_estimator`` and ``nodes.bearing_tracker`` configure the stages.

    Raises
    ------
    ConfigurationError
        If the parameters cannot be used.
    InputError
        If a stage rejects the data, e.g. of an array with fewer elements than sources.
    """
    estimator, tracker = bearing_stages(scenario)
    truth: list[BearingTracks] = []
    tracks: list[BearingTracks] = []
    notices: list[Notice] = []
    for block in iter(ArraySimulation(scenario).next_block, None):
        truth.append(block.truth_bearings)
        subspaces = estimator.update(block.snapshots)
        notices.extend(subspaces.notices)
        for estimates in subspaces.estimates:
            tracked = tracker.update(estimates)
            tracks.append(tracked.tracks)
            notices.extend(tracked.notices)
    return OfflineRun(tuple(truth), tuple(tracks), tuple(notices))


def bearing_stages(
    scenario: Scenario, method: SubspaceMethod[Any] | None = None
) -> tuple[SubspaceStage, BearingTrackerStage]:
    """Return the two stages of a scenario before its first block.

    Parameters
    ----------
    scenario : Scenario
        Its ``nodes.subspace_estimator`` and ``nodes.bearing_tracker`` configure the stages.
    method : SubspaceMethod, optional
        What follows the subspace, if not the method of the scenario.

    Raises
    ------
    ConfigurationError
        If the parameters cannot be used.
    """
    estimator_name, tracker_name = "subspace_estimator", "bearing_tracker"
    estimator_configuration = stage_configuration(
        SubspaceConfiguration,
        scenario.nodes.get(estimator_name, {}),
        f"{scenario.name}: nodes.{estimator_name}",
    )
    tracker_configuration = stage_configuration(
        BearingTrackerConfiguration,
        scenario.nodes.get(tracker_name, {}),
        f"{scenario.name}: nodes.{tracker_name}",
    )
    check_estimator(tracker_configuration, estimator_configuration)
    estimator = SubspaceStage(estimator_configuration, method)
    return estimator, BearingTrackerStage(tracker_configuration)
