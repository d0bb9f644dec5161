"""Protects that every registered method is compared with the others in a study of its stage."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

from sonar_tracking.active.contacts.contact_method_registry import CONTACT_METHODS
from sonar_tracking.active.contacts.gate_threshold_registry import GATE_THRESHOLDS
from sonar_tracking.evaluation.bench.array_stages import TRACKERS
from sonar_tracking.evaluation.monte_carlo.compared_methods import compared_methods
from sonar_tracking.evaluation.studies.doa_coherent.runs import METHODS as COHERENT
from sonar_tracking.evaluation.studies.doa_fusion.systems import SYSTEMS as FUSION
from sonar_tracking.evaluation.studies.maritime_contacts.study import SYSTEMS as MARITIME
from sonar_tracking.evaluation.studies.multi_target_clutter.study import PANELS
from sonar_tracking.evaluation.studies.multi_target_clutter.systems import (
    PAPER_SYSTEMS,
    THRESHOLD_SYSTEMS,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import METHODS as TMA
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import SYSTEMS as ESTIMATORS
from sonar_tracking.method_registry import MethodEntry, MethodRegistry
from sonar_tracking.passive.bearings.bearing_method_registry import BEARING_METHODS
from sonar_tracking.tma.targets.tma_method_registry import TMA_METHODS


@pytest.mark.parametrize(
    ("registry", "compared"),
    [
        (BEARING_METHODS, {*COHERENT.values(), *(system.method for system in FUSION)}),
        (BEARING_METHODS, TRACKERS.values()),
        (TMA_METHODS, TMA.values()),
        (CONTACT_METHODS, {system.method for system in MARITIME.values()}),
        (CONTACT_METHODS, {system.method for system in PAPER_SYSTEMS.values()}),
        (GATE_THRESHOLDS, {s.gate_threshold for s in THRESHOLD_SYSTEMS.values()} | {"as_detected"}),
    ],
)
def test_a_study_compares_every_method(
    registry: MethodRegistry[Any], compared: Iterable[str]
) -> None:
    assert {*compared} == {*registry.names}


def test_every_system_is_in_a_panel_and_every_estimator_can_be_made() -> None:
    assert {name for panel in PANELS for name in panel} == {*PAPER_SYSTEMS}
    assert all(hasattr(make(), "update") for make in ESTIMATORS.values())


def test_methods_a_study_names_come_first_under_its_names_and_others_under_their_labels() -> None:
    entries = [MethodEntry(name, "a:b", "does it", label=name.upper()) for name in "abc"]
    compared = compared_methods(entries, {"PROPOSED": "b", "PROPOSED, slow": "b"})
    assert list(compared.items()) == [
        ("PROPOSED", "b"),
        ("PROPOSED, slow", "b"),
        ("A", "a"),
        ("C", "c"),
    ]
