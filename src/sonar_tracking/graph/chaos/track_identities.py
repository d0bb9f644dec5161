"""Whether tracks keep their identifiers over a fault, and when they come again. No ROS.

Before the fault the last :data:`LISTS` lists count: a track that at least :data:`SEEN` of them
confirm, one of the last two among these, is *established*. After it, the :data:`LISTS_AFTER` lists
from the first that confirms a track again count: an established track is *kept* if one of them
confirms its identifier and, where the truth is published, it has not gone to another target. Its
target is the nearest one, within the cutoff, in the last list before the fault that confirms it. It
has gone to another if, in the last list after the fault that confirms it, it is within the cutoff
of that one and beyond the cutoff of its own; an identifier that is given again elsewhere is such a
track. A track whose target has left the scene in the meantime does not count; one that was at no
target is judged by its identifier alone, as is one that has drifted off on its own: where positions
come from bearings alone, many are that far from the truth.

Tracks also lose their identifiers without any fault, where targets cross or echoes fail. Where an
undisturbed run of the same data loses the track of the same target between the same stamps, the
fault has not done it, and the track does not count. The fault ``nothing`` shows what is left.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

LISTS = 5
"""Lists before a fault that count."""

SEEN = 3
"""Of these, those that confirm an established track."""

LISTS_AFTER = 10
"""Lists after a fault that count."""

Place = tuple[float, ...]
"""East and north, m; or an angle alone, rad."""


@dataclass(frozen=True)
class TrackList:
    """One list of tracks, or of targets, as far as it is confirmed.

    Attributes
    ----------
    wall : float
        When it came, s of the monotonic clock.
    stamp : int
        Of its data, ns.
    places : mapping of int to sequence of Place
        Identifier to where the track is; both sides of an ambiguous bearing are places.
    """

    wall: float
    stamp: int
    places: Mapping[int, Sequence[Place]]


@dataclass(frozen=True)
class Identities:
    """How many tracks were established before a fault, and how many were kept."""

    established: int
    kept: int


def longest_delay(walls: Sequence[float], due: float, interval: float) -> float:
    """Return by how much the latest of some lists came later than due, s; 0 = none did.

    Parameters
    ----------
    walls : sequence of float
        When they came, s of the monotonic clock.
    due : float
        When the first of them was due, s; each other is an interval after the one before.
    interval : float
        Usual time between lists, s.
    """
    awaited = [due, *(wall + interval for wall in walls)]
    return max(0.0, *(wall - then for wall, then in zip(walls, awaited, strict=False)))


def identities(
    before: Sequence[TrackList],
    after: Sequence[TrackList],
    truth: Sequence[TrackList],
    cutoff: float,
    reference: Sequence[TrackList] = (),
) -> Identities:
    """Return how many established tracks there were, and how many were kept.

    Parameters
    ----------
    before, after : sequence of TrackList
        In the order they came.
    truth : sequence of TrackList
        Of the targets; empty = it is not published.
    cutoff : float
        Farthest a track is from its target, m or rad.
    reference : sequence of TrackList
        Of an undisturbed run; empty = not known.
    """
    following = after[:LISTS_AFTER]
    kept = _kept(before, following, truth, cutoff)
    if reference and not all(kept.values()):
        first, last = before[-1].stamp, following[-1].stamp
        undisturbed = _kept(
            [each for each in reference if each.stamp <= first],
            [each for each in reference if first < each.stamp <= last],
            truth,
            cutoff,
        )
        anyway = {target for (_, target), is_kept in undisturbed.items() if not is_kept}
        kept = {key: is_kept for key, is_kept in kept.items() if is_kept or key[1] not in anyway}
    return Identities(len(kept), sum(kept.values()))


def _kept(
    before: Sequence[TrackList],
    following: Sequence[TrackList],
    truth: Sequence[TrackList],
    cutoff: float,
) -> dict[tuple[int, int | None], bool]:
    """Return whether each established track was kept, by its identifier and its target."""
    kept = {}
    for name in _established(before[-LISTS:]):
        target = _target(name, before, truth, cutoff)
        last = _latest(name, following)
        if target is not None and not _is_there(target, last or following[-1:], truth):
            continue
        gone = target is not None and bool(last) and _has_gone(name, target, last[0], truth, cutoff)
        kept[name, target] = bool(last) and not gone
    return kept


def _established(lists: Sequence[TrackList]) -> list[int]:
    times = Counter(name for each in lists for name in each.places)
    recent = {name for each in lists[-2:] for name in each.places}
    return [name for name, count in times.items() if count >= SEEN and name in recent]


def _latest(name: int, lists: Sequence[TrackList]) -> list[TrackList]:
    """Return the last list that confirms a track, if one does."""
    return [each for each in lists if name in each.places][-1:]


def _target(
    name: int, before: Sequence[TrackList], truth: Sequence[TrackList], cutoff: float
) -> int | None:
    """Return the target a track is at before the fault, if it is at one."""
    (last,) = _latest(name, before)
    targets = _truth_at(last.stamp, truth)
    nearest = min(targets, key=lambda each: _distance(name, each, last, truth), default=None)
    if nearest is None or _distance(name, nearest, last, truth) > cutoff:
        return None
    return nearest


def _has_gone(
    name: int, target: int, last: TrackList, truth: Sequence[TrackList], cutoff: float
) -> bool:
    """Tell whether a track is at another target, and not at its own."""
    near = {
        each
        for each in _truth_at(last.stamp, truth)
        if _distance(name, each, last, truth) <= cutoff
    }
    return bool(near) and target not in near


def _is_there(target: int, lists: Iterable[TrackList], truth: Sequence[TrackList]) -> bool:
    return all(target in _truth_at(each.stamp, truth) for each in lists)


def _truth_at(stamp: int, truth: Sequence[TrackList]) -> Mapping[int, Sequence[Place]]:
    """Return where the targets are, by the true list that is nearest in time."""
    nearest = min(truth, key=lambda each: abs(each.stamp - stamp), default=None)
    return {} if nearest is None else nearest.places


def _distance(name: int, target: int, tracks: TrackList, truth: Sequence[TrackList]) -> float:
    """Return how far a track is from a target, m or rad."""
    true_places = _truth_at(tracks.stamp, truth).get(target, ())
    return min(
        (_apart(one, other) for one in tracks.places[name] for other in true_places),
        default=math.inf,
    )


def _apart(one: Place, other: Place) -> float:
    if len(one) == 1:
        return abs(math.remainder(one[0] - other[0], 2 * math.pi))
    return math.dist(one, other)
