"""Target motion analysis in one process: simulated stations -> position tracks.

The same stage object as in the node, fed with the same frames: the reference the graph is compared
with, bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks
from sonar_tracking.evaluation.metrics.position_truth import truth_as_tracks
from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation, SimulatedFrame
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage, update_together

TRACKER = "tma_tracker"


@dataclass(frozen=True)
class OfflineTmaRun:
    """What the chain took and gave.

    Attributes
    ----------
    frames : tuple of SimulatedFrame
        Measurements, own ship and truth.
    updates : tuple of TmaUpdate
        One a frame in which a station reports.
    """

    frames: tuple[SimulatedFrame, ...]
    updates: tuple[TmaUpdate, ...]

    @property
    def tracks(self) -> tuple[PositionTracks, ...]:
        """The lists, in order."""
        return tuple(update.tracks for update in self.updates if update.tracks is not None)

    def score(self) -> PositionScore:
        """Return the score of the tracks against the truth."""
        truth = [truth_as_tracks(frame.truth_tracks) for frame in self.frames]
        return score_position_tracks(truth, self.tracks)


def run_offline_tma_chain(scenario: Scenario) -> OfflineTmaRun:
    """Run target motion analysis on a simulated scenario.

    Parameters
    ----------
    scenario : Scenario
        With bearing sensors; its ``nodes.tma_tracker`` configures the stage.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    return run_offline_tma_chains([scenario])[0]


def run_offline_tma_chains(scenarios: Sequence[Scenario]) -> list[OfflineTmaRun]:
    """Run target motion analysis on simulated scenarios that differ by their seeds alone.

    Parameters
    ----------
    scenarios : sequence of Scenario
        With bearing sensors; the ``nodes.tma_tracker`` of the first one configures the stages,
        which are computed at once.

    Raises
    ------
    ConfigurationError
        If a scenario or the parameters cannot be used.
    """
    given = dict(scenarios[0].nodes.get(TRACKER, {}))
    where = f"{scenarios[0].name}: nodes.{TRACKER}"
    configuration = stage_configuration(TmaTrackerConfiguration, given, where)
    stages = [TmaTrackerStage(configuration, len(one.bearing_sensors)) for one in scenarios]
    simulated = [iter(BearingSimulation(scenario).next_frame, None) for scenario in scenarios]
    frames: list[tuple[SimulatedFrame, ...]] = []
    updates: list[list[TmaUpdate]] = [[] for _ in scenarios]
    for together in zip(*simulated, strict=True):
        frames.append(together)
        passive = [passive_frame(frame) for frame in together]
        heard = [run for run, frame in enumerate(passive) if frame.bearings]
        taken = update_together([stages[run] for run in heard], [passive[run] for run in heard])
        for run, update in zip(heard, taken, strict=True):
            updates[run].append(update)
    every = zip(zip(*frames, strict=True), updates, strict=True)
    return [OfflineTmaRun(own, tuple(made)) for own, made in every]


def passive_frame(frame: SimulatedFrame) -> PassiveFrame:
    """Return what the stage takes of a simulated frame."""
    return PassiveFrame(
        stamp=frame.start_stamp,
        bearings=tuple(one.bearings for one in frame.reports if one.bearings is not None),
        lines=tuple(one.lines for one in frame.reports if one.lines is not None),
    )
