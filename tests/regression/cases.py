"""Short runs of every stage and method, whose outputs are kept: see test_recorded_outputs.py."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from sonar_tracking.active import ContactTrackerConfiguration, make_contact_tracker
from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.offline.offline_bearing_chain import run_offline_chain
from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
from sonar_tracking.evaluation.offline.offline_sample_chain import run_offline_sample_chain
from sonar_tracking.evaluation.offline.offline_tma_chain import run_offline_tma_chain
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import SceneBatch, bound_of
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.passive import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
    SubspaceConfiguration,
    SubspaceStage,
    near_field_bound,
    near_field_information,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
    scenario_to_mapping,
)
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation
from sonar_tracking.simulation.sensors.tma_scene import simulate_runs
from sonar_tracking.tma import TMA_METHODS
from sonar_tracking.tma.batch.batch_likelihood import BatchConfiguration, estimate_batch_likelihood
from sonar_tracking.tma.batch.batch_smoother import estimate_batch_path
from sonar_tracking.tma.batch.direction_smoother import smooth_directions
from tests.passive.near_field.test_near_field_search import (
    ANGLES,
    ESTIMATORS,
    GRID,
    POSITIONS,
    RANGES,
    WAVENUMBER,
    sample,
)
from tests.tma.batch.test_direction_smoother import directions

Outputs = dict[str, FloatArray]

GIVEN_START = {
    "start": "given",
    "initial_bearings_deg": [-40.0, -20.0, -18.0, -45.0, 43.0],
    "initial_rates_deg": [0.0, 0.0, 0.0, 0.0, 0.0],
    "process_noise_deg2": 1.0,
}


def shortened(name: str, duration: float, nodes: Mapping[str, Mapping[str, Any]]) -> Scenario:
    """Return the beginning of a scenario, with some parameters of its nodes changed."""
    mapping = scenario_to_mapping(load_scenario(name))
    mapping["duration"] = duration
    for node, parameters in nodes.items():
        mapping["nodes"][node] = {**mapping["nodes"].get(node, {}), **parameters}
    return scenario_from_mapping(mapping, name)


def columns(entries: Iterable[Any], *names: str) -> Outputs:
    """Return fields of a series of records, each as one flat array; variances of covariances."""
    rows = list(entries)
    found: Outputs = {}
    for name in names:
        values = [np.asarray(getattr(row, name), np.float64) for row in rows]
        if name == "covariance":
            values = [np.diagonal(value, axis1=-2, axis2=-1) for value in values]
        found[name] = np.concatenate([np.empty(0), *map(np.ravel, values)])
    return found


def bearings(scene: Scenario) -> Outputs:
    """Return the bearing tracks of a scenario with an array, and how many notices there were."""
    run = run_offline_chain(scene)
    found = columns(
        run.tracks,
        *("id", "status", "arrival_angle", "arrival_angle_rate", "covariance", "innovation"),
        *("measurement_variance", "signal_to_noise_ratio", "existence_probability"),
    )
    return found | {"notices": np.array([float(len(run.notices))])}


def positions(scene: Scenario) -> Outputs:
    """Return the position tracks of a scenario with stations."""
    updates = run_offline_tma_chain(scene).updates
    return columns(
        [update.tracks for update in updates],
        *("id", "status", "state", "covariance", "existence_probability", "observability"),
        *("hypothesis", "hypothesis_probability", "line_frequency"),
    ) | {"notices": np.array([float(sum(len(update.notices) for update in updates))])}


def contacts(scene: Scenario) -> Outputs:
    """Return the position tracks and thresholds of a scenario with an active sonar."""
    updates = run_offline_active_chain(scene).updates
    tracks = columns(
        [update.tracks for update in updates],
        *("id", "status", "state", "covariance", "existence_probability"),
    )
    thresholds = columns(
        [update.thresholds for update in updates],
        *("threshold", "false_alarm_probability", "gate_volume", "resolution_cells"),
    )
    count = np.array([update.target_count for update in updates])
    return tracks | thresholds | {"target_count": count}


def lines(scene: Scenario) -> Outputs:
    """Return the lines, bearings and positions of a scenario with hydrophones."""
    run = run_offline_sample_chain(scene)
    heard = columns(
        run.lines,
        *("line_id", "frequency", "standard_deviation", "signal_to_noise_ratio"),
        *("arrival_angle", "arrival_angle_variance"),
    )
    tracked = columns(run.bearings, "arrival_angle", "covariance")
    return {f"line_{name}": values for name, values in heard.items()} | tracked


def passive_case(
    subspaces: str, tracker: str, duration: float = 20.0, **more: Any
) -> Callable[[], Outputs]:
    """Return the case of a pair of methods on five crossing targets."""
    start = {} if tracker == "joint_map" else GIVEN_START
    nodes = {
        "subspace_estimator": {"method": subspaces},
        "bearing_tracker": {"method": tracker, **start, **more},
    }
    return lambda: bearings(shortened("doa_fusion", duration, nodes))


def coloured_noise() -> Outputs:
    """Return the default chain in spatially correlated noise that it is told of."""
    scene = shortened("appearing_targets", 30.0, {})
    return bearings(replace(scene, noise=replace(scene.noise, correlation=0.4)))


def faulty_elements() -> Outputs:
    """Return the default chain with one element silent, one too loud, and lost blocks."""
    scene = shortened("doa_fusion", 20.0, {})
    estimator, tracker = (
        SubspaceStage(SubspaceConfiguration()),
        BearingTrackerStage(BearingTrackerConfiguration()),
    )
    tracks: list[BearingTracks] = []
    estimates: list[SubspaceEstimates] = []
    for number, block in enumerate(iter(ArraySimulation(scene).next_block, None)):
        data = block.snapshots.data.copy()
        data[:, 3] = 0.0
        data[:, 9] *= 30.0
        if number not in (60, 61, 130):
            made = estimator.update(replace(block.snapshots, data=data)).estimates
            estimates += made
            tracks += [tracker.update(one).tracks for one in made]
    spectrum = columns(estimates, "eigenvalues", "noise_power", "rank", "source_count")
    return spectrum | columns(tracks, "status", "arrival_angle", "covariance")


def bare_contacts() -> Outputs:
    """Return the default tracker on contacts that tell range, azimuth and their errors only."""
    tracker = make_contact_tracker(ContactTrackerConfiguration())
    updates = []
    for ping in ActiveSonarSimulation(shortened("active", 500.0, {})):
        bare = Contacts(
            *(ping.contacts.stamp, ping.contacts.range, ping.contacts.azimuth, np.empty(0)),
            *(ping.contacts.range_standard_deviation, ping.contacts.azimuth_standard_deviation),
            sensor_position=ping.contacts.sensor_position,
            sensor_velocity=ping.contacts.sensor_velocity,
        )
        updates.append(tracker.update(bare))
    tracks = [update.tracks for update in updates]
    return columns(tracks, "id", "status", "state", "covariance", "existence_probability")


def tma_case(method: str) -> Callable[[], Outputs]:
    """Return the case of an estimator of positions through the first turn of own ship."""
    return lambda: positions(shortened("tma", 240.0, {"tma_tracker": {"method": method}}))


def contact_case(method: str, duration: float = 500.0, **more: Any) -> Callable[[], Outputs]:
    """Return the case of a tracker of contacts."""
    nodes = {"hpda_tracker": {"method": method, **more}}
    return lambda: contacts(shortened("active", duration, nodes))


def batch_estimates() -> Outputs:
    """Return the batch estimators of positions, and the bound, on the scenes of Cheong (2011)."""
    found: Outputs = {}
    for name in ("S1", "S2"):
        scene = replace(scenario(name), acceleration=1e-3)
        runs = simulate_runs(scene, np.random.SeedSequence(3).spawn(2))
        frames = list(runs.frames())
        likelihood = estimate_batch_likelihood(frames)
        robust = estimate_batch_likelihood(frames, BatchConfiguration(huber=2.0))
        path = estimate_batch_path(frames, likelihood)
        found |= {f"{name}_likelihood_{key}": value for key, value in _fields(likelihood).items()}
        found |= {f"{name}_robust_{key}": value for key, value in _fields(robust).items()}
        found |= {f"{name}_path_{key}": value[..., -2:] for key, value in _fields(path).items()}
        seeds = tuple(np.random.SeedSequence(2).spawn(20))
        found[f"{name}_bound"] = bound_of(SceneBatch(name, RunBatch(0, seeds))).bound[::40]
    return found


def smoothed_directions() -> Outputs:
    """Return the smoother of directions with outliers, with and without elevations."""
    found: Outputs = {}
    for elevations in (True, False):
        history, ship = directions(5, elevations=elevations, wild=0.1)
        track = smooth_directions(history, ship + np.array([150.0, -100.0]))
        found |= {f"{elevations}_{key}": value[::20] for key, value in _fields(track).items()}
    return found


def near_field() -> Outputs:
    """Return bearing and range of two near sources by both estimators, and their bound."""
    covariance = sample(np.random.default_rng(4), np.eye(2), 200)
    fixes = [_fields(find(covariance, 2, GRID)) for find in ESTIMATORS]
    found = {f"{n}_{key}": value for n, fix in enumerate(fixes) for key, value in fix.items()}
    source = 10.0 * np.eye(2, dtype=np.complex128)
    information = near_field_information(POSITIONS, ANGLES, RANGES, WAVENUMBER, source, 1.0, 200)
    return found | {"bound": np.concatenate(near_field_bound(information))}


def _fields(record: Any) -> Outputs:
    """Return the numbers of a frozen dataclass by name."""
    values = {field.name: getattr(record, field.name) for field in fields(record)}
    return {
        name: np.asarray(value, np.float64)
        for name, value in values.items()
        if isinstance(value, np.ndarray | float)
    }


CASES: dict[str, Callable[[], Outputs]] = {
    "past-ryu": passive_case("past", "ryu"),
    "opast-ml_fusion": passive_case("opast", "ml_fusion"),
    "block_past-ml_fusion": passive_case("block_past", "ml_fusion", fused_variance="independent"),
    "covariance-coherent": passive_case("covariance", "coherent"),
    "covariance-joint_map": passive_case("covariance", "joint_map"),
    "appearing_targets": lambda: bearings(shortened("appearing_targets", 70.0, {})),
    "coloured_noise": coloured_noise,
    "crossing_targets": lambda: bearings(shortened("crossing_targets", 60.0, {})),
    "cross_fix": lambda: positions(shortened("cross_fix", 300.0, {})),
    "range_bank": lambda: positions(shortened("tma", 420.0, {})),
    "faulty_elements": faulty_elements,
    "bare_contacts": bare_contacts,
    "integrated": contact_case("integrated"),
    "hpda_kalman": contact_case("hpda_kalman"),
    "closed_form": contact_case("hpda_kalman", gate_threshold="closed_form"),
    "hpda_particle": contact_case("hpda_particle"),
    "roi_clustering": contact_case("roi_clustering", duration=300.0),
    "smc_phd": contact_case("smc_phd", duration=200.0),
    **{method: tma_case(method) for method in TMA_METHODS.names if method != "range_bank"},
    "batch_estimates": batch_estimates,
    "smoothed_directions": smoothed_directions,
    "near_field": near_field,
    "tonals": lambda: lines(shortened("tonals", 40.0, {})),
}
