"""The table of what came of the faults, for people and as JSON. No ROS."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from rich.table import Table

from sonar_tracking.graph.chaos.fault_plan import FaultKind
from sonar_tracking.graph.chaos.outcome import Outcome

IN_TIME = 5.0
"""By then tracks are to come again, s of the wall clock after they were due."""

_COLUMNS = (
    *("fault", "times", "late, s", "in time", "tracks kept", "all kept"),
    *("lost", "hole, s", "failed"),
)
_CAPTION = f"""late: longest time without tracks since they were due: median, worst
in time: by {IN_TIME:g} s at most
all kept: faults over which no track lost its identifier
lost: messages of living nodes that the recording lacks
hole: the longest in the recording of a killed recorder"""


def outcome_table(outcomes: Sequence[Outcome]) -> Table:
    """Return a row for each kind of fault."""
    table = Table(title="what came of the faults", caption=_CAPTION, caption_justify="left")
    for heading in _COLUMNS:
        table.add_column(heading)
    groups: Mapping[FaultKind, list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        groups[outcome.fault.kind].append(outcome)
    for kind, group in groups.items():
        table.add_row(kind.value, str(len(group)), *_cells(group))
    return table


def _cells(group: Sequence[Outcome]) -> list[str]:
    """Return what is told of the faults of a kind, behind their number."""
    late = [each.late for each in group if each.late is not None]
    tracks = [each.tracks for each in group if each.tracks is not None and each.tracks.established]
    whole = sum(each.kept == each.established for each in tracks)
    lost = [each.lost_messages for each in group if each.lost_messages is not None]
    holes = [each.hole for each in group if each.hole is not None]
    kept, established = (sum(getattr(t, name) for t in tracks) for name in ("kept", "established"))
    return [
        f"{np.median(late):.1f}, {max(late):.1f}" if late else "",
        f"{sum(each <= IN_TIME for each in late)} of {len(late)}" if late else "",
        f"{kept} of {established}" if tracks else "",
        f"{whole} of {len(tracks)}" if tracks else "",
        str(sum(lost)) if lost else "",
        f"{max(holes):.1f}" if holes else "",
        str(sum(each.failed for each in group)),
    ]
