"""Message definitions of the installed interface packages, read from their ``.msg`` files.

Bags carry the definition of every type they hold, so that any tool can decode them. The texts and
type hashes are those of the interface packages that are installed (``share/<package>/msg``); no
ROS library is needed to read them. Where ROS is not installed, our own definitions are those this
package brings, and the standard ones those that rosbags knows (without comments).
"""

from __future__ import annotations

import functools
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.resources import find_resource

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc, Typesdict
    from rosbags.typesys.store import Typestore

SEPARATOR = "=" * 80

KEPT_DEFINITIONS = 64
"""Of bags, whose parsed types are kept: bags that are opened one after the other have the same."""


@dataclass(frozen=True)
class MessageDefinition:
    """What a bag says of a message type.

    Attributes
    ----------
    type_name : str
        Full name, e.g. ``"sonar_tracking_msgs/msg/BearingTracks"``.
    text : str
        The definition, followed by those of all types it depends on (``ros2msg`` concatenation).
    type_hash : str
        REP-2011 hash, ``"RIHS01_..."``; empty = unknown.
    encoding : str
        ``"ros2msg"`` or ``"ros2idl"``; empty = no definition known.
    """

    type_name: str
    text: str
    type_hash: str
    encoding: str = "ros2msg"


def installed_definition(type_name: str) -> MessageDefinition:
    """Return the definition of an installed message type.

    Parameters
    ----------
    type_name : str
        Full name, e.g. ``"nav_msgs/msg/Odometry"``.

    Raises
    ------
    ConfigurationError
        If the package or the type is not installed.
    """
    texts = _texts_with_dependencies(type_name)
    parts = [texts.pop(type_name)]
    for name, text in texts.items():
        package, _, short = name.split("/")
        parts.append(f"{SEPARATOR}\nMSG: {package}/{short}\n{text}")
    return MessageDefinition(
        type_name=type_name,
        text="\n".join(parts),
        type_hash=installed_typestore(type_name).hash_rihs01(type_name),
    )


@functools.cache
def installed_typestore(type_name: str) -> Typestore:
    """Return a rosbags typestore that knows an installed type and all it depends on.

    Raises
    ------
    ConfigurationError
        If the package or the type is not installed.
    """
    from rosbags.typesys import Stores, get_typestore

    types: Typesdict = {}
    for name, text in _texts_with_dependencies(type_name).items():
        types.update(_parsed(text, name))
    store = get_typestore(Stores.EMPTY)
    store.register(types)
    return store


@functools.lru_cache(maxsize=KEPT_DEFINITIONS)
def typestore_of(definition: MessageDefinition) -> Typestore:
    """Return a rosbags typestore made from the definition a bag carries.

    Raises
    ------
    ConfigurationError
        If the definition is missing or cannot be parsed.
    """
    from rosbags.typesys import (
        Stores,
        TypesysError,
        get_types_from_idl,
        get_types_from_msg,
        get_typestore,
    )

    if not definition.text:
        return installed_typestore(definition.type_name)
    try:
        if definition.encoding == "ros2idl":
            types = get_types_from_idl(definition.text)
        else:
            types = get_types_from_msg(definition.text, definition.type_name)
        store = get_typestore(Stores.EMPTY)
        store.register(types)
    except TypesysError as error:
        raise ConfigurationError(
            f"The definition of {definition.type_name} in the bag cannot be read ({error}); "
            "record the bag again with its message package installed."
        ) from error
    return store


def _texts_with_dependencies(type_name: str) -> dict[str, str]:
    """Return the ``.msg`` texts of a type and, depth first, of all types it depends on."""
    texts: dict[str, str] = {}
    waiting = [type_name]
    while waiting:
        name = waiting.pop()
        if name in texts:
            continue
        texts[name] = _message_text(name)
        fields = _parsed(texts[name], name)[name][1]
        waiting.extend(reversed([used for _, kind in fields for used in _used_types(kind)]))
    return texts


def _used_types(description: FieldDesc) -> list[str]:
    from rosbags.interfaces import Nodetype

    kind, detail = description
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        kind, detail = cast("FieldDesc", detail[0])
    return [str(detail)] if kind == Nodetype.NAME else []


@functools.cache
def _parsed(text: str, type_name: str) -> Typesdict:
    """Return the fields of a type; many types depend on the same few, and parsing is slow."""
    from rosbags.typesys import get_types_from_msg

    return get_types_from_msg(text, type_name)


def _message_text(type_name: str) -> str:
    parts = type_name.split("/")
    if len(parts) != 3 or parts[1] != "msg":
        raise ConfigurationError(
            f"{type_name!r} is not a message type; write it as package/msg/Name."
        )
    package, _, short = parts
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    for prefix in [*prefixes, sys.prefix]:
        path = Path(prefix) / "share" / package / "msg" / f"{short}.msg"
        if path.is_file():
            return path.read_text(encoding="utf-8")
    text = _known_text(package, short)
    if text is None:
        raise ConfigurationError(
            f"The message type {type_name} is not installed; install the package {package} "
            "(or source its setup file) and try again."
        )
    return text


def _known_text(package: str, short: str) -> str | None:
    """Return the definition of a message that is ours or of ROS 2 Jazzy, or nothing."""
    from rosbags.typesys import Stores, get_typestore

    if package == "sonar_tracking_msgs":
        definitions = find_resource("msg_defs/msg")
        ours = definitions / f"{short}.msg"
        return ours.read_text(encoding="utf-8") if ours.is_file() else None
    standard = get_typestore(Stores.ROS2_JAZZY)
    name = f"{package}/msg/{short}"
    if name not in standard.types:
        return None
    return standard.generate_msgdef(name, ros_version=2)[0].partition(SEPARATOR)[0]
