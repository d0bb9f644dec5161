"""Protects that a run is measured from its command to its end, as a user starts it."""

from pathlib import Path

import pytest

from sonar_tracking.graph.bench.measured_run import (
    ORCHESTRATION,
    GraphNotMeasuredError,
    measured_run,
)
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS


@pytest.mark.slow
def test_a_run_is_measured_from_its_command_on(tmp_path: Path) -> None:
    arguments = ["run", "doa_fusion", "--duration", "6", "--rate", "2"]
    run = measured_run(arguments, BEARING_TRACKS, tmp_path)
    nodes = {"world_simulator", "array_simulator", "subspace_estimator", "bearing_tracker"}
    assert set(run.cpu_seconds) == {*nodes, ORCHESTRATION}
    assert 0.0 < run.spawned < run.data_flow < run.first_track
    for name, seconds in run.cpu_seconds.items():
        assert 0.0 < run.start_seconds[name] <= seconds + 0.02
        assert run.memory_mb[name] > 10.0


@pytest.mark.slow
def test_a_command_that_is_refused_is_no_measurement(tmp_path: Path) -> None:
    with pytest.raises(GraphNotMeasuredError, match="run nowhere gave no report"):
        measured_run(["run", "nowhere"], BEARING_TRACKS, tmp_path)
