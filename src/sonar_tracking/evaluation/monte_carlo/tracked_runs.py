"""Contacts of several runs tracked at once, with the results of each by itself."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.multi_target_tracker import trackers_together
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate


@dataclass(frozen=True)
class TrackedRuns:
    """What one tracker did in several runs.

    Attributes
    ----------
    updates : tuple of tuple of ContactTrackerUpdate
        Of each run, one a ping.
    seconds : float
        Processor time a ping of a tracker by itself, s; NaN = not measured.
    """

    updates: tuple[tuple[ContactTrackerUpdate, ...], ...]
    seconds: float


def track_runs(
    configurations: Sequence[ContactTrackerConfiguration],
    runs: Sequence[Sequence[Contacts]],
    timed: bool,
) -> list[TrackedRuns]:
    """Track the contacts of all runs, each by trackers of its own.

    Parameters
    ----------
    configurations : sequence of ContactTrackerConfiguration
        Of each kind of tracker.
    runs : sequence of sequence of Contacts
        Pings of each run; equally many, at the same times.
    timed : bool
        Whether the first run is tracked once more, by itself, to measure the time.

    Returns
    -------
    list of TrackedRuns
        One a kind of tracker.
    """
    seconds = [_seconds_alone(each, runs[0]) if timed else np.nan for each in configurations]
    kinds = [[make_contact_tracker(each) for _ in runs] for each in configurations]
    of_pings: list[list[list[ContactTrackerUpdate]]] = [[] for _ in kinds]
    shared = SharedPings()
    for contacts in zip(*runs, strict=True):
        for trackers, found in zip(kinds, of_pings, strict=True):
            found.append(trackers_together(trackers, contacts, shared))
    return [
        TrackedRuns(tuple(tuple(ping[run] for ping in found) for run in range(len(runs))), each)
        for found, each in zip(of_pings, seconds, strict=True)
    ]


def _seconds_alone(configuration: ContactTrackerConfiguration, pings: Sequence[Contacts]) -> float:
    tracker = make_contact_tracker(configuration)
    started = time.process_time()
    for contacts in pings:
        tracker.update(contacts)
    return (time.process_time() - started) / len(pings)
