"""Digests that tell whether two runs published the same messages.

The raw bytes of a serialised message are not a function of its content: the middleware leaves
alignment padding uninitialised and may append tail bytes. The digest is therefore taken over the
canonical form: decoded and encoded again, padding zero.
"""

from __future__ import annotations

import hashlib
import struct
from typing import TYPE_CHECKING

from sonar_tracking.bags.contents.canonical_layout import CanonicalLayout
from sonar_tracking.bags.contents.message_definitions import (
    MessageDefinition,
    installed_typestore,
    typestore_of,
)
from sonar_tracking.errors import InputError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

STEP_BYTES = 8
"""So much of a digest tells two runs apart, message by message."""

_LITTLE_ENDIAN = b"\0\1"


class CanonicalDigest:
    """sha256 over the canonical CDR of the messages of one topic, in order of publication.

    Parameters
    ----------
    type_name : str
        Full name of the message type.
    definition : MessageDefinition, optional
        The definition the bag carries; default: that of the installed package.
    """

    def __init__(self, type_name: str, definition: MessageDefinition | None = None) -> None:
        self._type_name = type_name
        self._store = typestore_of(definition) if definition else installed_typestore(type_name)
        self._layout = CanonicalLayout(self._store, type_name)
        self._hash = hashlib.sha256()

    def add(self, raw_cdr: bytes) -> None:
        """Add one serialised message.

        Parameters
        ----------
        raw_cdr : bytes
            CDR with its encapsulation header.

        Raises
        ------
        InputError
            If the bytes are not a message of this type.
        """
        if self._layout.is_known and raw_cdr[:2] == _LITTLE_ENDIAN:
            self._hash.update(self._layout.canonical(raw_cdr))
        else:
            self._hash.update(canonical_cdr(self._store, self._type_name, raw_cdr))

    def step(self) -> bytes:
        """Return the first bytes of the digest of all messages added so far."""
        return self._hash.digest()[:STEP_BYTES]

    def hexdigest(self) -> str:
        """Return the digest of all messages added so far, as 64 hexadecimal digits."""
        return self._hash.hexdigest()


def canonical_cdr(store: Typestore, type_name: str, raw_cdr: bytes) -> memoryview:
    """Return a message as little-endian CDR with zero padding and without tail bytes.

    Parameters
    ----------
    store : Typestore
        Knows the type.
    type_name : str
        Full name of the message type.
    raw_cdr : bytes
        CDR with its encapsulation header.

    Raises
    ------
    InputError
        If the bytes are not a message of this type.
    """
    message = decoded_message(store, type_name, raw_cdr)
    return store.serialize_cdr(message, type_name, little_endian=True)


def decoded_message(store: Typestore, type_name: str, raw_cdr: bytes) -> object:
    """Return a serialised message as an object with its fields.

    Raises
    ------
    InputError
        If the bytes are not a message of this type.
    """
    from rosbags.serde import SerdeError

    try:
        return store.deserialize_cdr(raw_cdr, type_name)
    except (SerdeError, struct.error, ValueError, LookupError, AssertionError) as error:
        raise InputError(
            f"{len(raw_cdr)} bytes are not a message of type {type_name} ({error})."
        ) from error
