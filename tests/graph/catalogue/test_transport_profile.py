"""Large messages get a large shared memory segment where the machine has room for it."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

from sonar_tracking.graph.catalogue.transport_profile import (
    LARGEST_MESSAGE_BYTES,
    SEGMENT_BYTES,
    choose_transport,
)


def test_small_messages_need_nothing() -> None:
    choice = choose_transport(2400, 2)
    assert not choice.large_publishers and not choice.others and not choice.warning


def test_the_shipped_profile_holds_what_the_code_promises() -> None:
    choice = choose_transport(16 * 2**20, 0)
    path = choice.large_publishers["FASTRTPS_DEFAULT_PROFILES_FILE"]
    tree = ElementTree.parse(path)
    sizes = {
        element.tag.rpartition("}")[2]: int(element.text or 0)
        for element in tree.iter()
        if (element.text or "").strip().isdigit()
    }
    assert sizes == {"segment_size": SEGMENT_BYTES, "maxMessageSize": LARGEST_MESSAGE_BYTES}
    assert not choice.others


def test_without_shared_memory_it_falls_back_and_says_so(tmp_path: Path) -> None:
    choice = choose_transport(16 * 2**20, 1, shared_memory=tmp_path / "none")
    assert choice.large_publishers == {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"} == choice.others
    assert "UDP" in choice.warning and "--shm-size" in choice.warning


def test_a_message_beyond_the_profile_is_announced() -> None:
    assert "block_snapshots" in choose_transport(64 * 2**20, 0).warning
