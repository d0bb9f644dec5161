"""From element time series to positions in one process, with no measurement made by hand.

Samples -> snapshots -> subspaces -> bearing tracks, samples and bearing tracks -> frequency lines,
both -> positions: the same stage objects as in the nodes, fed in the same order of stamps, the
reference the graph is compared with, bit for bit.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import (
    BandDemodulatorStage,
)
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.lines.line_tracker_stage import LineTrackerStage
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import FrequencyLines, LofarRows
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.sample_simulation import SampleSimulation
from sonar_tracking.simulation.sensors.simulated_data import SimulatedSamples
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage


@dataclass(frozen=True)
class OfflineSampleRun:
    """What the chain gave.

    Attributes
    ----------
    blocks : tuple of SimulatedSamples
        Samples, truth and own ship.
    bearings : tuple of BearingTracks
        One a sample time.
    lines : tuple of FrequencyLines
        One a frame.
    rows : tuple of LofarRows
        One a frame with samples.
    positions : tuple of PositionTracks
        One for each of the bearings.
    """

    blocks: tuple[SimulatedSamples, ...]
    bearings: tuple[BearingTracks, ...]
    lines: tuple[FrequencyLines, ...]
    rows: tuple[LofarRows, ...]
    positions: tuple[PositionTracks, ...]


def run_offline_sample_chain(scenario: Scenario) -> OfflineSampleRun:
    """Run the chain on a simulated scenario.

    Parameters
    ----------
    scenario : Scenario
        With hydrophones; its ``nodes`` configure the stages.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    chain = _Chain(scenario)
    blocks = []
    for block in iter(SampleSimulation(scenario).next_block, None):
        blocks.append(block)
        chain.take(block.samples)
    return OfflineSampleRun(
        blocks=tuple(blocks),
        bearings=tuple(chain.bearings),
        lines=tuple(chain.lines),
        rows=tuple(chain.rows),
        positions=_positions(scenario, chain.bearings, chain.lines),
    )


def heard_on_hydrophones(
    scenario: Scenario,
) -> tuple[tuple[BearingTracks, ...], tuple[FrequencyLines, ...]]:
    """Return the bearing tracks and frequency lines of a simulated scenario, without positions.

    Parameters
    ----------
    scenario : Scenario
        With hydrophones; its ``nodes`` configure the stages.

    Raises
    ------
    ConfigurationError
        If the scenario or the parameters cannot be used.
    """
    chain = _Chain(scenario)
    for block in iter(SampleSimulation(scenario).next_block, None):
        chain.take(block.samples)
    return tuple(chain.bearings), tuple(chain.lines)


@dataclass
class _Chain:
    """The stages and what they have given so far."""

    scenario: Scenario
    bearings: list[BearingTracks] = field(default_factory=list)
    lines: list[FrequencyLines] = field(default_factory=list)
    rows: list[LofarRows] = field(default_factory=list)

    def __post_init__(self) -> None:
        nodes, where = self.scenario.nodes, f"{self.scenario.name}: nodes."
        self._demodulator = BandDemodulatorStage(
            stage_configuration(
                BandDemodulatorConfiguration,
                nodes.get("band_demodulator", {}),
                f"{where}band_demodulator",
            )
        )
        self._estimator = SubspaceStage(
            stage_configuration(
                SubspaceConfiguration,
                nodes.get("subspace_estimator", {}),
                f"{where}subspace_estimator",
            )
        )
        self._tracker = BearingTrackerStage(
            stage_configuration(
                BearingTrackerConfiguration,
                nodes.get("bearing_tracker", {}),
                f"{where}bearing_tracker",
            )
        )
        self._line_tracker = LineTrackerStage(
            stage_configuration(
                LineTrackerConfiguration, nodes.get("line_tracker", {}), f"{where}line_tracker"
            )
        )
        self._waiting: list[ArraySamples] = []
        self._told = 0

    def take(self, samples: ArraySamples) -> None:
        """Follow a block of samples, later than the one before."""
        self.bearings.extend(self.bearings_of(samples))
        self.listen(samples)

    def bearings_of(self, samples: ArraySamples) -> list[BearingTracks]:
        """Return the pictures that a block of samples completes."""
        return [
            self._tracker.update(estimates).tracks
            for snapshots in self._demodulator.update(samples)
            for estimates in self._estimator.update(snapshots).estimates
        ]

    def listen(self, samples: ArraySamples) -> None:
        """Take the samples up to whose begin the bearings are known to the line tracker."""
        self._waiting.append(samples)
        known = self.bearings[-1].next_stamp if self.bearings else 0
        while self._waiting and (self._waiting[0].stamp < known or known == END_OF_DATA):
            block = self._waiting.pop(0)
            # At equal stamps the samples go before the bearings, as in the graph.
            ahead = [each for each in self.bearings[self._told :] if each.stamp < block.stamp]
            self._told += len(ahead)
            for update in self._line_tracker.update(block, ahead):
                self.lines.append(update.lines)
                self.rows.extend([] if update.rows is None else [update.rows])


def _positions(
    scenario: Scenario, bearings: list[BearingTracks], lines: list[FrequencyLines]
) -> tuple[PositionTracks, ...]:
    name = "tma_tracker"
    configuration = stage_configuration(
        TmaTrackerConfiguration, scenario.nodes.get(name, {}), f"{scenario.name}: nodes.{name}"
    )
    stage = TmaTrackerStage(configuration)
    bearings_at: dict[int, tuple[BearingTracks, ...]] = defaultdict(tuple)
    lines_at: dict[int, tuple[FrequencyLines, ...]] = defaultdict(tuple)
    for picture in bearings:
        bearings_at[picture.stamp] = (picture,)
    for heard in lines:
        lines_at[heard.stamp] = (heard,)
    pictures = []
    for stamp in np.unique([*bearings_at, *lines_at]).tolist():
        frame = PassiveFrame(stamp=stamp, bearings=bearings_at[stamp], lines=lines_at[stamp])
        tracks = stage.update(frame).tracks
        if tracks is not None:
            pictures.append(tracks)
    return tuple(pictures)
