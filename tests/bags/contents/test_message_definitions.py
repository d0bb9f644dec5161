"""Protects what a bag says of its messages: the same types with and without ROS installed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from sonar_tracking.bags.contents import message_definitions
from sonar_tracking.bags.contents.message_definitions import installed_definition
from sonar_tracking.resources import find_resource

OURS = [f"sonar_tracking_msgs/msg/{p.stem}" for p in find_resource("msg_defs/msg").glob("*.msg")]
STANDARD = [
    "diagnostic_msgs/msg/DiagnosticArray",
    "nav_msgs/msg/Odometry",
    "rosgraph_msgs/msg/Clock",
    "sensor_msgs/msg/Image",
    "tf2_msgs/msg/TFMessage",
    "visualization_msgs/msg/MarkerArray",
]


@pytest.fixture
def no_installation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    message_definitions.installed_typestore.cache_clear()
    yield
    message_definitions.installed_typestore.cache_clear()


@pytest.fixture(params=sorted(OURS) + STANDARD)
def installed(request: pytest.FixtureRequest) -> message_definitions.MessageDefinition:
    return installed_definition(request.param)


@pytest.mark.usefixtures("installed", "no_installation")
def test_types_are_the_same_without_ros(installed: message_definitions.MessageDefinition) -> None:
    without = installed_definition(installed.type_name)
    assert without.type_hash == installed.type_hash
    dependencies = [line for line in installed.text.splitlines() if line.startswith("MSG: ")]
    assert [line for line in without.text.splitlines() if line.startswith("MSG: ")] == dependencies


@pytest.mark.usefixtures("no_installation")
@pytest.mark.parametrize("name", ["sonar_tracking_msgs/msg/Thing", "nav_msgs/msg/Thing"])
def test_what_nobody_knows_is_named(name: str) -> None:
    with pytest.raises(message_definitions.ConfigurationError, match=f"{name} is not installed"):
        installed_definition(name)
