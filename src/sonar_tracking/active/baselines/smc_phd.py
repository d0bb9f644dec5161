"""SMC-PHD: the probability hypothesis density of all targets by sequential Monte Carlo.

A baseline. The weights of the cloud of particles integrate to the expected number of targets.
Targets have no identities in the published method: here its peaks are joined from ping to ping
(``peak_tracks``). Births are drawn around the contacts of the ping before: at the present ones the
contacts would be used twice and the count run away.

References
----------
B.-N. Vo, S. Singh, A. Doucet, "Sequential Monte Carlo methods for multitarget filtering with random
finite sets", IEEE Trans. AES 41(4), 2005, as compared with in Kim, Song (2007).
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.active.baselines.peak_tracks import follow_peaks, no_peak_tracks, predict_peaks
from sonar_tracking.active.baselines.state_extraction import extract_states
from sonar_tracking.active.contacts.contact_checks import PingOrigin, check_order, origin_of
from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.contacts.contact_tracker_configuration import (
    ContactTrackerConfiguration,
    check_configuration,
)
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.tracks.contact_gating import SensorGeometry, sensor_geometry
from sonar_tracking.active.tracks.contact_track_list import shown_tracks, thresholds_without_gates
from sonar_tracking.active.tracks.particle_cloud import (
    ParticleCloud,
    ParticleMotion,
    predict_cloud,
    systematic_rows,
)
from sonar_tracking.active.tracks.particle_densities import near_densities
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.errors import Notice, Severity
from sonar_tracking.filtering.assignment import load_solver
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate

SURVIVAL_PROBABILITY = 0.99
BIRTH_MASS = 0.2
BIRTH_PARTICLES = 500
LARGEST_NUMBER = 50
"""Of targets that are told apart; bounds particles and peaks whatever the contacts."""

PAIRS_AT_ONCE = 3_000_000
"""Of particles and contacts; bounds the memory."""

TURNS_COVERED_BY = 0.01
"""White acceleration with which the gates of peaks are predicted, m/s^2."""

ROUGHENING = np.array([1.0, 1.0, 0.02, 0.02])
"""Standard deviations added after resampling, m and m/s."""


class DensityTracker:
    """Number and states of several targets by SMC-PHD.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        With method ``smc_phd``.

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
        nothing = np.zeros(0)
        self._cloud = ParticleCloud(np.zeros((0, 4)), nothing.astype(np.int64), nothing)
        self._before: PlacedContacts | None = None
        self._tracks = no_peak_tracks()
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
        """Load what joins the first peaks."""
        load_solver()

    def update(self, contacts: Contacts, shared: SharedPings | None = None) -> ContactTrackerUpdate:
        """Return number and states after one ping; peaks keep their identities.

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
        interval = self._interval(contacts.stamp)
        cloud = self._predict(interval, model, sensor)
        cloud = self._weigh(cloud, placed, sensor, model)
        mass = float(np.sum(cloud.weight))
        self._follow(cloud, mass, interval, contacts.stamp)
        self._cloud = self._resample(cloud, mass)
        self._before, self._last = placed, origin_of(contacts)
        return ContactTrackerUpdate(
            tracks=shown_tracks(self._tracks.rows(), contacts.stamp, contacts.next_stamp),
            target_count=mass,
            thresholds=thresholds_without_gates(contacts.stamp, contacts.next_stamp, model),
            notices=(*notices, *guessed, *_crowd_notices(mass)),
        )

    def coast(self, stamp: int, next_stamp: int) -> ContactTrackerUpdate:
        """Return number and states predicted to a ping of which nothing else is known.

        Raises
        ------
        InputError
            If the stamp is not later than that of the ping before.
        """
        check_order(stamp, self._last)
        interval = self._interval(stamp)
        self._cloud = predict_cloud(self._cloud, self._motion, interval, self._generator)
        self._last = self._last and self._last.moved_to(stamp)
        mass = float(np.sum(self._cloud.weight))
        self._follow(self._cloud, mass, interval, stamp)
        return ContactTrackerUpdate(
            tracks=shown_tracks(self._tracks.rows(), stamp, next_stamp),
            target_count=mass,
            thresholds=thresholds_without_gates(stamp, next_stamp),
        )

    def _interval(self, stamp: int) -> float:
        return 0.0 if self._last is None else self._last.interval(stamp)

    def _predict(
        self, interval: float, model: DetectionModel, sensor: SensorGeometry
    ) -> ParticleCloud:
        moved = predict_cloud(self._cloud, self._motion, interval, self._generator)
        born = self._births(interval, model, sensor)
        return ParticleCloud(
            np.vstack([moved.state, born]),
            np.concatenate([moved.mode, self._generator.integers(0, 3, BIRTH_PARTICLES)]),
            np.concatenate(
                [
                    SURVIVAL_PROBABILITY * moved.weight,
                    np.full(BIRTH_PARTICLES, BIRTH_MASS / BIRTH_PARTICLES),
                ]
            ),
        )

    def _births(self, interval: float, model: DetectionModel, sensor: SensorGeometry) -> FloatArray:
        generator = self._generator
        noise = generator.standard_normal((BIRTH_PARTICLES, 2))
        state = np.zeros((BIRTH_PARTICLES, 4))
        if self._before is not None and len(self._before.distance):
            row = generator.integers(0, len(self._before.distance), BIRTH_PARTICLES)
            separation = self._before.position[row] - sensor.position
            distance = np.hypot(separation[:, 0], separation[:, 1])
            azimuth = np.arctan2(separation[:, 1], separation[:, 0])
            distance = distance + sensor.range_standard_deviation * noise[:, 0]
            azimuth = azimuth + sensor.azimuth_standard_deviation * noise[:, 1]
        else:
            reach = model.maximum_range if np.isfinite(model.maximum_range) else 1e4
            distance = reach * np.sqrt(generator.random(BIRTH_PARTICLES))
            azimuth = 2.0 * np.pi * generator.random(BIRTH_PARTICLES)
        state[:, 0] = sensor.position[0] + distance * np.cos(azimuth)
        state[:, 1] = sensor.position[1] + distance * np.sin(azimuth)
        speed = self.configuration.initial_speed_deviation
        state[:, 2:] = speed * generator.standard_normal((BIRTH_PARTICLES, 2))
        state[:, :2] += interval * state[:, 2:]
        return state

    def _weigh(
        self,
        cloud: ParticleCloud,
        placed: PlacedContacts,
        sensor: SensorGeometry,
        model: DetectionModel,
    ) -> ParticleCloud:
        detection = model.detection_probability
        clutter, n_particles = model.clutter_density(placed.distance), len(cloud.weight)
        factor = np.full(n_particles, 1.0 - detection)
        at_once = max(1, PAIRS_AT_ONCE // n_particles)
        for first in range(0, len(clutter), at_once):
            columns = np.arange(first, min(first + at_once, len(clutter)))
            near = near_densities(cloud.state, placed.select(columns), sensor)
            detected = detection * near.density
            shares = cloud.weight.take(near.particle) * detected
            expected = clutter[columns] + np.bincount(near.contact, shares, len(columns))
            explained = detected / expected.take(near.contact)
            factor += np.bincount(near.particle, explained, n_particles)
        return ParticleCloud(cloud.state, cloud.mode, cloud.weight * factor)

    def _resample(self, cloud: ParticleCloud, mass: float) -> ParticleCloud:
        count = self.configuration.n_particles * max(1, _told_apart(mass))
        rows = systematic_rows(cloud.weight, count, self._generator)
        noise = ROUGHENING * self._generator.standard_normal((count, 4))
        state = cloud.state.take(rows, axis=0) + noise
        return ParticleCloud(state, cloud.mode.take(rows), np.full(count, mass / count))

    def _follow(self, cloud: ParticleCloud, mass: float, interval: float, stamp: int) -> None:
        """Find the peaks of a ping and go on with the tracks of those before."""
        peaks = extract_states(cloud, _told_apart(mass), self._generator)
        before = predict_peaks(self._tracks, interval, TURNS_COVERED_BY)
        self._tracks = follow_peaks(before, peaks, cloud, stamp, self._next_id)
        self._next_id += int(np.count_nonzero(self._tracks.id >= self._next_id))


def _told_apart(mass: float) -> int:
    return min(round(mass), LARGEST_NUMBER)


def _crowd_notices(mass: float) -> tuple[Notice, ...]:
    if round(mass) <= LARGEST_NUMBER:
        return ()
    text = (
        f"The density holds {mass:.0f} targets; {LARGEST_NUMBER} of them are told apart. Check the "
        "claimed clutter and the detector's threshold."
    )
    return (Notice(Severity.WARN, "target_count", text),)
