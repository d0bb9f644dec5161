"""Large messages get a large shared memory segment where the machine has room for it."""

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from sonar_tracking.graph.catalogue.transport_profile import (
    LARGEST_MESSAGE_BYTES,
    SEGMENT_BYTES,
    choose_transport,
)

PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"


@pytest.fixture(autouse=True)
def no_profile_of_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (PROFILES, "FASTDDS_DEFAULT_PROFILES_FILE"):
        monkeypatch.delenv(name, raising=False)
    for name in ("ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER", "ROS_LOCALHOST_ONLY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.delenv(RANGE, raising=False)


@pytest.fixture(params=["LOCALHOST", "SUBNET"])
def reach(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Let the graph be found by this machine alone, or by others too."""
    asked: str = request.param
    monkeypatch.setenv(RANGE, asked)
    return asked


def numbers(text: str) -> dict[str, int]:
    """Return the whole numbers of a part of a profile by element; of equal names the first."""
    found = re.findall(r"<(\w+)>(\d+)</\1>", text)
    return {name: int(number) for name, number in reversed(found)}


def test_small_messages_need_no_transport_of_their_own() -> None:
    choice = choose_transport(2400, 2)
    assert choice.large_publishers == choice.others
    assert not choice.warning


@pytest.mark.parametrize("name", [PROFILES, "FASTDDS_DEFAULT_PROFILES_FILE"])
def test_a_profile_of_the_user_is_left_alone(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(name, "mine.xml")
    assert choose_transport(2400, 2).others == {RANGE: "LOCALHOST"}


@pytest.mark.usefixtures("reach")
def test_every_process_tells_of_itself_often() -> None:
    """A graph is connected as soon as its last node is there, not up to three seconds later."""
    choice = choose_transport(16 * 2**20, 0)
    for profiles in (choice.large_publishers, choice.others):
        found = numbers(Path(profiles[PROFILES]).read_text())
        assert found["count"] == 100
        assert found["nanosec"] <= 500_000_000


@pytest.mark.usefixtures("reach")
def test_the_shipped_profile_holds_what_the_code_promises() -> None:
    choice = choose_transport(16 * 2**20, 0)
    text = Path(choice.large_publishers[PROFILES]).read_text()
    sizes = numbers(text[text.index("<type>SHM") :].partition("</transport_descriptor>")[0])
    assert sizes["segment_size"] == SEGMENT_BYTES
    assert sizes["maxMessageSize"] == LARGEST_MESSAGE_BYTES
    assert "segment_size" not in Path(choice.others[PROFILES]).read_text()


def test_a_graph_on_one_machine_listens_on_the_loopback_interface_only(tmp_path: Path) -> None:
    """LOCALHOST alone lets in whoever names this machine as a static peer of its own."""
    wanting = choose_transport(16 * 2**20, 1, shared_memory=tmp_path / "none")
    for choice in (choose_transport(2400, 2), choose_transport(16 * 2**20, 0), wanting):
        for variables in (choice.large_publishers, choice.others):
            assert variables[RANGE] == "LOCALHOST"
            profile = Path(variables[PROFILES]).read_text()
            assert "<useBuiltinTransports>false" in profile
            assert profile.count("<type>UDPv4") == profile.count("<interfaceWhiteList>") == 1
            assert "<address>127.0.0.1</address>" in profile


def test_without_shared_memory_nothing_is_sent_through_it(tmp_path: Path) -> None:
    choice = choose_transport(16 * 2**20, 1, shared_memory=tmp_path / "none")
    assert "SHM" not in Path(choice.others[PROFILES]).read_text()
    assert "UDP" in choice.warning and "--shm-size" in choice.warning


def test_without_shared_memory_other_machines_are_reached_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(RANGE, "SUBNET")
    choice = choose_transport(16 * 2**20, 1, shared_memory=tmp_path / "none")
    for variables in (choice.large_publishers, choice.others):
        assert "SHM" not in Path(variables[PROFILES]).read_text()
    assert "UDP" in choice.warning and "--shm-size" in choice.warning


def test_a_profile_of_the_user_goes_without_shared_memory_by_the_variable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(PROFILES, "mine.xml")
    choice = choose_transport(16 * 2**20, 1, shared_memory=tmp_path / "none")
    assert choice.others["FASTDDS_BUILTIN_TRANSPORTS"] == "UDPv4"


def test_between_machines_what_is_lost_is_sent_again_while_it_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A history of 10 messages at 10 a second lasts 1 s; a datagram fits into an Ethernet frame."""
    monkeypatch.setenv(RANGE, "SUBNET")
    wanting = choose_transport(16 * 2**20, 1, shared_memory=tmp_path / "none")
    for choice in (choose_transport(2400, 2), choose_transport(16 * 2**20, 0), wanting):
        for variables in (choice.large_publishers, choice.others):
            profile = ElementTree.parse(variables[PROFILES])
            name = "{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}"
            (period,) = profile.iter(f"{name}heartbeatPeriod")
            assert {each.tag: each.text for each in period} == {
                f"{name}sec": "0",
                f"{name}nanosec": "50000000",
            }
            sizes = [
                int(transport.findtext(f"{name}maxMessageSize") or 0)
                for transport in profile.iter(f"{name}transport_descriptor")
                if transport.findtext(f"{name}type") == "UDPv4"
            ]
            assert sizes == [1400]


@pytest.mark.parametrize(("reach", "part"), [("SUBNET", 1400), ("LOCALHOST", 65500)])
def test_queues_of_shared_memory_hold_all_parts_of_a_large_message(
    reach: str, part: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The smallest limit of all transports cuts messages; what overflows is sent again, later."""
    monkeypatch.setenv(RANGE, reach)
    choice = choose_transport(16 * 2**20, 0)
    for variables in (choice.large_publishers, choice.others):
        profile = ElementTree.parse(variables[PROFILES])
        name = "{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}"
        (capacity,) = profile.iter(f"{name}port_queue_capacity")
        assert int(capacity.text or 0) * part >= 8e6


def test_readers_acknowledge_seldom_where_nothing_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(RANGE, "LOCALHOST")
    quick, slow = choose_transport(2400, 2), choose_transport(16 * 2**20, 1, tmp_path / "none")
    assert "heartbeatResponseDelay" in Path(quick.others[PROFILES]).read_text()
    # By UDP messages may be lost on the way: they are asked for at once.
    assert "heartbeatResponseDelay" not in Path(slow.others[PROFILES]).read_text()
    monkeypatch.setenv(RANGE, "SUBNET")
    assert (
        "heartbeatResponseDelay" not in Path(choose_transport(2400, 2).others[PROFILES]).read_text()
    )


def test_a_message_beyond_the_profile_is_announced() -> None:
    assert "block_snapshots" in choose_transport(64 * 2**20, 0).warning
