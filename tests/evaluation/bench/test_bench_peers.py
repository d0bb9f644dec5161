"""Protects: the bench compares like with like, and names the peers that are not there."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.bench import array_kernels, bench, contact_stages
from sonar_tracking.evaluation.bench.array_kernels import run_method
from sonar_tracking.evaluation.bench.bench_data import (
    SOURCES,
    WAVENUMBER,
    bench_angles,
    bench_covariance,
    bench_positions,
    bench_snapshots,
)
from sonar_tracking.evaluation.bench.bench_peers import (
    eigenvectors_each_period,
    naive_music,
    textbook_past,
)
from sonar_tracking.evaluation.bench.contact_stages import (
    COMPARED_SYSTEMS,
    GATED_PEER,
    PEER,
    PEER_SCENES,
    measure_side_by_side,
)
from sonar_tracking.evaluation.bench.pyroomacoustics_peer import (
    PyroomMusic,
    pyroomacoustics_installed,
)
from sonar_tracking.evaluation.bench.stone_soup_tma_peer import EXTENDED, stone_soup_path
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.passive.directions.signal_subspace import signal_subspace
from sonar_tracking.passive.sources.angle_grid import angle_grid
from sonar_tracking.passive.sources.music import music_bearings
from sonar_tracking.passive.subspaces.past import Past
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.simulation.sensors.tma_scene import simulate_runs

BETA = 0.97
SHORT_SCENE = replace(PEER_SCENES[0], n_pings=15)
N_ELEMENTS = 15


@pytest.fixture(scope="module")
def data() -> ComplexArray:
    return bench_snapshots(N_ELEMENTS, SOURCES, 400)


@pytest.fixture(scope="module")
def grid_step() -> float:
    angles: FloatArray = angle_grid(bench_positions(N_ELEMENTS), WAVENUMBER).angles
    return float(np.diff(angles[np.abs(angles) < 1.0]).max())


def projector(basis: ComplexArray) -> ComplexArray:
    return basis @ np.linalg.pinv(basis)


def test_the_textbook_does_the_same_recursion_as_past(data: ComplexArray) -> None:
    ours = run_method(Past(BETA), 200, data, SOURCES)
    assert textbook_past(data, SOURCES, BETA) == pytest.approx(ours, abs=1e-10)


def test_eigenvectors_of_a_period_span_the_same_subspace(data: ComplexArray) -> None:
    peer = eigenvectors_each_period(data, SOURCES, 200)
    last = data[200:]
    ours = signal_subspace(last.T @ last.conj() / len(last), SOURCES).vectors
    assert projector(peer) == pytest.approx(projector(ours), abs=1e-8)


def test_naive_music_finds_the_same_bearings(grid_step: float) -> None:
    covariance, positions = bench_covariance(N_ELEMENTS, SOURCES), bench_positions(N_ELEMENTS)
    ours = music_bearings(covariance, SOURCES, positions, WAVENUMBER)
    peer = naive_music(covariance, SOURCES, positions, WAVENUMBER)
    assert peer == pytest.approx(ours, abs=grid_step)
    assert ours == pytest.approx(bench_angles(SOURCES), abs=0.02)


@pytest.mark.slow
@pytest.mark.skipif(not pyroomacoustics_installed(), reason="pyroomacoustics is not installed")
def test_pyroomacoustics_finds_the_same_bearings(grid_step: float) -> None:
    covariance, positions = bench_covariance(N_ELEMENTS, SOURCES), bench_positions(N_ELEMENTS)
    ours = music_bearings(covariance, SOURCES, positions, WAVENUMBER)
    grid = angle_grid(positions, WAVENUMBER).angles
    peer = PyroomMusic(positions, WAVENUMBER, SOURCES, grid)
    found = peer.bearings(bench_snapshots(N_ELEMENTS, SOURCES))
    assert found == pytest.approx(ours, abs=grid_step)


@pytest.mark.slow
def test_stone_soup_locates_the_target_of_s1() -> None:
    if not contact_stages.stone_soup_installed():
        pytest.skip("Stone Soup is not installed; ./scripts/test.sh installs it")
    runs = simulate_runs(scenario("S1"), [np.random.SeedSequence(1)])
    path = stone_soup_path(list(runs.frames()), EXTENDED, runs.scene.acceleration, 1.0)
    error = np.hypot(*(path[-1] - runs.truth[0, -1])[:2])
    assert path.shape == (400, 4)
    assert error < 500.0


@pytest.mark.slow
def test_stone_soup_tracks_as_well_from_the_same_contacts() -> None:
    rows = {row.system: row.metrics for row in measure_side_by_side(SHORT_SCENE)}
    if PEER not in rows:
        pytest.skip("Stone Soup is not installed; ./scripts/test.sh installs it")
    assert rows[PEER]["ospa_m"] == pytest.approx(rows[GATED_PEER]["ospa_m"], abs=1e-6)
    assert rows["integrated"]["ospa_m"] < 1.1 * rows[PEER]["ospa_m"]
    assert rows[GATED_PEER]["speed_over_gated"] == 1.0


@pytest.mark.slow
def test_without_stone_soup_the_other_rows_are_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_stages, "stone_soup_installed", lambda: False)
    rows = {row.system: row.metrics for row in measure_side_by_side(SHORT_SCENE)}
    assert set(rows) == set(COMPARED_SYSTEMS)
    assert all(set(metrics) == {"milliseconds_per_scan", "ospa_m"} for metrics in rows.values())


def test_peers_that_are_not_installed_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("stone_soup_installed", "pyroomacoustics_installed"):
        monkeypatch.setattr(bench, name, lambda: False)
    assert "pip install pyroomacoustics" in bench.KERNELS.missing()[0]
    assert "pip install stonesoup" in bench.STAGES.missing()[0]


def test_without_pyroomacoustics_music_has_its_other_peer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(array_kernels, "pyroomacoustics_installed", lambda: False)
    for kernel in array_kernels.array_kernels():
        if kernel.name.startswith("MUSIC"):
            assert set(kernel.prepare(N_ELEMENTS).peers) == {"naive numpy"}
