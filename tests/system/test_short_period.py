"""Many estimates a block: none may be lost, however fast the graph runs."""

from pathlib import Path

from tests.system.command_line import refused, report_of, run_command

SCENARIO = """
duration: 1.0
array: {n_elements: 8, snapshot_rate: 200.0, block_snapshots: 20}
targets: [{level_db: 0.0, motion: {kind: linear, offset_deg: 10.0, rate_deg: 0.5}}]
nodes:
  subspace_estimator: {method: past, period: 0.005, n_subspaces: 1, source_count: SOURCES}
  bearing_tracker:
    {method: ml_fusion, start: given, initial_bearings_deg: [10.0], initial_rates_deg: [0.5]}
"""


def test_bursts_of_estimates_pass_without_loss(tmp_path: Path) -> None:
    scenario, json, bag = tmp_path / "short.yaml", tmp_path / "report.json", tmp_path / "bag"
    scenario.write_text(SCENARIO.replace("SOURCES", "1"))
    arguments = ("--rate", "max", "--json", json)
    done = run_command(tmp_path, "run", scenario, "--record", bag, *arguments)
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    estimates = report["topics"]["/array/subspaces"]["messages"]
    assert estimates > 190
    assert report["topics"]["/passive/bearing_tracks"]["messages"] == estimates
    assert report["nodes"]["bearing_tracker"]["messages_in"] == estimates
    again = run_command(tmp_path, "replay", bag, *arguments)
    assert again.returncode == 0, again.stdout
    assert report_of(json)["comparison"]["/passive/bearing_tracks"].startswith("identical")


def test_more_sources_than_elements_are_refused_before_the_run(tmp_path: Path) -> None:
    scenario = tmp_path / "many.yaml"
    scenario.write_text(SCENARIO.replace("SOURCES", "8"))
    said = refused(tmp_path, "run", scenario)
    assert "source_count is 8, but the array has only 8 elements" in said
