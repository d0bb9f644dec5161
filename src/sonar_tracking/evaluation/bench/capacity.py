"""What a machine can track, from the figures of the stages.

A node has a core of its own as long as there are cores; half of it is for its mathematics, the
rest for messages and for what comes unevenly. With a, b and c the costs of a snapshot, an estimate
and a list of tracks, r snapshots and e estimates a second keep real time if

    r a + e b <= 1/2  (estimator),    e c <= 1/2  (tracker).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sonar_tracking.evaluation.bench.array_stages import DEFAULT, SNAPSHOT_RATE
from sonar_tracking.evaluation.bench.contact_stages import SYSTEMS
from sonar_tracking.evaluation.bench.tma_stages import CROSS_FIX
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout

SHARE = 0.5
"""Of a core that is for mathematics."""

ESTIMATES_PER_SECOND = 2.0
"""Of the default period."""

CAN_TRACK = "in real time, "

CAPACITY_LAYOUTS = (
    TableLayout(
        "What this machine can track: arrays",
        (
            Column("snapshots_per_second", "snapshots/s", ",.0f"),
            Column("estimates_per_second", "estimates/s", ",.1f"),
        ),
        f"Snapshots with {ESTIMATES_PER_SECOND:g} estimates a second; estimates with "
        f"{SNAPSHOT_RATE} snapshots a second. Half a core for each node's mathematics; 0 = it "
        "cannot.",
    ),
    TableLayout(
        "What this machine can track: contacts",
        (Column("pings_per_second", "pings/s", ",.1f"),),
    ),
    TableLayout(
        "What this machine can track: positions from the bearings of two stations",
        (Column("frames_per_second", "frames/s", ",.1f"),),
    ),
)


def capacity(rows: Sequence[StudyRow]) -> tuple[StudyRow, ...]:
    """Return what keeps real time.

    Parameters
    ----------
    rows : sequence of StudyRow
        Of the stages.
    """
    return (*_arrays(rows), *_contacts(rows), *_positions(rows))


def _arrays(rows: Sequence[StudyRow]) -> Iterator[StudyRow]:
    for row in rows:
        if not row.condition.startswith(DEFAULT) or "times_real_time" not in row.metrics:
            continue
        snapshot = 1e-6 * row.metrics["microseconds_per_snapshot"]
        estimate = 1e-3 * row.metrics["milliseconds_per_estimate"]
        update = 1e-3 * row.metrics["milliseconds_per_track_update"]
        snapshots = (SHARE - ESTIMATES_PER_SECOND * estimate) / snapshot
        if ESTIMATES_PER_SECOND * update > SHARE:
            snapshots = 0.0
        left = SHARE - SNAPSHOT_RATE * snapshot
        estimates = min(left / max(estimate, 1e-9), SHARE / update)
        figures = {
            "snapshots_per_second": max(snapshots, 0.0),
            "estimates_per_second": max(estimates, 0.0),
        }
        condition = row.condition.removeprefix(f"{DEFAULT}, ")
        yield StudyRow(row.system, f"{CAN_TRACK}{condition}", figures)


def _contacts(rows: Sequence[StudyRow]) -> Iterator[StudyRow]:
    for row in rows:
        if row.condition in SYSTEMS and "milliseconds_per_ping" in row.metrics:
            rate = SHARE / (1e-3 * row.metrics["milliseconds_per_ping"])
            yield StudyRow(row.system, f"{CAN_TRACK}{row.condition}", {"pings_per_second": rate})


def _positions(rows: Sequence[StudyRow]) -> Iterator[StudyRow]:
    for row in rows:
        if row.condition == CROSS_FIX:
            rate = SHARE / (1e-3 * row.metrics["milliseconds_per_frame"])
            yield StudyRow(row.system, f"{CAN_TRACK}{CROSS_FIX}", {"frames_per_second": rate})
