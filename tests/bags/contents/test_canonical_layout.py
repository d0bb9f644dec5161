"""The canonical form found by walking over a message is the one found by decoding it."""

from __future__ import annotations

import random
from typing import Any

import pytest

from sonar_tracking.bags.contents.canonical_layout import CanonicalLayout
from sonar_tracking.bags.contents.digest import canonical_cdr
from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.errors import InputError
from sonar_tracking.graph.catalogue.node_catalogue import NODES

DATA_TYPES = sorted({topic.message_type for node in NODES.values() for topic in node.outputs})
OTHERS = ["diagnostic_msgs/msg/DiagnosticArray", "rosgraph_msgs/msg/Clock", "std_msgs/msg/UInt8"]


def any_value(store: Any, description: Any, rng: random.Random) -> Any:
    """Return a value of a field: columns of any length, texts of any, numbers of no pattern."""
    import numpy as np
    from rosbags.interfaces import Nodetype
    from rosbags.serde.utils import ndtype

    kind, detail = description
    if kind == Nodetype.NAME:
        return any_message(store, detail, rng)
    if kind == Nodetype.BASE:
        if detail[0] == "string":
            return "".join(rng.choices("abé", k=rng.randrange(9)))
        return float(rng.random()) if detail[0].startswith("float") else rng.randrange(100)
    length = detail[1] if kind == Nodetype.ARRAY else rng.randrange(5)
    element = detail[0]
    if element[0] == Nodetype.BASE and element[1][0] != "string":
        numbers = [rng.randrange(2) for _ in range(length)]
        return np.array(numbers, getattr(np, ndtype(element[1][0])))
    return [any_value(store, element, rng) for _ in range(length)]


def any_message(store: Any, type_name: str, rng: random.Random) -> Any:
    definition = store.get_msgdef(type_name)
    values = [any_value(store, description, rng) for _, description in definition.fields]
    return definition.cls(*values)


def outcome(canonical: Any, data: bytes) -> bytes | None:
    """Return the canonical form; None = refused."""
    try:
        return bytes(canonical(data))
    except InputError:
        return None


@pytest.mark.parametrize("type_name", [*DATA_TYPES, *OTHERS])
def test_it_is_that_of_decoding_and_encoding_whatever_the_bytes(type_name: str) -> None:
    store, rng = installed_typestore(type_name), random.Random(type_name)
    layout = CanonicalLayout(store, type_name)
    assert layout.is_known
    kept = 0
    for _ in range(60):
        data = bytearray(store.serialize_cdr(any_message(store, type_name, rng), type_name))
        for _ in range(rng.randrange(3)):
            data[rng.randrange(2, len(data))] = rng.choice((0, 1, 2, 0x55, 0xFF))
        data = data[: rng.choice((len(data), len(data), len(data) - 1))]
        data += rng.choice((b"", b"", b"\x55", b"\x55" * 3, b"\x55" * 4))
        expected = outcome(lambda raw: canonical_cdr(store, type_name, raw), bytes(data))
        assert outcome(layout.canonical, bytes(data)) == expected
        kept += expected is not None
        # Of the same build as the one before, with other bytes between its fields.
        for place in rng.sample(range(4, len(data)), min(3, len(data) - 4)):
            data[place] = rng.randrange(256)
        expected = outcome(lambda raw: canonical_cdr(store, type_name, raw), bytes(data))
        assert outcome(layout.canonical, bytes(data)) == expected
    assert kept > 5


def test_types_whose_numbers_change_when_they_are_decoded_have_none() -> None:
    for type_name in ("std_msgs/msg/Bool", "std_msgs/msg/Float32"):
        assert not CanonicalLayout(installed_typestore(type_name), type_name).is_known
