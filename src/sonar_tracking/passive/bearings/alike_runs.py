"""Independent runs that are tracked in one go: which are alike, and their arrays put together.

Runs are alike where the same steps follow from everything but the numbers in their arrays: as many
tracks, the same array, the same rank. Their arrays are stacked in a new first dimension.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from sonar_tracking.passive.sources.noise_of_windows import common_or_stacked
from sonar_tracking.records.bearings import SubspaceEstimates


def grouped(kinds: Iterable[Hashable]) -> list[list[int]]:
    """Return the numbers of the runs of each kind, by the kinds of all runs."""
    groups: dict[Hashable, list[int]] = {}
    for row, kind in enumerate(kinds):
        groups.setdefault(kind, []).append(row)
    return list(groups.values())


def kind_of(entry: Any) -> Hashable:
    """Return everything of an entry but the numbers in its arrays."""
    if isinstance(entry, np.ndarray):
        return entry.shape
    kind: Any = type(entry)
    if (names := _field_names(kind)) is not None:
        return tuple([kind_of(getattr(entry, name)) for name in names])
    return entry


def stacked(entries: Sequence[Any]) -> Any:
    """Return an entry with the arrays of all that are alike, in a new first dimension."""
    first = entries[0]
    if isinstance(first, np.ndarray):
        return np.stack(entries)
    kind: Any = type(first)
    if (names := _field_names(kind)) is None:
        return first
    return kind(**{name: stacked([getattr(entry, name) for entry in entries]) for name in names})


def rows_of(entry: Any, n_rows: int) -> list[Any]:
    """Return the entries that were stacked.

    Parameters
    ----------
    entry : object
        As :func:`stacked` gives it.
    n_rows : int
        How many they are.
    """
    if isinstance(entry, np.ndarray):
        if entry.ndim > 1:
            return list(entry)
        # Arrays, and no numbers, where there is one a run: numbers tell runs apart.
        return [entry[row, ...] for row in range(n_rows)]
    kind: Any = type(entry)
    if (names := _field_names(kind)) is None:
        return [entry] * n_rows
    columns = [rows_of(getattr(entry, name), n_rows) for name in names]
    return [kind(*values) for values in zip(*columns, strict=True)]


@lru_cache(maxsize=64)
def _field_names(kind: type) -> tuple[str, ...] | None:
    """Return the names of the fields of a dataclass, None for any other type."""
    return tuple(each.name for each in fields(kind)) if is_dataclass(kind) else None


def kind_of_array(estimates: SubspaceEstimates) -> Hashable:
    """Return the array, the frequency and the snapshots that estimates rest on, but the noise."""
    return (
        estimates.element_positions.tobytes(),
        estimates.sample_period,
        estimates.center_frequency,
        estimates.sound_speed,
        estimates.covariance_snapshots,
        estimates.noise_covariance is None,
    )


def kind_of_estimates(estimates: SubspaceEstimates, of_covariance: bool) -> Hashable:
    """Return what estimates must have in common to be measured in together.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Of a single run.
    of_covariance : bool
        Whether bearings are measured in the covariance: where its rank is known the columns of the
        subspace, which is not measured in, need not be as many.
    """
    covariance, basis = estimates.covariance, estimates.basis
    not_measured_in = of_covariance and estimates.rank >= 0
    return (
        kind_of_array(estimates),
        basis.shape[:-1] if not_measured_in else basis.shape,
        estimates.time_offsets.tobytes(),
        estimates.effective_snapshots,
        estimates.rank,
        covariance is None or bool(covariance.any()),
        (estimates.eigenvalues.shape, estimates.eigenvectors is None),
        estimates.covariance_time_offset,
        bool(np.isfinite(estimates.noise_power).all()),
    )


def stacked_estimates(estimates: Sequence[SubspaceEstimates]) -> SubspaceEstimates:
    """Return estimates of one kind with the runs in a new first dimension.

    Parameters
    ----------
    estimates : sequence of SubspaceEstimates
        One a run; of bases that need not have as many columns those that all have are kept.
    """
    n_columns = min(each.basis.shape[-1] for each in estimates)
    return replace(
        estimates[0],
        basis=np.stack([each.basis[..., :n_columns] for each in estimates]),
        covariance=stacked([each.covariance for each in estimates]),
        eigenvalues=stacked([each.eigenvalues for each in estimates]),
        eigenvectors=stacked([each.eigenvectors for each in estimates]),
        noise_power=np.stack([each.noise_power for each in estimates]),
        noise_covariance=common_or_stacked([each.noise_covariance for each in estimates]),
    )
