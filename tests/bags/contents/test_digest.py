"""A digest must depend on the content of messages and on nothing else."""

from __future__ import annotations

import random

import pytest

from sonar_tracking.bags.contents.digest import CanonicalDigest
from sonar_tracking.bags.contents.message_definitions import (
    installed_definition,
    installed_typestore,
)
from sonar_tracking.errors import InputError
from tests.bags.bag_fixtures import SNAPSHOTS, TRACKS, filled, snapshots_cdr, tracks_cdr


def digest_of(*messages: bytes, type_name: str = SNAPSHOTS) -> str:
    digest = CanonicalDigest(type_name)
    for message in messages:
        digest.add(message)
    return digest.hexdigest()


def padding_positions(data: bytes, type_name: str) -> list[int]:
    """Return the bytes that can be changed without changing the decoded message."""
    store = installed_typestore(type_name)
    reference = repr(store.deserialize_cdr(data, type_name))
    positions = []
    for position in range(4, len(data)):
        changed = bytearray(data)
        changed[position] ^= 0x55
        try:
            if repr(store.deserialize_cdr(bytes(changed), type_name)) == reference:
                positions.append(position)
        except Exception:
            continue
    return positions


def test_garbage_in_the_padding_changes_nothing() -> None:
    message = filled(TRACKS, sensor_id="five")
    data = bytes(installed_typestore(TRACKS).serialize_cdr(message, TRACKS))
    positions = padding_positions(data, TRACKS)
    assert positions, "the message has no padding: the test protects nothing"
    generator = random.Random(1)
    garbage = bytearray(data)
    for position in positions:
        garbage[position] = generator.randrange(256)
    assert bytes(garbage) != data
    assert digest_of(bytes(garbage), type_name=TRACKS) == digest_of(data, type_name=TRACKS)


def test_tail_bytes_change_nothing() -> None:
    data = tracks_cdr(0)
    assert digest_of(data + b"\x17", type_name=TRACKS) == digest_of(data, type_name=TRACKS)


def test_byte_order_changes_nothing() -> None:
    store = installed_typestore(SNAPSHOTS)
    little = snapshots_cdr(3)
    message = store.deserialize_cdr(little, SNAPSHOTS)
    big = bytes(store.serialize_cdr(message, SNAPSHOTS, little_endian=False))
    assert big != little
    assert digest_of(big) == digest_of(little)


def test_content_order_and_number_of_messages_count() -> None:
    one, two = snapshots_cdr(1), snapshots_cdr(2)
    assert len({digest_of(), digest_of(one), digest_of(one, two), digest_of(two, one)}) == 4


def test_the_definition_of_the_bag_serves_as_well_as_the_installed_one() -> None:
    digest = CanonicalDigest(SNAPSHOTS, installed_definition(SNAPSHOTS))
    digest.add(snapshots_cdr(1))
    assert digest.hexdigest() == digest_of(snapshots_cdr(1))


def test_other_bytes_are_refused_with_a_sentence() -> None:
    for data in (b"", b"\x00\x01\x00\x00", snapshots_cdr(0)[:-40], tracks_cdr(0), b"\x77" * 300):
        with pytest.raises(InputError, match="are not a message of type"):
            digest_of(data)
