"""Messages of a recording in the layout that is installed now.

A bag carries the definition of every type it holds. Where ours has gained fields since, its
messages are read by that definition and written by the installed one, the new fields empty.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sonar_tracking.bags.contents.message_definitions import (
    MessageDefinition,
    installed_typestore,
    typestore_of,
)

OUR_PACKAGE = "sonar_tracking_msgs/"
"""Other packages keep their definitions."""


def earlier_layout(definition: MessageDefinition) -> Callable[[bytes], bytes] | None:
    """Return what brings messages of a recording into the installed layout; None = they are in it.

    Parameters
    ----------
    definition : MessageDefinition
        As the bag carries it.
    """
    name = definition.type_name
    if not name.startswith(OUR_PACKAGE) or not definition.text:
        return None
    recorded, installed = typestore_of(definition), installed_typestore(name)
    fields = installed.fielddefs[name][1]
    had = {field for field, _ in recorded.fielddefs[name][1]}
    # Fields are columns: (sequence, ((base, (type, _)), _)).
    added = {
        field: np.zeros(0, detail[0][1][0]) for field, (_, detail) in fields if field not in had
    }
    if not added:
        return None

    def translated(data: bytes) -> bytes:
        message: Any = recorded.deserialize_cdr(data, name)
        kept = {field: getattr(message, field) for field, _ in fields if field not in added}
        return bytes(installed.serialize_cdr(installed.types[name](**kept, **added), name))

    return translated
