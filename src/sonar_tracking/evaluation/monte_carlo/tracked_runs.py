"""Contacts of several runs tracked at once, with the results of each by itself."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.multi_target_tracker import MultiTargetTracker, update_together
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
    configuration: ContactTrackerConfiguration,
    runs: Sequence[Sequence[Contacts]],
    timed: bool,
) -> TrackedRuns:
    """Track the contacts of all runs, each by a tracker of its own.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        Of all trackers.
    runs : sequence of sequence of Contacts
        Pings of each run; equally many, at the same times.
    timed : bool
        Whether the first run is tracked once more, by itself, to measure the time.
    """
    seconds = _seconds_alone(configuration, runs[0]) if timed else np.nan
    trackers = [make_contact_tracker(configuration) for _ in runs]
    together = [tracker for tracker in trackers if isinstance(tracker, MultiTargetTracker)]
    if len(together) == len(runs):
        pings = zip(*runs, strict=True)
        updates = zip(*[update_together(together, contacts) for contacts in pings], strict=True)
        return TrackedRuns(tuple(updates), seconds)
    return TrackedRuns(
        tuple(
            tuple(tracker.update(contacts) for contacts in run)
            for tracker, run in zip(trackers, runs, strict=True)
        ),
        seconds,
    )


def _seconds_alone(configuration: ContactTrackerConfiguration, pings: Sequence[Contacts]) -> float:
    tracker = make_contact_tracker(configuration)
    started = time.process_time()
    for contacts in pings:
        tracker.update(contacts)
    return (time.process_time() - started) / len(pings)
