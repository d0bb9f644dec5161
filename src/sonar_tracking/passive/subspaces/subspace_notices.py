"""What the subspace stage tells a user of a block."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.passive.array_fit.array_fit import ArrayFit
from sonar_tracking.passive.array_fit.fit_notices import fit_notices
from sonar_tracking.passive.subspaces.estimation_memory import EstimationMemory
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import NANOSECONDS


def gap_notice(missing: int, block: ArraySnapshots) -> Notice:
    """Return that snapshots are missing before a block."""
    return Notice(
        Severity.WARN,
        "gap",
        f"{missing} snapshots are missing before the block at "
        f"{block.stamp / NANOSECONDS:.3f} s; tracking continues with the subspace from before.",
    )


def estimate_notices(
    estimates: list[SubspaceEstimates], fit: ArrayFit, memory: EstimationMemory
) -> list[Notice]:
    """Return what estimates, and the fit of the array after them, tell a user.

    Parameters
    ----------
    estimates : list of SubspaceEstimates
        Of one block.
    fit : ArrayFit
        After them.
    memory : EstimationMemory
        Of the run.
    """
    positions = memory.header.element_positions
    crowded = any(one.rank >= len(one.element_positions) - 1 for one in estimates)
    notices = [crowded_notice(len(positions))] if crowded else []
    return notices + fit_notices(fit, positions, np.flatnonzero(memory.used))


def crowded_notice(n_elements: int) -> Notice:
    """Return that there are more sources than the array can tell apart."""
    return Notice(
        Severity.WARN,
        "rank",
        f"The data show {n_elements - 1} sources or more, as many as {n_elements} elements can "
        "tell apart; those that are weak or close to others may have no track.",
    )


def singular_notice(n_columns: int) -> Notice:
    """Return that the subspace has lost directions and is started again."""
    return Notice(
        Severity.ERROR,
        "subspace",
        f"The data do not carry {n_columns} directions, the subspace became singular and is "
        "started again; lower source_count.",
    )
