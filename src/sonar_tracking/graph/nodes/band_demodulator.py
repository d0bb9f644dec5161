"""Node ``band_demodulator``: broadband samples in, narrowband snapshots of one band out."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from typing import Any

from sonar_tracking.errors import Notice
from sonar_tracking.graph.catalogue.passive_nodes import BAND_DEMODULATOR
from sonar_tracking.graph.catalogue.topics import SAMPLES, SNAPSHOTS
from sonar_tracking.graph.message_writing.simulated_writing import snapshots_to_bytes
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.sample_reading import samples_from_message
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import (
    BandDemodulatorStage,
)


class BandDemodulator(SonarNode):
    """Shell around the stage of :mod:`sonar_tracking.passive.lines.band_demodulator_stage`.

    A block that cannot be used is missing in the snapshots, like a lost one.
    """

    def __init__(self) -> None:
        super().__init__(BAND_DEMODULATOR)
        self._stage = BandDemodulatorStage(self.configuration(BandDemodulatorConfiguration))
        self._snapshots = self.data_publisher(SNAPSHOTS)
        # Blocks that follow from one of samples are announced each: latencies count from them.
        self._snapshots.is_timed = bool(self.get_parameter("use_sim_time").value)
        self.data_subscriptions({SAMPLES: samples_from_message})

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Feed one block and publish the snapshots that are complete."""
        for block in self._stage.update(records[SAMPLES.name]):
            self._snapshots.publish(snapshots_to_bytes(block))
        return ()

    def reset(self) -> None:
        """Begin again with the next block."""
        self._stage.reset()


def main() -> int:
    """Run the node."""
    return run_node(BandDemodulator)


if __name__ == "__main__":
    sys.exit(main())
