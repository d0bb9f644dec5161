"""Positions of several files, as a logger begins a new one each hour or day, on one time axis.

What two files hold both is taken from the earlier one, as of audio files. Gaps need no word here:
whoever uses a track tells those of one file and those between two alike.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.bags.positions.given_files import files_text
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import seconds

DISAGREEING = 100.0
"""Between the positions of one instant in two files, m: they are hardly of one ship."""

_NAMED = 3
"""Overlaps that are named; the others are counted."""


def joined_positions(
    tracks: Sequence[SurveyedPositions], notes: list[str], whose: str = "own ship"
) -> SurveyedPositions:
    """Return positions of several files as one track.

    Parameters
    ----------
    tracks : sequence of SurveyedPositions
        One a file, at least one, in any order.
    notes : list of str
        Told of what two files hold both.
    whose : str
        Of whom the positions are, for sentences.
    """
    ordered = sorted(tracks, key=lambda track: (int(track.stamp[0]), int(track.stamp[-1])))
    kept, overlaps = [ordered[0]], []
    apart, where = 0.0, ""
    for track in ordered[1:]:
        end = int(max(each.stamp[-1] for each in kept))
        both = int(np.searchsorted(track.stamp, end, side="right"))
        if both:
            length = seconds(min(end, int(track.stamp[-1])) - int(track.stamp[0]))
            overlaps.append(f"{length:.6g} s ({both} positions) of {track.source}")
            differ = _distance(kept, track, both)
            if differ > apart:
                apart, where = differ, track.source
        if both < len(track.stamp):
            kept.append(_rows(track, both))
    if overlaps:
        notes.append(_told(overlaps, whose))
    if apart > DISAGREEING:
        notes.append(
            f"{where} and the files before it put {whose} up to {apart:.4g} m apart at one "
            "instant; check that all are of one ship, and their times."
        )
    return (
        kept[0] if len(ordered) == 1 else _one(kept, files_text([each.source for each in ordered]))
    )


def _distance(kept: Sequence[SurveyedPositions], track: SurveyedPositions, both: int) -> float:
    """Return the largest distance of the first positions of a track from what is known, m."""
    stamp = np.concatenate([each.stamp for each in kept])
    position = np.concatenate([each.position for each in kept])
    known, wanted = seconds(stamp - stamp[0]), seconds(track.stamp[:both] - stamp[0])
    columns = [np.interp(wanted, known, column) for column in position.T]
    return float(np.max(np.hypot(*(np.stack(columns) - track.position[:both].T))))


def _rows(track: SurveyedPositions, first: int) -> SurveyedPositions:
    """Return a track from one row on."""
    velocity = None if track.velocity is None else track.velocity[first:]
    rows = track.stamp[first:], track.position[first:], track.azimuth[first:]
    return SurveyedPositions(*rows, track.source, velocity)


def _one(parts: Sequence[SurveyedPositions], source: str) -> SurveyedPositions:
    velocity = None
    if any(part.velocity is not None for part in parts):
        velocity = np.concatenate([_velocity(part) for part in parts])
    return SurveyedPositions(
        np.concatenate([part.stamp for part in parts]),
        np.concatenate([part.position for part in parts]),
        np.concatenate([part.azimuth for part in parts]),
        source,
        velocity,
    )


def _velocity(part: SurveyedPositions) -> FloatArray:
    return np.full_like(part.position, np.nan) if part.velocity is None else part.velocity


def _told(overlaps: Sequence[str], whose: str) -> str:
    more = f" and {len(overlaps) - _NAMED} more" if len(overlaps) > _NAMED else ""
    plural = "s" if len(overlaps) > 1 else ""
    return (
        f"{len(overlaps)} overlap{plural} between files of {whose}, where what the file before "
        f"holds is taken: {', '.join(overlaps[:_NAMED])}{more}."
    )
