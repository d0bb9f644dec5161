"""The sets without a common member whose values add up to most: branch and bound.

References
----------
Nemhauser, Wolsey, Integer and Combinatorial Optimization, Wiley 1988, chapters II.4 and III.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

MOST_NODES = 4000
"""Looked at; more are not worth their time to who decides anew a second later."""


@dataclass
class _Search:
    """What is known so far; members are bits.

    Of each member, the sets it is in: value, row, members, and what these can be worth.
    """

    options: list[list[tuple[float, int, int, float]]]
    share: list[float]
    best: float
    chosen: tuple[int, ...] = ()
    nodes: int = 0
    complete: bool = True
    path: list[int] = field(default_factory=list)


def best_packing(
    members: Sequence[frozenset[int]], values: Sequence[float], least: float = 0.0
) -> tuple[float, tuple[int, ...]] | None:
    """Return the disjoint sets of most value.

    Parameters
    ----------
    members : sequence of frozenset of int
        Of each set, from 0 on.
    values : sequence of float
        Of each set; sets of no positive value are never chosen.
    least : float
        Only more than this is looked for, which ends the search sooner.

    Returns
    -------
    float and tuple of int, or None
        The value and the rows of the sets chosen, ascending: ``least`` and none if nothing is
        better. None = there are so many possibilities that not all were looked at.
    """
    n_members = 1 + max((max(one) for one in members if one), default=-1)
    share = [0.0] * n_members
    possible = [row for row, value in enumerate(values) if value > 0.0 and members[row]]
    for row in possible:
        for member in members[row]:
            share[member] = max(share[member], values[row] / len(members[row]))
    # Members that can be worth most come first.
    order = sorted(range(n_members), key=lambda member: -share[member])
    options: list[list[tuple[float, int, int, float]]] = [[] for _ in range(n_members)]
    for row in sorted(possible, key=lambda row: -values[row]):
        own = [member for member in order if member in members[row]]
        mask = sum(1 << member for member in own)
        worth = sum(share[member] for member in own)
        for member in own:
            options[member].append((values[row], row, mask, worth))
    search = _Search([options[m] for m in order], [share[m] for m in order], least)
    bits = [1 << member for member in order]
    _branch(search, bits, 0, 0, 0.0, sum(share))
    if not search.complete:
        return None
    return search.best, tuple(sorted(search.chosen))


def _branch(
    search: _Search, bits: list[int], place: int, taken: int, value: float, bound: float
) -> None:
    """Go on from a member, in or out of each set; bound: what the members left can be worth."""
    search.nodes += 1
    if search.nodes > MOST_NODES:
        search.complete = False
        return
    if value > search.best:
        search.best, search.chosen = value, tuple(search.path)
    while place < len(bits) and taken & bits[place]:
        place += 1
    # Sums in another order differ in their last bits.
    if place == len(bits) or value + bound <= search.best * (1.0 + 1e-12):
        return
    for own, row, mask, worth in search.options[place]:
        if taken & mask:
            continue
        search.path.append(row)
        _branch(search, bits, place + 1, taken | mask, value + own, bound - worth)
        search.path.pop()
    _branch(search, bits, place + 1, taken | bits[place], value, bound - search.share[place])
