"""Which of several runs are alike, so that their small matrices are dealt with in one go."""

from __future__ import annotations

from collections.abc import Hashable, Mapping


def alike(kinds: Mapping[int, Hashable]) -> list[list[int]]:
    """Return the numbers of the runs of each kind.

    Parameters
    ----------
    kinds : mapping of int to hashable
        What those that are dealt with together have in common, by the number of the run.
    """
    groups: dict[Hashable, list[int]] = {}
    for run, kind in kinds.items():
        groups.setdefault(kind, []).append(run)
    return list(groups.values())
