"""Protects the parameter files of the studies of recorded data: they are those of the code."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import yaml

from sonar_tracking.evaluation.studies.room_array.study import node_parameters
from sonar_tracking.evaluation.studies.ship_bearings.tracks import CONFIGURATION, SMOOTHER
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_settings import read_settings, resolved_settings
from tests.docs.code_blocks import DOCS, blocks_of

FILES = {
    block.caption: block.text
    for page in ("room_array.md", "ship_bearings.md")
    for block in blocks_of(DOCS / "studies" / page)
    if block.language == "yaml"
}


def of(name: str) -> dict[str, dict[str, Any]]:
    parsed: dict[str, dict[str, Any]] = yaml.safe_load(FILES[name])
    return parsed


def test_the_room_has_the_parameters_of_its_study() -> None:
    assert of("room_array.yaml") == node_parameters(0)
    assert of("room_array_given_the_number.yaml") == node_parameters(2)


def test_the_ship_has_the_parameters_of_its_study() -> None:
    told = of("known_ship.yaml")["tma_tracker"]
    assert told.pop("systematic_deviation_deg") == SMOOTHER.systematic_deviation_deg
    changed = {
        field.name: getattr(CONFIGURATION, field.name)
        for field in fields(CONFIGURATION)
        if getattr(CONFIGURATION, field.name) != field.default
    }
    assert told == changed


@pytest.mark.parametrize("name", FILES)
def test_nodes_take_each_file(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text(FILES[name], encoding="utf-8")
    given = read_settings(path)
    settings = resolved_settings(given, tuple(NODES[node] for node in given), name)
    for node, values in given.items():
        assert {parameter: settings[node][parameter] for parameter in values} == values
