"""Baseline: regions of interest start and end tracks, JPDA particle filters follow them.

A region of interest seen at two successive pings away from all tracks starts a track; a track with
no region for two pings ends. With a low probability of detection regions are missing more often
than targets, which is why the method counts too few. It counts instead of estimating: its tracks
have no existence probability.

References
----------
Ng, Li, Godsill, Vermaak (2005), as compared with in Kim, Song (2007).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.association.jpda import associate_jointly
from sonar_tracking.active.baselines.regions_of_interest import WINDOW, PolarContacts, find_regions
from sonar_tracking.active.contacts.contact_checks import PingOrigin, check_order, origin_of
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, position_covariance
from sonar_tracking.active.contacts.contact_tracker_configuration import (
    ContactTrackerConfiguration,
    check_configuration,
)
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.active.tracks.cloud_pairs import cloud_pairs, weigh_cloud
from sonar_tracking.active.tracks.contact_gating import (
    SensorGeometry,
    determinant,
    sensor_geometry,
)
from sonar_tracking.active.tracks.contact_track_list import (
    ContactTrackRows,
    shown_tracks,
    thresholds_without_gates,
)
from sonar_tracking.active.tracks.particle_cloud import (
    ParticleCloud,
    ParticleMotion,
    gaussian_cloud,
    no_clouds,
    predict_cloud,
    resample_cloud,
    stacked,
)
from sonar_tracking.active.tracks.scene_rows import joined_tables
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.errors import Notice, Severity
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate

BIRTH_COUNT = 2
DEATH_COUNT = 2

LARGEST_NUMBER_OF_CLOUDS = 500
"""Tracks, each with its particles: bounds memory and time whatever the clutter."""
REGIONS_AT_ONCE = 64
"""Whose neighbours are looked for together, so that memory stays bounded."""


@dataclass(frozen=True)
class _RegionTracks:
    """Confirmed tracks, in the order of their age; one row each."""

    id: IntArray
    misses: IntArray
    initiated: IntArray
    updated: IntArray
    clouds: ParticleCloud

    def __len__(self) -> int:
        return len(self.id)

    def select(self, rows: BoolArray) -> _RegionTracks:
        """Return some of the tracks, by a mask."""
        return _RegionTracks(
            self.id[rows],
            self.misses[rows],
            self.initiated[rows],
            self.updated[rows],
            self.clouds.select(rows),
        )


class RegionTracker:
    """Tracks of several targets by regions of interest and JPDA particle filters.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        With method ``roi_clustering``.

    Raises
    ------
    ConfigurationError
        If parameters do not fit together.
    """

    def __init__(self, configuration: ContactTrackerConfiguration) -> None:
        check_configuration(configuration)
        self.configuration = configuration
        self._motion = ParticleMotion.configured(configuration)
        self._generator = np.random.default_rng(configuration.seed)
        nobody = np.zeros(0, dtype=np.int64)
        clouds = no_clouds(configuration.n_particles)
        self._tracks = _RegionTracks(nobody, nobody, nobody, nobody, clouds)
        self._window: list[PolarContacts] = []
        self._most_tracks = min(configuration.maximum_tracks, LARGEST_NUMBER_OF_CLOUDS)
        self._pending = np.zeros((0, 2)), np.zeros(0, dtype=np.int64)
        self._next_id = configuration.first_id
        self._last: PingOrigin | None = None

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        self._next_id = max(self._next_id, first_id)

    @property
    def next_id(self) -> int:
        """Identifier the next track will get."""
        return self._next_id

    def warm_up(self) -> None:
        """Load nothing: what a ping needs is there from the start."""

    def update(self, contacts: Contacts, shared: SharedPings | None = None) -> ContactTrackerUpdate:
        """Return the tracks after one ping.

        Parameters
        ----------
        contacts : Contacts
            Of the ping; may be empty.
        shared : SharedPings, optional
            Of other trackers that are given the same ping.

        Raises
        ------
        InputError
            If the ping cannot be used; the state is then unchanged.
        """
        shared = shared or SharedPings()
        contacts, notices = shared.check(contacts, self._last)
        model, guessed = shared.model(contacts, self.configuration)
        placed = shared.place(contacts, self.configuration.sound_speed)
        sensor = sensor_geometry(contacts, self.configuration.sound_speed)
        self._predict(contacts.stamp)
        self._last = origin_of(contacts)
        self._follow(placed, sensor, model, contacts.stamp)
        polar = PolarContacts(placed.position, placed.distance, contacts.azimuth)
        self._window = [*self._window[-WINDOW:], polar]
        regions = find_regions(
            self._window,
            sensor.range_standard_deviation,
            sensor.azimuth_standard_deviation,
            self.configuration.roi_distance,
            model.detection_probability,
        )
        free = self._attribute(regions, sensor)
        ends = self._tracks.misses >= DEATH_COUNT
        ended = self._tracks.select(ends)
        if ends.any():
            self._tracks = self._tracks.select(~ends)
        self._start(free, sensor, contacts.stamp)
        return ContactTrackerUpdate(
            tracks=shown_tracks(self._rows(ended), contacts.stamp, contacts.next_stamp),
            target_count=float(len(self._tracks)),
            thresholds=thresholds_without_gates(contacts.stamp, contacts.next_stamp, model),
            notices=(*notices, *guessed, *self._notices()),
        )

    def coast(self, stamp: int, next_stamp: int) -> ContactTrackerUpdate:
        """Return the tracks predicted to a ping of which nothing else is known.

        Raises
        ------
        InputError
            If the stamp is not later than that of the ping before.
        """
        check_order(stamp, self._last)
        self._predict(stamp)
        self._last = self._last and self._last.moved_to(stamp)
        rows = self._rows()
        coasted = np.full(len(rows.id), int(TrackStatus.COASTED), dtype=np.int64)
        return ContactTrackerUpdate(
            tracks=shown_tracks(replace(rows, status=coasted), stamp, next_stamp),
            target_count=float(len(self._tracks)),
            thresholds=thresholds_without_gates(stamp, next_stamp),
        )

    def _notices(self) -> tuple[Notice, ...]:
        if len(self._tracks) < self._most_tracks:
            return ()
        text = (
            f"There are {len(self._tracks)} tracks, as many as clouds of particles are kept for; "
            "no others are started. Raise the detector's threshold, or use the method integrated."
        )
        return (Notice(Severity.WARN, "maximum_tracks", text),)

    def _predict(self, stamp: int) -> None:
        interval = 0.0 if self._last is None else self._last.interval(stamp)
        clouds = predict_cloud(self._tracks.clouds, self._motion, interval, self._generator)
        self._tracks = replace(self._tracks, clouds=clouds)

    def _follow(
        self,
        placed: PlacedContacts,
        sensor: SensorGeometry,
        model: DetectionModel,
        stamp: int,
    ) -> None:
        """Update all tracks with the joint association probabilities."""
        tracks = self._tracks
        row, contact = np.nonzero(_inside_gates(tracks.clouds, placed))
        pairs = cloud_pairs(tracks.clouds, row, placed.select(contact), sensor)
        clutter = model.clutter_density(placed.distance)
        ratios = np.zeros((len(tracks), len(placed.distance)))
        ratios[row, contact] = model.detection_probability * pairs.mean / clutter[contact]
        missed = 1.0 - model.detection_probability * PROBABILITY_IN_GATE
        probabilities = associate_jointly(ratios, missed)
        weighed = weigh_cloud(tracks.clouds, pairs, probabilities[row, contact])
        self._tracks = replace(
            tracks,
            clouds=resample_cloud(weighed, self._generator),
            updated=np.where(probabilities.sum(axis=1) > 0.5, stamp, tracks.updated),
        )

    def _attribute(self, regions: FloatArray, sensor: SensorGeometry) -> FloatArray:
        """Count misses of the tracks and return the regions that belong to none."""
        free = np.ones(len(regions), dtype=bool)
        if not len(self._tracks):
            return regions
        mean, covariance = self._tracks.clouds.moments()
        spread = 2.0 * _region_covariances(regions, sensor) + covariance[:, None, :2, :2]
        near = _squared_distances(regions - mean[:, None, :2], spread) < GATE_SIZE**2
        misses = self._tracks.misses + 1
        for row, wanted in enumerate(near):
            own = free & wanted
            if own.any():
                free &= ~own
                misses[row] = 0
        self._tracks = replace(self._tracks, misses=misses)
        return regions[free]

    def _start(self, regions: FloatArray, sensor: SensorGeometry, stamp: int) -> None:
        """Count free regions from ping to ping and start tracks of those that last."""
        deviation = sensor.range_standard_deviation
        single = np.zeros(len(regions), dtype=bool)
        for row, near in enumerate(_near_each(regions, regions, 3.0 * deviation)):
            single[row] = not single[near].any()
        before, counts = self._pending
        positions, numbers = [], []
        born: list[ParticleCloud] = []
        known = _near_each(before, regions[single], 3.0 * np.sqrt(2.0) * deviation)
        for region, near in zip(regions[single], known, strict=True):
            count = int(np.max(counts[near], initial=0)) + 1
            if count < BIRTH_COUNT:
                positions.append(region)
                numbers.append(count)
            elif len(self._tracks) + len(born) < self._most_tracks:
                born.append(self._new_cloud(region, sensor))
        if born:
            self._append(born, stamp)
        self._pending = (np.array(positions).reshape(-1, 2), np.array(numbers, dtype=np.int64))

    def _new_cloud(self, region: FloatArray, sensor: SensorGeometry) -> ParticleCloud:
        covariance = np.zeros((4, 4))
        covariance[:2, :2] = _region_covariances(region[None], sensor)[0]
        covariance[2:, 2:] = self.configuration.initial_speed_deviation**2 * np.eye(2)
        mean = np.concatenate([region, np.zeros(2)])
        return gaussian_cloud(mean, covariance, self.configuration.n_particles, self._generator)

    def _append(self, born: Sequence[ParticleCloud], stamp: int) -> None:
        """Start tracks with these clouds."""
        old, stamps = self._tracks, np.full(len(born), stamp, dtype=np.int64)
        self._tracks = _RegionTracks(
            id=np.append(old.id, self._next_id + np.arange(len(born))),
            misses=np.append(old.misses, np.zeros(len(born), dtype=np.int64)),
            initiated=np.append(old.initiated, stamps),
            updated=np.append(old.updated, stamps),
            clouds=joined_tables([old.clouds, *map(stacked, born)]),
        )
        self._next_id += len(born)

    def _rows(self, *ended: _RegionTracks) -> ContactTrackRows:
        """Return the tracks, and those that have ended."""
        listed = (self._tracks, *ended)
        moments = [tracks.clouds.moments() for tracks in listed]
        status = np.where(self._tracks.misses, int(TrackStatus.COASTED), int(TrackStatus.CONFIRMED))
        ids = np.concatenate([tracks.id for tracks in listed])
        n_ended = len(ids) - len(status)
        return ContactTrackRows(
            id=ids,
            status=np.append(status, np.full(n_ended, int(TrackStatus.TERMINATED))),
            existence=np.full(len(ids), np.nan),
            state=np.concatenate([mean for mean, _ in moments]),
            covariance=np.concatenate([spread for _, spread in moments]),
            initiated=np.concatenate([tracks.initiated for tracks in listed]),
            updated=np.concatenate([tracks.updated for tracks in listed]),
        )


def _near_each(positions: FloatArray, regions: FloatArray, distance: float) -> Iterator[IndexArray]:
    """Yield the rows of the positions, shape (n, 2), nearer than a distance to each region."""
    order = np.argsort(positions[:, 0])
    along = positions[order, 0]
    reach = 1.001 * distance  # whatever is rounded
    first = np.searchsorted(along, regions[:, 0] - reach)
    last = np.searchsorted(along, regions[:, 0] + reach, side="right")
    for begin in range(0, len(regions), REGIONS_AT_ONCE):
        some = slice(begin, begin + REGIONS_AT_ONCE)
        counts = last[some] - first[some]
        own = np.repeat(np.arange(len(counts)), counts)
        skipped = first[some] - (np.cumsum(counts) - counts)
        rows = order[np.arange(len(own)) + skipped[own]]
        along_x, along_y = (regions[some][own] - positions[rows]).T
        inside = (np.abs(along_x) < distance) & (np.hypot(along_x, along_y) < distance)
        yield from np.split(rows[inside], np.searchsorted(own[inside], np.arange(1, len(counts))))


def _region_covariances(regions: FloatArray, sensor: SensorGeometry) -> FloatArray:
    separation = regions - sensor.position
    distance = np.maximum(np.hypot(separation[:, 0], separation[:, 1]), 1e-3)
    return position_covariance(
        separation / distance[:, None],
        distance,
        sensor.range_standard_deviation,
        sensor.azimuth_standard_deviation,
    )


def _inside_gates(clouds: ParticleCloud, placed: PlacedContacts) -> BoolArray:
    """Return which contacts are in which gates, shape (n_clouds, n_contacts)."""
    mean, covariance = clouds.moments()
    place, velocity = mean[:, None, :2], mean[:, None, 2:]
    difference = placed.position - place - placed.delay[:, None] * velocity
    spread = placed.covariance + covariance[:, None, :2, :2]
    return np.asarray(_squared_distances(difference, spread) < GATE_SIZE**2)


def _squared_distances(difference: FloatArray, spread: FloatArray) -> FloatArray:
    """Return d^T S^-1 d of differences, shape (..., 2), and covariances, shape (..., 2, 2)."""
    x, y = difference[..., 0], difference[..., 1]
    square = spread[..., 1, 1] * x**2 - 2.0 * spread[..., 0, 1] * x * y + spread[..., 0, 0] * y**2
    return np.asarray(square / determinant(spread))
