"""Protects: the bench compares like with like, and its figures reach the JSON."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.evaluation.bench import bench, bench_contacts
from sonar_tracking.evaluation.bench.bench_contacts import (
    COMPARED_SYSTEMS,
    GATED_PEER,
    PEER,
    PEER_SCENES,
    measure_side_by_side,
)
from sonar_tracking.evaluation.bench.bench_peers import (
    eigenvectors_each_period,
    eigenvectors_each_snapshot,
    textbook_past,
)
from sonar_tracking.passive.subspaces.exponential_covariance import ExponentialCovariance
from sonar_tracking.passive.subspaces.past import Past
from sonar_tracking.records.arrays import ComplexArray

BETA = 0.97
SHORT_SCENE = replace(PEER_SCENES[0], n_pings=15)


@pytest.fixture(scope="module")
def data() -> ComplexArray:
    return bench.bench_snapshots(15, 5)[:400]


def projector(basis: ComplexArray) -> ComplexArray:
    return basis @ np.linalg.pinv(basis)


def test_the_peer_does_the_same_recursion_as_past(data: ComplexArray) -> None:
    ours = bench.run_method(Past(BETA), 200, data, 5)
    assert textbook_past(data, 5, BETA) == pytest.approx(ours, abs=1e-10)


def test_the_slow_peer_spans_the_same_subspace_as_the_covariance_path(data: ComplexArray) -> None:
    ours = bench.run_method(ExponentialCovariance(BETA), 20, data, 5)
    peer = eigenvectors_each_snapshot(data, 5, BETA)
    assert projector(peer) == pytest.approx(projector(ours), abs=1e-8)


def test_the_periodic_peer_uses_the_last_period_alone(data: ComplexArray) -> None:
    whole = eigenvectors_each_period(data, 5, 200)
    last = eigenvectors_each_period(data[200:], 5, 200)
    assert projector(whole) == pytest.approx(projector(last), abs=1e-8)


@pytest.mark.slow
def test_figures_of_every_method_and_size_are_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(bench, "SIZES", ((6, 2), (8, 3)))
    monkeypatch.setattr(bench, "CLUTTER", (10,))
    monkeypatch.setattr(bench, "PEER_SCENES", (replace(PEER_SCENES[0], n_pings=3),))
    study = bench.run_bench(tmp_path / "bench.json")
    content = json.loads((tmp_path / "bench.json").read_text())
    assert content["study"] == "bench"
    expected = {"M 6, N 2", "M 8, N 3", "clutter 10 a ping", PEER_SCENES[0].condition}
    assert {row["condition"] for row in content["rows"]} == expected
    assert all(value > 0 for row in content["rows"] for value in row["metrics"].values())
    assert study.row(bench.PEER, "M 6, N 2").metrics["speed_over_textbook"] == 1.0
    trackers = {row.system for row in study.rows if "milliseconds_per_period" in row.metrics}
    assert trackers == set(bench.TRACKERS)
    assert "snapshots/s" in capsys.readouterr().out


@pytest.mark.slow
def test_stone_soup_tracks_as_well_from_the_same_contacts() -> None:
    rows = {row.system: row.metrics for row in measure_side_by_side(SHORT_SCENE)}
    if PEER not in rows:
        pytest.skip("Stone Soup is not installed; ./scripts/test.sh installs it")
    assert rows[PEER]["ospa_m"] == pytest.approx(rows[GATED_PEER]["ospa_m"], abs=1e-6)
    assert rows["integrated"]["ospa_m"] < 1.1 * rows[PEER]["ospa_m"]
    assert rows[GATED_PEER]["speed_over_gated"] == 1.0


def test_without_stone_soup_the_other_rows_are_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_contacts, "stone_soup_installed", lambda: False)
    rows = {row.system: row.metrics for row in measure_side_by_side(SHORT_SCENE)}
    assert set(rows) == set(COMPARED_SYSTEMS)
    assert all(set(metrics) == {"milliseconds_per_scan", "ospa_m"} for metrics in rows.values())
