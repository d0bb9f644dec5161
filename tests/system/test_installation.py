"""What an installation has to offer to ROS 2 tools and to the package itself."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree.ElementTree import parse

import pytest
from ament_index_python import get_package_share_directory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.resources import find_resource

PROJECT = Path(__file__).resolve().parents[2]
DEFINITIONS = sorted((PROJECT / "msg_defs" / "msg").glob("*.msg"))


@pytest.fixture(autouse=True)
def ament_prefix_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the ament index be looked up in the environment, unless a prefix was sourced."""
    prefixes = [os.environ.get("AMENT_PREFIX_PATH", ""), sys.prefix]
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join(filter(None, prefixes)))


@pytest.mark.parametrize("definition", DEFINITIONS, ids=lambda path: path.stem)
def test_compiled_messages_are_those_of_the_tree(definition: Path) -> None:
    """Nodes use the compiled messages, bags are read by the text: both must be the same type."""
    typestore = get_typestore(Stores.ROS2_JAZZY)
    for path in DEFINITIONS:
        name = f"sonar_tracking_msgs/msg/{path.stem}"
        typestore.register(get_types_from_msg(path.read_text(), name))
    name = f"sonar_tracking_msgs/msg/{definition.stem}"
    share = Path(get_package_share_directory("sonar_tracking_msgs"))
    compiled = json.loads((share / "msg" / f"{definition.stem}.json").read_text())
    hashes = {entry["type_name"]: entry["hash_string"] for entry in compiled["type_hashes"]}
    assert typestore.hash_rihs01(name) == hashes[name]


def test_the_message_of_tf_is_the_official_one() -> None:
    """Whoever built it, other nodes take it for theirs only if the hash is that of ROS 2 Jazzy."""
    share = Path(get_package_share_directory("tf2_msgs"))
    compiled = json.loads((share / "msg" / "TFMessage.json").read_text())
    hashes = {entry["type_name"]: entry["hash_string"] for entry in compiled["type_hashes"]}
    official = get_typestore(Stores.ROS2_JAZZY)
    assert len(hashes) == 7
    for name, compiled_hash in hashes.items():
        assert compiled_hash == official.hash_rihs01(name), name


def test_colcon_builds_no_package_that_ros_has() -> None:
    packages = [path.parent for path in (PROJECT / "msg_defs").rglob("package.xml")]
    built = [path.name for path in packages if not (path / "COLCON_IGNORE").exists()]
    assert built == ["msg_defs"]


def test_every_definition_is_compiled() -> None:
    build = (PROJECT / "msg_defs" / "CMakeLists.txt").read_text()
    assert [path.name for path in DEFINITIONS if f'"msg/{path.name}"' not in build] == []


def test_ros_tools_find_package_files_and_programs() -> None:
    """The ament index, share/ and lib/ are where ros2 run and ros2 launch look."""
    share = Path(get_package_share_directory("sonar_tracking"))
    assert (share / "package.xml").is_file()
    # ros2 launch walks the folders without following a link to one.
    walked = [Path(folder) / name for folder, _, names in os.walk(share) for name in names]
    for launch_file in (PROJECT / "launch").glob("*.launch.py"):
        found = [path for path in walked if path.name == launch_file.name]
        assert [path.read_bytes() for path in found] == [launch_file.read_bytes()]
    assert (share / "config" / "scenarios" / "doa_fusion.yaml").is_file()
    programs = share.parents[1] / "lib" / "sonar_tracking"
    for name in (*NODES, "recorder", "sonar-tracking"):
        assert os.access(programs / name, os.X_OK), name


def test_every_message_package_that_is_imported_is_a_dependency() -> None:
    """What package.xml names is all that rosdep installs."""
    declared = {entry.text for entry in parse(PROJECT / "package.xml").findall("exec_depend")}
    sources = (path.read_text() for path in (PROJECT / "src").rglob("*.py"))
    pattern = re.compile(r"^ *(?:from|import) (\w+_(?:msgs|interfaces))\b", re.MULTILINE)
    imported = {name for source in sources for name in pattern.findall(source)}
    assert {"nav_msgs", "sensor_msgs", "sonar_tracking_msgs"} <= imported
    assert imported - declared == set()


def test_command_starts() -> None:
    command = [str(Path(sys.executable).with_name("sonar-tracking")), "--help"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert finished.returncode == 0, finished.stderr
    for verb in ("run", "replay", "evaluate"):
        assert verb in finished.stdout


def test_resource_is_found_in_the_source_tree() -> None:
    assert find_resource("config/scenarios") == PROJECT / "config" / "scenarios"


def test_resource_is_found_in_a_prefix(tmp_path: Path) -> None:
    """An installed package looks below share/ of the prefix it is in, and in no other."""
    package = tmp_path / "lib" / "python3.12" / "site-packages" / "sonar_tracking"
    scenarios = tmp_path / "share" / "sonar_tracking" / "config" / "scenarios"
    scenarios.mkdir(parents=True)
    assert find_resource("config/scenarios", package / "resources.py") == scenarios


def test_missing_resource_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"config/nothing\.yaml .*install the package"):
        find_resource("config/nothing.yaml", tmp_path / "src" / "sonar_tracking" / "resources.py")
