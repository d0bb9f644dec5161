"""Protects: every scene of the mismatch-bearings study is what it says, and is scored by names.

How well the chain does is not asked here.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth
from sonar_tracking.evaluation.studies.mismatch_bearings import study
from sonar_tracking.evaluation.studies.mismatch_bearings.array_errors import ArrayErrors
from sonar_tracking.evaluation.studies.mismatch_bearings.bound import bound_deg2
from sonar_tracking.evaluation.studies.mismatch_bearings.condition import Condition
from sonar_tracking.evaluation.studies.mismatch_bearings.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_bearings.matched_periods import matched_run
from sonar_tracking.evaluation.studies.mismatch_bearings.names import (
    errors_under_names,
    share_of_right_names,
)
from sonar_tracking.evaluation.studies.mismatch_bearings.runs import (
    DEFAULTS,
    TOLD,
    WITHOUT,
    ChainRun,
    MismatchRun,
    figures,
    runs_under,
)
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import BearingTracks, TrackStatus


def seeds(count: int, root: int = 3) -> tuple[np.random.SeedSequence, ...]:
    return tuple(np.random.SeedSequence(root).spawn(count))


def short(name: str, duration: float) -> Condition:
    condition = CONDITIONS[name]
    return replace(condition, scenario=replace(condition.scenario, duration=duration))


def received(condition: Condition, count: int = 2) -> ComplexArray:
    return np.concatenate([block.data for block in condition.blocks(seeds(count))], axis=1)


def listed(
    condition: Condition, time: float, angles_deg: FloatArray, ids: tuple[int, ...]
) -> BearingTracks:
    unknown = np.full(len(ids), np.nan)
    return BearingTracks(
        stamp=condition.scenario.stamp(time),
        id=np.array(ids, dtype=np.uint64),
        status=np.full(len(ids), TrackStatus.CONFIRMED, dtype=np.uint8),
        arrival_angle=np.radians(angles_deg),
        arrival_angle_rate=np.zeros(len(ids)),
        covariance=np.broadcast_to(np.radians(1.0) ** 2 * np.eye(2), (len(ids), 2, 2)),
        measurement=unknown,
        measurement_variance=unknown,
        innovation=unknown,
        signal_to_noise_ratio=unknown,
        existence_probability=unknown,
        ambiguous=np.ones(len(ids), dtype=bool),
    )


def crossing() -> tuple[BearingTracks, ...]:
    """Two bearings that cross at 10 s: from -5 and 5 deg at 0.5 deg/s."""
    condition = CONDITIONS["white noise alone"]
    times = np.arange(0.0, 20.5, 0.5)
    return tuple(
        listed(condition, time, np.array([-5.0 + 0.5 * time, 5.0 - 0.5 * time]), (1, 2))
        for time in times
    )


@pytest.fixture(scope="module")
def results() -> list[tuple[MismatchRun, ...]]:
    some = ("pair 3 deg apart, 10 dB", "two channels exchanged, 8 elements, 20 dB")
    return [runs_under(short(name, 6.0), seeds(2)) for name in some]


@pytest.mark.slow
def test_both_chains_have_figures_under_a_condition(results: list[tuple[MismatchRun, ...]]) -> None:
    rows = study.rows(results)
    assert [row.system for row in rows] == [DEFAULTS, TOLD] * 2
    pair, faulty = rows[:2], rows[2:]
    for row in rows:
        assert np.isfinite(row.metrics["rmse_over_bound"])
        assert 0.0 <= row.metrics["count_right_percent"] <= 100.0
    assert pair[1].metrics["count_right_percent"] == 100.0
    assert "named_percent" not in pair[0].metrics and "named_percent" in faulty[0].metrics


@pytest.mark.slow
def test_same_seed_gives_the_same_run_whatever_runs_with_it() -> None:
    condition = short("pair 3 deg apart, 10 dB", 4.0)
    one, other = seeds(2)
    first = runs_under(condition, (one, other))
    again = runs_under(condition, (*seeds(1, 9), other, one))
    for before, after in zip(first, (again[2], again[1]), strict=True):
        for system in (DEFAULTS, TOLD):
            expected = before.metrics[system]["mse_deg2"]
            assert after.metrics[system]["mse_deg2"] == pytest.approx(expected, rel=1e-9)


def test_conditions_are_those_of_the_published_scenes_and_all_the_rest() -> None:
    names = " | ".join(CONDITIONS)
    for what in (
        "weaving",
        "pair 3 deg",
        "turn back",
        "pass",
        "noise correlation 0.6",
        "gains 5 %",
    ):
        assert what in names
    assert len([name for name in CONDITIONS if name.startswith("bursts: ")]) == 8
    assert len([name for name in CONDITIONS if "channel" in name]) == 6


def test_an_encounter_comes_as_near_as_it_says_and_parts_as_it_says() -> None:
    for name, end in (("stay 2 deg apart, turn back", -1.0), ("stay 2 deg apart, pass", 1.0)):
        motions = [target.motion for target in CONDITIONS[name].scenario.targets]
        receiver = CONDITIONS[name].scenario.receiver()
        angles = np.stack([one.arrival(np.arange(0.0, 80.0, 0.5), receiver)[0] for one in motions])
        apart = np.degrees(angles[1] - angles[0])
        assert np.abs(apart[60:61]) == pytest.approx(2.0)
        assert np.abs(apart[60:100]).max() == pytest.approx(2.0)
        assert np.sign(apart[-1]) == -end and np.sign(apart[0]) == 1.0


def test_noise_has_the_correlation_that_nobody_is_told() -> None:
    data = received(short("noise correlation 0.6 alone", 10.0))
    covariance = np.einsum("rtm,rtn->mn", data, data.conj()).real / (2 * data.shape[1])
    assert np.diagonal(covariance) == pytest.approx(1.0, abs=0.1)
    assert np.diagonal(covariance, 1) == pytest.approx(0.6, abs=0.1)
    assert np.diagonal(covariance, 4) == pytest.approx(0.6**4, abs=0.1)


def test_levels_are_those_of_each_target() -> None:
    data = received(short("pair 3 deg apart, 0 and 6 dB", 20.0))
    power = float(np.mean(np.abs(data) ** 2))
    assert power == pytest.approx(1.0 + 1.0 + 10.0**0.6, rel=0.05)


def test_array_errors_have_their_size_and_name_their_channels() -> None:
    generator = np.random.default_rng(1)
    factors = np.stack(
        [ArrayErrors(0.05, 5.0).draw(15, generator).factors for _ in range(200)]
    ).ravel()
    assert np.std(np.abs(factors)) == pytest.approx(0.05, rel=0.1)
    assert np.degrees(np.std(np.angle(factors))) == pytest.approx(5.0, rel=0.1)
    exchanged = ArrayErrors(exchanged=True).draw(8, generator)
    first, second = exchanged.faulty
    delivered = exchanged.received(np.arange(8.0).astype(np.complex128))
    assert delivered[first] == second and delivered[second] == first
    assert sorted(delivered.real) == list(range(8))
    inverted = ArrayErrors(inverted=True).draw(8, generator)
    (faulty,) = inverted.faulty
    assert np.flatnonzero(inverted.received(np.ones(8, dtype=np.complex128)) == -1.0).tolist() == [
        faulty
    ]


def test_errors_are_those_of_the_track_with_the_name_though_the_other_is_nearer() -> None:
    truth, condition = crossing(), CONDITIONS["white noise alone"]
    # Tracks that lag by 0.4 deg: for a moment around the crossing each is nearer to the other one.
    lagging = [
        listed(condition, 0.5 * n, np.degrees(one.arrival_angle) + np.array([-0.4, 0.4]), (7, 8))
        for n, one in enumerate(truth)
    ]
    errors = errors_under_names(matched_run(BearingTruth(truth), lagging))
    assert np.degrees(np.abs(errors.error[:, 0])) == pytest.approx(0.4)
    assert errors.nees() == pytest.approx(0.16, rel=1e-6)


def test_names_are_right_where_tracks_cross_and_wrong_where_they_turn_back() -> None:
    truth, condition = crossing(), CONDITIONS["white noise alone"]
    two = CONDITIONS["pair 3 deg apart, 0 dB"].scenario
    intervals = ((1.0, 4.0), (16.0, 19.0))
    back = [
        listed(condition, 0.5 * n, np.sort(np.degrees(one.arrival_angle)), (7, 8))
        for n, one in enumerate(truth)
    ]
    assert share_of_right_names(two, matched_run(BearingTruth(truth), truth), intervals) == 1.0
    assert share_of_right_names(two, matched_run(BearingTruth(truth), back), intervals) == 0.0


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("Channels 3 and 6 look exchanged; check their cables.", 100.0),
        ("Elements 3, 6 and 7 look exchanged; check their cables.", 0.0),
        ("Element 3 is clipped; lower its gain.", 0.0),
    ],
)
def test_a_notice_names_the_channels_if_it_names_all_of_them_and_no_others(
    text: str, named: float
) -> None:
    condition = CONDITIONS["two channels exchanged, 8 elements, 20 dB"]
    run = ChainRun(list(crossing()), [Notice(Severity.WARN, "array", text)])
    assert figures(condition, BearingTruth(crossing()), run, (6, 3))["named_percent"] == named


def test_long_conditions_are_begun_first_with_the_seeds_of_their_places() -> None:
    tasks = [task.argument for task in study.tasks(2, 7)]
    sizes = [CONDITIONS[task.condition].n_estimates for task in tasks]
    assert sizes == sorted(sizes, reverse=True)
    assert {task.condition for task in tasks} == set(CONDITIONS)
    places = {task.condition: task.seeds[0].entropy for task in tasks}
    assert places == {name: (7, part) for part, name in enumerate(CONDITIONS)}


def test_bound_falls_with_the_level_and_rises_where_bearings_are_near() -> None:
    faint, loud = (CONDITIONS[f"pair 3 deg apart, {level} dB"] for level in (0, 10))
    near = CONDITIONS["pair 2 deg apart, 0 dB"]
    assert bound_deg2(loud) < 0.5 * bound_deg2(faint) < 0.5 * bound_deg2(near)
    assert np.isnan(bound_deg2(CONDITIONS["white noise alone"]))


@pytest.mark.slow
def test_study_is_known_by_name_and_draws(
    results: list[tuple[MismatchRun, ...]], tmp_path: Path
) -> None:
    definition = STUDIES["mismatch-bearings"]
    assert len(definition.tasks(2, 1)) == len(CONDITIONS) and definition.default_runs == 50
    (picture,) = definition.draw(results, definition.rows(results), tmp_path)
    assert picture.stat().st_size > 10_000


@pytest.mark.slow
def test_a_faint_source_is_asked_for_the_start_of_its_track_with_and_without() -> None:
    (row, beside) = study.rows([runs_under(short("faint source, -14 dB", 20.0), seeds(2))])
    assert (row.system, beside.system) == (DEFAULTS, WITHOUT)
    assert row.metrics["within_20_s_percent"] == 100.0 and row.metrics["start_s"] <= 20.0
    assert beside.metrics["within_60_s_percent"] == 0.0 and "start_s" not in beside.metrics
    assert row.metrics["false_per_hour"] == beside.metrics["false_per_hour"] == 0.0
