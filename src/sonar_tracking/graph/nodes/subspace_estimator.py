"""Node ``subspace_estimator``: array snapshots in, signal subspaces at each sample time out."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from typing import Any

from sonar_tracking.errors import Notice
from sonar_tracking.graph.catalogue.passive_nodes import SUBSPACE_ESTIMATOR
from sonar_tracking.graph.catalogue.topics import SNAPSHOTS, SUBSPACES
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.snapshot_bytes import SnapshotBytes
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage


class SubspaceEstimator(SonarNode):
    """Shell around :class:`sonar_tracking.passive.subspaces.subspace_stage.SubspaceStage`.

    The stage gives one estimate per sample time, also across rejected and missing blocks, so that
    a rejected block needs no substitute.
    """

    def __init__(self) -> None:
        super().__init__(SUBSPACE_ESTIMATOR)
        configuration = self.configuration(SubspaceConfiguration, check=SubspaceStage)
        self._stage = SubspaceStage(configuration)
        self._subspaces = self.data_publisher(SUBSPACES)
        self.data_subscriptions({SNAPSHOTS: SnapshotBytes()})

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Feed one block and publish every estimate it completes."""
        update = self._stage.update(records[SNAPSHOTS.name])
        for estimates in update.estimates:
            self._subspaces.publish(array_writing.subspaces_to_message(estimates))
        return update.notices

    def warm_up(self) -> None:
        """Let the stage do once what its first data need."""
        self._stage.warm_up()

    def reset(self) -> None:
        """Forget all data."""
        self._stage.reset()


def main() -> int:
    """Run the node."""
    return run_node(SubspaceEstimator)


if __name__ == "__main__":
    sys.exit(main())
