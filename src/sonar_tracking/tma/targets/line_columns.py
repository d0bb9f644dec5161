"""Which column of the state belongs to which line: lines come for ever, columns must not.

A line that is new takes a free column; when there is none, the column of the line that has been
silent longest. Columns that are freed are forgotten by the filter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.tma.estimators.error_models import with_lines
from sonar_tracking.tma.estimators.innovation_monitor import InnovationWindows
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC
from sonar_tracking.tma.targets.target_records import MAXIMUM_LINES


@dataclass(frozen=True)
class LineColumns:
    """Lines that have a column.

    Attributes
    ----------
    lines : tuple of (str, int)
        Sensor and identifier of the line of each column: identifiers are a sensor's own.
    heard : tuple of int
        Stamp at which each was last heard, ns.
    """

    lines: tuple[tuple[str, int], ...] = ()
    heard: tuple[int, ...] = ()


@dataclass(frozen=True)
class ColumnPlan:
    """Columns for the lines of a frame.

    Attributes
    ----------
    columns : LineColumns
        With the new lines.
    column_of : tuple of int
        Column of each line of the frame.
    freed : tuple of int
        Columns whose line was forgotten to make room.
    """

    columns: LineColumns
    column_of: tuple[int, ...]
    freed: tuple[int, ...]


def plan_columns(
    columns: LineColumns, lines: tuple[tuple[str, int], ...], stamp: int
) -> ColumnPlan:
    """Return where the lines of a frame go.

    Parameters
    ----------
    columns : LineColumns
        Before the frame.
    lines : tuple of (str, int)
        Lines of the frame, each once, at most ``MAXIMUM_LINES``.
    stamp : int
        Of the frame, ns.
    """
    known, heard = list(columns.lines), list(columns.heard)
    column_of, freed = [], []
    for line in lines:
        if line not in known:
            if len(known) < MAXIMUM_LINES:
                known.append(line)
                heard.append(stamp)
            else:
                silent = [n for n in range(len(known)) if known[n] not in lines]
                oldest = min(silent, key=lambda n: heard[n])
                known[oldest] = line
                freed.append(oldest)
        column = known.index(line)
        heard[column] = stamp
        column_of.append(column)
    return ColumnPlan(LineColumns(tuple(known), tuple(heard)), tuple(column_of), tuple(freed))


def with_columns(state: RangeBankState, count: int, freed: tuple[int, ...]) -> RangeBankState:
    """Return the filter's state with more columns and without the lines that were freed.

    Parameters
    ----------
    state : RangeBankState
        Of one run, without batch dimensions.
    count : int
        Columns there shall be, not fewer than there are.
    freed : tuple of int
        Columns to forget.
    """
    bank, windows = state.bank, state.windows
    added = count - bank.known.shape[-1]
    if not added and not freed:
        return state
    n_components, size = bank.mean.shape
    # The height, if there is one, stays behind the lines.
    place = np.arange(size)
    place[bank.height :] += added
    mean = np.zeros((n_components, size + added))
    mean[:, place] = bank.mean
    covariance = np.zeros((n_components, size + added, size + added))
    covariance[:, place[:, None], place] = bank.covariance
    known = np.zeros(count, dtype=bool)
    known[: count - added] = bank.known
    lines = np.zeros((count, windows.lines.shape[1]))
    lines[: count - added] = windows.lines
    for column in freed:
        mean[:, KINEMATIC + column] = 0.0
        covariance[:, KINEMATIC + column, :] = 0.0
        covariance[:, :, KINEMATIC + column] = 0.0
        known[column] = False
        lines[column] = 0.0
    beginning = state.beginning
    return replace(
        state,
        beginning=None if beginning is None else beginning.with_lines(count, freed),
        bank=replace(bank, mean=mean, covariance=covariance, known=known),
        windows=InnovationWindows(lines, windows.azimuth),
        errors=with_lines(state.errors, count, freed),
    )
