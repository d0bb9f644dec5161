"""From element time series to positions in one process, with no measurement made by hand.

Samples -> snapshots -> subspaces -> bearing tracks, samples and bearing tracks -> frequency lines,
both -> positions: the same stage objects as in the nodes, fed in the same order of stamps, the
reference the graph is compared with, bit for bit.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
from sonar_tracking.passive.bearings.bearing_tracker_stage import update_together as tracks_together
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import (
    BandDemodulatorStage,
)
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.lines.line_tracker_stage import LineTrackerStage
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.passive.subspaces.subspace_stage import update_together as subspaces_together
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import FrequencyLines, LofarRows
from sonar_tracking.records.positions import PositionTracks, TruthTracks
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.sample_simulation import simulated_together
from sonar_tracking.simulation.sensors.simulated_data import SimulatedSamples
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from sonar_tracking.tma.tracker.tma_tracker_stage import update_together as positions_together


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


@dataclass(frozen=True)
class PositionsOfSamples:
    """What the chain gave of one of several runs, without its samples.

    Attributes
    ----------
    truth : tuple of TruthTracks
        One a block.
    frames : tuple of PassiveFrame
        What was heard, in order of the stamps.
    positions : tuple of PositionTracks
        One for each of the bearings.
    """

    truth: tuple[TruthTracks, ...]
    frames: tuple[PassiveFrame, ...]
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
    for (block,) in simulated_together([scenario]):
        blocks.append(block)
        _take([chain], [block.samples])
    ((_, positions),) = _positions([chain])
    return OfflineSampleRun(
        blocks=tuple(blocks),
        bearings=tuple(chain.bearings),
        lines=tuple(chain.lines),
        rows=tuple(chain.rows),
        positions=positions,
    )


def positions_of_samples(scenarios: Sequence[Scenario]) -> list[PositionsOfSamples]:
    """Run the chain on simulated scenarios that differ by their seeds alone, all at once.

    Parameters
    ----------
    scenarios : sequence of Scenario
        With hydrophones; the ``nodes`` of the first one configure the stages.

    Raises
    ------
    ConfigurationError
        If a scenario or the parameters cannot be used.
    """
    chains = [_Chain(scenario) for scenario in scenarios]
    truth: list[tuple[TruthTracks, ...]] = []
    for blocks in simulated_together(scenarios):
        truth.append(tuple(block.truth_tracks for block in blocks))
        _take(chains, [block.samples for block in blocks])
    every = zip(zip(*truth, strict=True), _positions(chains), strict=True)
    return [PositionsOfSamples(known, *found) for known, found in every]


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
    for (block,) in simulated_together([scenario]):
        _take([chain], [block.samples])
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
        self.demodulator = BandDemodulatorStage(
            stage_configuration(
                BandDemodulatorConfiguration,
                nodes.get("band_demodulator", {}),
                f"{where}band_demodulator",
            )
        )
        self.estimator = SubspaceStage(
            stage_configuration(
                SubspaceConfiguration,
                nodes.get("subspace_estimator", {}),
                f"{where}subspace_estimator",
            )
        )
        self.tracker = BearingTrackerStage(
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


def _take(chains: Sequence[_Chain], samples: Sequence[ArraySamples]) -> None:
    """Let chains that are configured alike follow a block each, later than the one before."""
    snapshots = [chain.demodulator.update(own) for chain, own in zip(chains, samples, strict=True)]
    estimators, trackers = [one.estimator for one in chains], [one.tracker for one in chains]
    for blocks in zip(*snapshots, strict=True):
        updates = subspaces_together(estimators, blocks)
        for estimates in zip(*(update.estimates for update in updates), strict=True):
            for chain, update in zip(chains, tracks_together(trackers, estimates), strict=True):
                chain.bearings.append(update.tracks)
    for chain, own in zip(chains, samples, strict=True):
        chain.listen(own)


def _positions(
    chains: Sequence[_Chain],
) -> list[tuple[tuple[PassiveFrame, ...], tuple[PositionTracks, ...]]]:
    """Return what was heard in each run, and the positions that one tracker a run makes of it."""
    name, scenario = "tma_tracker", chains[0].scenario
    configuration = stage_configuration(
        TmaTrackerConfiguration, scenario.nodes.get(name, {}), f"{scenario.name}: nodes.{name}"
    )
    stages = [TmaTrackerStage(configuration) for _ in chains]
    frames = [_frames(chain) for chain in chains]
    pictures: list[list[PositionTracks]] = [[] for _ in chains]
    for stamp in sorted({stamp for own in frames for stamp in own}):
        heard = [run for run, own in enumerate(frames) if stamp in own]
        updates = positions_together(
            [stages[run] for run in heard], [frames[run][stamp] for run in heard]
        )
        for run, update in zip(heard, updates, strict=True):
            if update.tracks is not None:
                pictures[run].append(update.tracks)
    return [
        (tuple(own.values()), tuple(found)) for own, found in zip(frames, pictures, strict=True)
    ]


def _frames(chain: _Chain) -> dict[int, PassiveFrame]:
    """Return what was heard, by the stamps in their order."""
    bearings_at: dict[int, tuple[BearingTracks, ...]] = defaultdict(tuple)
    lines_at: dict[int, tuple[FrequencyLines, ...]] = defaultdict(tuple)
    for picture in chain.bearings:
        bearings_at[picture.stamp] = (picture,)
    for heard in chain.lines:
        lines_at[heard.stamp] = (heard,)
    return {
        stamp: PassiveFrame(stamp, bearings=bearings_at[stamp], lines=lines_at[stamp])
        for stamp in sorted({*bearings_at, *lines_at})
    }
