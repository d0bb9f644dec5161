"""The filters of the targets of several independent fusions, computed at once.

Each fusion does what it would do alone: the targets of all are stacked where the arithmetic is the
same for each of them.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.alignment.aligned_targets import predicted_together, slices_of, stacked
from sonar_tracking.alignment.shared_alignment import shared_alignments
from sonar_tracking.alignment.target_updates import expected_azimuths, updated_by_bearings
from sonar_tracking.fusion.bearing_links import BearingLinks
from sonar_tracking.fusion.bearing_update import BearingUpdate
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.lone_bearings import guarded, heard, joined_bearings
from sonar_tracking.fusion.meetings import meetings_of_bearings
from sonar_tracking.fusion.sided_bearings import expected_bearings, sided_bearings
from sonar_tracking.fusion.target_filters import TargetFilters


@dataclass(frozen=True)
class LinkedBearings:
    """Bearings that one station has of targets of one fusion.

    Attributes
    ----------
    filters : TargetFilters
        Of the fusion.
    links : BearingLinks
        Of the fusion: the bearing tracks have these targets.
    targets : list of FusedTarget
        Which, each once.
    found : list of HeardBearing
        One a target.
    """

    filters: TargetFilters
    links: BearingLinks
    targets: list[FusedTarget]
    found: list[HeardBearing]

    def kind(self) -> Hashable:
        """Return what bearings have in common that are computed at once."""
        first, filters = self.found[0], self.filters
        return (
            first.station.tobytes(),
            first.array,
            first.lag,
            any(len(one.azimuths) > 1 for one in self.found),
            filters.propagation_speed,
            filters.prior.tobytes(),
        )


def predict_together(every: Sequence[TargetFilters], intervals: Sequence[float]) -> None:
    """Let the filters of several fusions go on by an interval (s) each."""
    kinds = [
        (interval, len(one.arrays), id(one.strengths))
        for one, interval in zip(every, intervals, strict=True)
    ]
    for places in _alike(kinds):
        own, interval = [every[place] for place in places], intervals[places[0]]
        strengths = own[0].strengths
        aligned = predicted_together([one.aligned for one in own], interval, strengths)
        alone = predicted_together([one.echoes_alone for one in own], interval, strengths)
        for one, *after in zip(own, aligned, alone, strict=True):
            one.aligned, one.echoes_alone = after
            one.trials.predict(interval, strengths)
            one.exchanges.predict(interval, strengths)


def see_together(every: Sequence[TargetFilters]) -> None:
    """Find out what all targets of each of several fusions tell together."""
    stale = [one for one in every if not one.is_seen]
    for places in _alike([one.prior.tobytes() for one in stale]):
        own = [stale[place] for place in places]
        ended = [one.ended for one in own]
        pictures = shared_alignments([one.aligned for one in own], ended, own[0].prior)
        for one, seen in zip(own, pictures, strict=True):
            one.see(seen)


def take_linked_together(every: Sequence[LinkedBearings]) -> None:
    """Let targets of several fusions take in the bearings that are of them."""
    for places in _alike([one.kind() for one in every]):
        _take_alike([every[place] for place in places])


def _take_alike(every: Sequence[LinkedBearings]) -> None:
    found = [bearing for one in every for bearing in one.found]
    speed = every[0].filters.propagation_speed
    taking = stacked([one.filters.aligned.rows(one.filters.rows_of(one.targets)) for one in every])
    expected, spread = expected_bearings(found, taking, speed)
    bearings = sided_bearings(found, expected, speed)
    updated, density = updated_by_bearings(taking, bearings)
    likelihood = guarded(density)
    update = BearingUpdate(bearings, bearings.innovation(expected), spread, updated, likelihood)
    alone, apart = heard(joined_bearings(*(one.links.alone(one.found) for one in every)), bearings)
    gained = likelihood - guarded(apart)
    for one, rows in zip(every, slices_of([one.found for one in every]), strict=True):
        one.filters.take_updated(one.targets, one.found, update.rows(rows))
        one.links.weigh(one.found, alone.rows(rows), gained[rows])
    _consider_meetings(every)


def _consider_meetings(every: Sequence[LinkedBearings]) -> None:
    """Consider exchanges of bearing tracks, of the same kind, by targets that are near others."""
    see_together([one.filters for one in every])
    pictures, first = [one.filters.picture() for one in every], every[0].found[0]
    mean = np.concatenate([seen.mean for seen in pictures])
    covariance = np.concatenate([seen.covariance for seen in pictures])
    speed = every[0].filters.propagation_speed
    azimuth, variance = expected_azimuths(
        mean, covariance, first.station, first.array, speed, first.lag
    )
    for one, rows in zip(every, slices_of([one.filters.targets for one in every]), strict=True):
        expected = azimuth[rows], variance[rows]
        met = meetings_of_bearings(one.targets, one.found, expected, one.filters)
        one.filters.consider(met)


def _alike(kinds: Sequence[Hashable]) -> list[list[int]]:
    """Return the places of what is of the same kind, kind by kind."""
    places: dict[Hashable, list[int]] = {}
    for place, kind in enumerate(kinds):
        places.setdefault(kind, []).append(place)
    return list(places.values())
