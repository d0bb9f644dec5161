"""Protects the study: one run of each kind, scored against what is known of it."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.evaluation.offline.alike_scenarios import first_alike
from sonar_tracking.evaluation.offline.offline_fusion_chain import fused_moments
from sonar_tracking.evaluation.studies.track_fusion import conditions
from sonar_tracking.evaluation.studies.track_fusion.central_filter import (
    CentralFilters,
    told_moment,
)
from sonar_tracking.evaluation.studies.track_fusion.conditions import CONDITIONS, same_sea
from sonar_tracking.evaluation.studies.track_fusion.list_rules import (
    covariance_intersection,
    naive_product,
)
from sonar_tracking.evaluation.studies.track_fusion.runs import (
    BOUND,
    CENTRAL,
    ECHOES_ALONE,
    FUSED,
    FusionTask,
    fusion_runs,
)
from sonar_tracking.evaluation.studies.track_fusion.study import metrics, rows, tasks
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration


def test_rules_by_hand() -> None:
    """Two scalars, 0 and 1, of variance 1: the product claims 1/2, the intersection 1."""
    first = KalmanState(np.zeros(1), np.ones((1, 1)))
    second = KalmanState(np.ones(1), np.ones((1, 1)))
    product, safe = naive_product(first, second), covariance_intersection(first, second)
    assert product.mean[0] == pytest.approx(0.5) and product.covariance[0, 0] == pytest.approx(0.5)
    assert safe.covariance[0, 0] == pytest.approx(1.0)


def test_every_condition_has_its_tasks() -> None:
    names = [name for task in tasks(3, seed=1) for name in task.argument.conditions]
    assert sorted(names) == sorted(CONDITIONS)


def test_conditions_of_the_same_ships_and_pings_are_computed_together() -> None:
    together = {names[0]: names for names in same_sea()}
    assert len(together["aligned"]) == 5
    assert together["clutter"] == ("clutter", "clutter, turned by 1 degree")
    seed = np.random.SeedSequence(2)
    for names in together.values():
        scenes = [CONDITIONS[name].scenario(seed) for name in names]
        assert first_alike(scenes) == [0] * len(names)
    scenes = [CONDITIONS[names[0]].scenario(seed) for names in together.values()]
    assert first_alike(scenes) == [0, 1, 2, 3]


@pytest.mark.slow
def test_runs_under_several_conditions_at_once_are_those_under_each_by_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(conditions, "DURATION", 130.0)
    seeds = tuple(np.random.SeedSequence(5).spawn(2))
    names = ("aligned", "array turned by 1 degree", "sonar lost for 5 minutes")
    alone = [run for name in names for run in fusion_runs(FusionTask((name,), seeds))]
    assert fusion_runs(FusionTask(names, seeds)) == tuple(alone)
    assert alone[0].squares[FUSED] and alone[0].squares != alone[2].squares


def test_filters_of_several_runs_at_once_are_those_of_each_by_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(conditions, "DURATION", 60.0)
    configuration, runs = TrackFusionConfiguration(), []
    for seed in np.random.SeedSequence(2).spawn(2):
        arrays: dict[str, int] = {}
        scenario = CONDITIONS["two stations"].scenario(seed)
        runs.append([told_moment(one, arrays, configuration) for one in fused_moments(scenario)])
        assert arrays == {"array": 0, "buoy": 1}
    for exact in (False, True):
        together = CentralFilters(configuration, 2, exact)
        alone = [CentralFilters(configuration, 1, exact) for _ in runs]
        for moments in zip(*runs, strict=True):
            together.update(moments)
            for own, moment in zip(alone, moments, strict=True):
                own.update([moment])
        for number, own in enumerate(alone):
            found = together.states(number)
            assert found.keys() == own.states(0).keys() and len(found) == 4
            for ship, (mean, covariance) in own.states(0).items():
                assert mean.tolist() == found[ship][0].tolist()
                assert covariance.tolist() == found[ship][1].tolist()


@pytest.mark.slow
def test_the_fused_picture_beats_echoes_and_comes_near_the_bound(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(conditions, "DURATION", 400.0)
    seeds = tuple(np.random.SeedSequence(4).spawn(2))
    runs = fusion_runs(FusionTask(("array turned by 1 degree",), seeds))
    assert all(not run.doubled and run.names == 0 for run in runs)
    fused, echoes, central = (metrics(name, runs) for name in (FUSED, ECHOES_ALONE, CENTRAL))
    assert fused["rmse_m"] < 0.75 * echoes["rmse_m"]
    assert fused["rmse_m"] < 1.4 * central["rmse_m"]
    assert central["rmse_m"] == pytest.approx(metrics(BOUND, runs)["rmse_m"], rel=0.25)
    assert 0.4 < fused["nees_per_dimension"] < 2.0
    assert abs(runs[0].alignment_error) < np.radians(0.6)
    assert {row.condition for row in rows([runs])} == {"array turned by 1 degree"}
