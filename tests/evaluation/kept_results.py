"""A study run as a user runs it, whose tasks can be computed once more in another way."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from sonar_tracking.evaluation.monte_carlo.batch_runner import Task, Workers, compute
from sonar_tracking.evaluation.monte_carlo.study import Study, StudyRow
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES, run_study

SEED = 1


@dataclass(frozen=True)
class KeptStudy:
    """A study of one seed, computed by two workers, its tasks and what they returned."""

    study: Study
    tasks: Sequence[Task]
    results: Sequence[Any]

    def assert_same_alone(self, numbers: Sequence[int]) -> None:
        """Check that one worker that computes nothing but these tasks returns the same bits."""
        again = compute([self.tasks[number] for number in numbers], Workers(1), lambda: None)
        assert again
        for one, number in zip(again, numbers, strict=True):
            assert pickle.dumps(one) == pickle.dumps(self.results[number])


def run_and_keep(
    name: str, runs: int, json: Path | None = None, plots: Path | None = None
) -> KeptStudy:
    """Run a study with two workers.

    Parameters
    ----------
    name : str
        Of the study.
    runs : int
        Monte Carlo runs per condition.
    json, plots : Path, optional
        As in :func:`run_study`.
    """
    definition = STUDIES[name]
    kept: list[Any] = []

    def rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
        kept.extend(results)
        return definition.rows(results)

    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(STUDIES, name, replace(definition, rows=rows))
        (study,) = run_study(name, runs, SEED, 2, json=json, plots=plots)
    return KeptStudy(study, definition.tasks(runs, SEED), kept)
