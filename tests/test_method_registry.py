"""Protects that a registered method is known everywhere from its one line in the registry."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_method_registry import CONTACT_METHODS
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.contacts.gate_threshold_registry import GATE_THRESHOLDS
from sonar_tracking.configuration import describe, from_mapping
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.monte_carlo.compared_methods import compared_methods
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.lazy_imports import load_object
from sonar_tracking.method_registry import MethodEntry, MethodRegistry
from sonar_tracking.passive.bearings.bearing_method_registry import BEARING_METHODS
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.subspaces.past import Past
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_method_registry import (
    SUBSPACE_METHODS,
    SubspaceMethodEntry,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.tma.targets.tma_method_registry import TMA_METHODS
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

STAGES: tuple[tuple[MethodRegistry[Any], type, str], ...] = (
    (SUBSPACE_METHODS, SubspaceConfiguration, "method"),
    (BEARING_METHODS, BearingTrackerConfiguration, "method"),
    (TMA_METHODS, TmaTrackerConfiguration, "method"),
    (CONTACT_METHODS, ContactTrackerConfiguration, "method"),
    (GATE_THRESHOLDS, ContactTrackerConfiguration, "gate_threshold"),
)
TOY = SubspaceMethodEntry(
    "toy",
    f"{__name__}:Toy.configured",
    "the first elements, whatever they receive",
    label="Toy",
    paper="nobody 1900",
    snapshot_by_snapshot=True,
)


class Toy(Past):
    """PAST that learns nothing."""

    def update(self, state: Any, data: Any) -> Any:
        return state


@pytest.fixture
def toy(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Register a method, for the time of a test."""
    monkeypatch.setattr(SUBSPACE_METHODS, "_entries", dict(SUBSPACE_METHODS._entries))
    monkeypatch.setattr("sonar_tracking.method_registry.load_object", _loaded)
    SUBSPACE_METHODS.add(TOY)
    yield


def _loaded(reference: str) -> Any:
    # This file is no module that can be imported by its name.
    assert reference == TOY.factory
    return Toy.configured


def method_parameter() -> Any:
    return next(entry for entry in describe(SubspaceConfiguration) if entry.name == "method")


@pytest.mark.usefixtures("toy")
def test_a_registered_method_is_a_choice_with_a_text_and_a_row() -> None:
    assert method_parameter().choices[-1] == "toy"
    assert method_parameter().description.endswith(f"toy: {TOY.description}")
    assert SUBSPACE_METHODS.table()[-1] == (
        "toy",
        "the first elements, whatever they receive",
        "a step each snapshot",
        "nobody 1900",
    )
    in_catalogue = {entry.name: entry for entry in NODES["subspace_estimator"].parameters}
    assert "toy" in in_catalogue["method"].choices
    assert compared_methods(SUBSPACE_METHODS, {"PROPOSED": "covariance"})["Toy"] == "toy"


@pytest.mark.usefixtures("toy")
def test_a_registered_method_runs_in_the_stage() -> None:
    values = {"method": "toy", "source_count": 1, "period": 0.01}
    configuration = from_mapping(SubspaceConfiguration, values, "nodes.subspace_estimator")
    assert configuration.step == 1
    block = ArraySnapshots(
        stamp=0,
        data=np.random.default_rng(1).normal(size=(40, 3)).astype(complex),
        element_positions=np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]),
        sample_period=0.001,
        center_frequency=100.0,
        bandwidth=0.0,
        sound_speed=1500.0,
    )
    estimates = SubspaceStage(configuration).update(block).estimates
    assert estimates[0].method == "toy"
    assert estimates[0].basis[0, :, 0].tolist() == [1.0, 0.0, 0.0]


def test_without_it_the_method_is_unknown() -> None:
    assert "toy" not in method_parameter().choices
    with pytest.raises(ConfigurationError, match="one of past, opast, block_past, covariance"):
        from_mapping(SubspaceConfiguration, {"method": "toy"}, "nodes.subspace_estimator")
    with pytest.raises(ConfigurationError, match=r"method pats is not known; did you mean past\?"):
        SubspaceStage(SubspaceConfiguration(method="pats", source_count=1))


@pytest.mark.parametrize(("registry", "configuration", "parameter"), STAGES)
def test_every_method_is_a_choice_and_can_be_made(
    registry: MethodRegistry[Any], configuration: type, parameter: str
) -> None:
    described = {entry.name: entry for entry in describe(configuration)}[parameter]
    assert described.methods is registry
    assert described.choices == registry.names
    assert described.default in registry.names
    assert registry.parameter.endswith(f".{parameter}")
    stage = configuration.__module__.split(".")[1]
    for entry in registry:
        assert entry.factory.startswith(f"sonar_tracking.{stage}.")
        assert entry.make(configuration(**{parameter: entry.name})) is not None
        assert entry.description and not entry.description.endswith(".")
        assert "\n" not in entry.description
    assert len({entry.label for entry in registry}) == len(registry.names)


@pytest.mark.parametrize(
    ("stage", "interface"),
    [
        (STAGES[0], "passive.subspaces.subspace_method:SubspaceMethod"),
        (STAGES[1], "passive.bearings.bearing_filters:BearingFilters"),
        (STAGES[2], "tma.estimators.estimator:Estimator"),
        (STAGES[3], "active.contact_tracker:ContactTracker"),
    ],
)
def test_what_is_made_has_the_interface_of_its_stage(
    stage: tuple[MethodRegistry[Any], type, str], interface: str
) -> None:
    registry, configuration, _ = stage
    protocol = load_object(f"sonar_tracking.{interface}")
    wanted = {name for name in vars(protocol) if not name.startswith("_")}
    assert wanted
    for entry in registry:
        made = entry.make(configuration(method=entry.name))
        assert wanted <= {*dir(made)}, entry.name


def test_two_methods_of_one_name_are_refused() -> None:
    entry = MethodEntry("one", "a:b", "does it", label="One")
    with pytest.raises(ConfigurationError, match=r"stage\.method has a method one already"):
        MethodRegistry("stage.method", entry, entry)


def test_traits_are_found_by_their_field_and_told_in_words() -> None:
    assert BEARING_METHODS.names_with("needs_covariance") == ("coherent", "joint_map")
    assert BEARING_METHODS["ryu"].traits == ()
    assert BEARING_METHODS["joint_map"].traits == (
        "measures in the covariance of the subspace estimator",
        "follows sources that no single covariance shows",
    )
