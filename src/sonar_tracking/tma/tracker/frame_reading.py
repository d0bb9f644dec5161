"""What a frame tells of the targets, before they take it in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby

from sonar_tracking.errors import Notice
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.tracker.target_list import TrackKey

Observed = Sequence[tuple[TrackKey, TargetObservation]]
"""What one station observed, by bearing track."""


@dataclass(frozen=True)
class SeenTarget:
    """A target and what a station observed of it.

    Attributes
    ----------
    key : TrackKey
        Its bearing track.
    target : FollowedTarget
        Which.
    told, corrected : TargetObservation
        As the station tells it, and by how the station is known to be turned.
    """

    key: TrackKey
    target: FollowedTarget
    told: TargetObservation
    corrected: TargetObservation


@dataclass(frozen=True)
class FrameReading:
    """What a frame tells.

    Attributes
    ----------
    observed : dict of TrackKey to TargetObservation
        By bearing track.
    born : set of TrackKey
        Those that get a target now.
    notices : list of Notice
        What could not be used.
    """

    observed: dict[TrackKey, TargetObservation] = field(default_factory=dict)
    born: set[TrackKey] = field(default_factory=set)
    notices: list[Notice] = field(default_factory=list)

    def stations(self) -> list[Observed]:
        """Return what one station after the other observed."""
        return [list(own) for _, own in groupby(self.observed.items(), key=lambda one: one[0][0])]
