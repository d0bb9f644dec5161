"""Pictures of position tracks that are parts of one that has been checked."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from sonar_tracking.records.positions import COLUMNS, PositionTracks

_OF_TRACKS = tuple(name for name, column in COLUMNS.items() if column.key == "id")


def picture_parts(tracks: PositionTracks, counts: Sequence[int]) -> list[PositionTracks]:
    """Return pictures of the first tracks, of those after them, and so on.

    Their columns have the shape and type they are to have, and are not checked again.

    Parameters
    ----------
    tracks : PositionTracks
        Without lines and contributors.
    counts : sequence of int
        Tracks of each picture, all of them together.
    """
    whole = vars(tracks)
    parts = []
    for begin, end in itertools.pairwise((0, *itertools.accumulate(counts))):
        part = object.__new__(PositionTracks)
        own = vars(part)
        own.update(whole)
        for name in _OF_TRACKS:
            own[name] = whole[name][begin:end]
        parts.append(part)
    return parts
