"""Protects which snapshots, bases and instants an estimate is made of.

Ten snapshots a second, numbered 90 to 99, of which the last stands at 9.9 s; every element has the
number of the snapshot as its amplitude, so that powers tell which ones were used.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.subspaces.basis_sampling import CapturedSubspace
from sonar_tracking.passive.subspaces.channel_monitor import new_monitor
from sonar_tracking.passive.subspaces.estimation_memory import (
    CompleteWindow,
    EstimationMemory,
    ready_to_count,
)
from sonar_tracking.passive.subspaces.sample_schedule import (
    SampleSchedule,
    Window,
    first_timing,
    period_in_nanoseconds,
)
from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.window_estimates import (
    estimates_of_windows,
    starting_columns,
)
from sonar_tracking.records.bearings import Sensor, SubspaceEstimates
from tests.passive.crossing_scene import block_of

SECOND = 1_000_000_000
TIMING = first_timing(9 * SECOND, 10, 0.1)
WINDOW = Window(19, 9_500_000_000, first=94, last=98, step=2, covariance_end=97)
CONFIGURATION = SubspaceConfiguration(
    method="past", forgetting_factor=0.75, source_count=1, covariance_snapshots=4, period=0.5
)
SCHEDULE = SampleSchedule(period_in_nanoseconds(0.5), 1, 1, 0)


def basis(index: int) -> CapturedSubspace:
    return CapturedSubspace(index, TIMING, np.full((3, 1), index, dtype=complex))


def memory(**changes: Any) -> EstimationMemory:
    header = block_of(np.empty((0, 3), complex), 0, element_positions=line_array(3, 0.5))
    history = np.arange(90.0, 100.0)[:, None] * np.ones(3, dtype=complex)
    values: dict[str, Any] = {
        "array": header,
        "header": header,
        "sensors": SensorHistory().append(
            9 * SECOND, Sensor("bow", velocity=(2.0, 0.0, 0.0), position=(0.0, 0.0, 0.0))
        ),
        "timing": TIMING,
        "monitor": new_monitor(3),
        "n_columns": 1,
        "next_sample": 20,
        "history": history,
        "used": np.ones(3, dtype=bool),
        "whitening": None,
        "captured": (basis(92), basis(94), basis(96)),
        "windows": (WINDOW,),
    }
    return EstimationMemory(**{**values, **changes})


def estimate(made: EstimationMemory, window: Window = WINDOW) -> SubspaceEstimates:
    complete = CompleteWindow(window, made, made)
    return estimates_of_windows(CONFIGURATION, SCHEDULE, [complete])[0]


def test_an_estimate_holds_the_bases_of_its_window_and_the_last_snapshots_up_to_its_end() -> None:
    found = estimate(memory())
    assert (found.stamp, found.next_stamp, found.method) == (WINDOW.stamp, 10 * SECOND, "past")
    assert found.basis[:, 0, 0].real.tolist() == [94.0, 96.0]
    assert found.time_offsets == pytest.approx([-0.1, 0.1])
    assert found.effective_snapshots == pytest.approx(7.0)
    assert found.covariance is not None and found.covariance_snapshots == 4
    mean = (94.0**2 + 95.0**2 + 96.0**2 + 97.0**2) / 4.0
    assert found.covariance == pytest.approx(np.full((3, 3), mean))
    assert found.covariance_time_offset == pytest.approx(0.05)  # 9.55 s
    assert found.sensor.position == pytest.approx((1.0, 0.0, 0.0))


def test_a_window_that_ends_after_the_data_holds_what_has_come() -> None:
    late = estimate(memory(), replace(WINDOW, covariance_end=103))
    assert late.covariance is not None
    mean = (96.0**2 + 97.0**2 + 98.0**2 + 99.0**2) / 4.0
    assert late.covariance[0, 0].real == pytest.approx(mean)
    assert late.covariance_time_offset == pytest.approx(0.25)
    early = estimate(memory(), replace(WINDOW, covariance_end=91))
    assert early.covariance_snapshots == 2
    assert early.covariance_time_offset == pytest.approx(-0.45)
    none = estimate(memory(), replace(WINDOW, covariance_end=80))
    assert none.covariance is None and np.isnan(none.covariance_time_offset)


def test_without_a_basis_there_is_no_covariance() -> None:
    found = estimate(memory(captured=(basis(92),)))
    assert (found.basis.shape, found.time_offsets.shape) == ((0, 3, 1), (0,))
    assert found.covariance is None and found.covariance_snapshots == 0


def test_elements_that_are_left_out_are_in_no_covariance() -> None:
    header = replace(memory().header, element_positions=line_array(3, 0.5)[[0, 2]])
    made = memory(used=np.array([True, False, True]), header=header)
    assert made.used_history.shape == (10, 2)
    found = estimate(made)
    assert found.covariance is not None and found.covariance.shape == (2, 2)
    assert len(found.element_positions) == 2


def test_a_closed_window_takes_its_bases_along() -> None:
    other = Window(20, 10 * SECOND, first=96, last=100, step=2, covariance_end=100)
    left = memory(windows=(WINDOW, other)).without_windows([WINDOW])
    assert left.windows == (other,)
    assert [one.index for one in left.captured] == [96]


@pytest.mark.parametrize(
    ("kept", "next_count", "ready"), [(4, 0, True), (3, 0, False), (4, 99, True), (4, 100, False)]
)
def test_sources_are_counted_on_a_full_covariance_that_is_due(
    kept: int, next_count: int, ready: bool
) -> None:
    made = memory(history=memory().history[-kept:], next_count=next_count)
    assert ready_to_count(CONFIGURATION, made) == ready


@pytest.mark.parametrize("straight", [True, False])
def test_a_start_counts_the_sources(straight: bool) -> None:
    positions = line_array(6, 0.5)
    positions[2, 1] = 0.0 if straight else 0.2
    generator = np.random.default_rng(1)
    noise = generator.standard_normal((2, 60, 6)) / np.sqrt(2.0)
    tone = np.exp(1j * generator.uniform(0.0, 6.3, (60, 1)))
    vector = steering_vectors(positions, np.array([0.3]), 2.0 * np.pi)[:, 0]
    data = tone * vector + noise[0] + 1j * noise[1]
    header = block_of(data[:0], 0, element_positions=positions)
    made = memory(
        header=header,
        history=data,
        timing=first_timing(9 * SECOND, 60, 0.005),
        used=np.ones(6, dtype=bool),
    )
    configuration = SubspaceConfiguration(covariance_snapshots=60)
    assert starting_columns(configuration, made) == 1
    silent = replace(made, history=noise[0] + 1j * noise[1])
    assert starting_columns(configuration, silent) == 0


def test_a_full_covariance_in_which_no_source_is_seen_is_given_to_those_who_count_themselves() -> (
    None
):
    quiet = memory(captured=(), sampler=None, n_columns=0)
    counting = replace(CONFIGURATION, method="covariance", source_count=0)
    for configuration, snapshots in ((counting, 4), (CONFIGURATION, 0)):
        complete = CompleteWindow(WINDOW, quiet, quiet)
        found = estimates_of_windows(configuration, SCHEDULE, [complete])[0]
        assert found.basis.shape[0] == 0 and found.covariance_snapshots == snapshots
    short = replace(quiet, history=quiet.history[:3])
    found = estimates_of_windows(counting, SCHEDULE, [CompleteWindow(WINDOW, short, short)])[0]
    assert found.covariance is None
