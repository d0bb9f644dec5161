"""The filter of all measurements that is told whose each of them is, and the bound by it.

The filters of several runs are computed at once: what is computed of a ship does not depend on how
many others stand beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.alignment.aligned_targets import (
    AlignedTargets,
    MotionStrengths,
    begun,
    joined,
    predicted,
    replaced,
    with_array,
    with_arrays,
)
from sonar_tracking.alignment.shared_alignment import (
    SharedAlignment,
    no_information,
    shared_alignments,
)
from sonar_tracking.alignment.target_updates import (
    expected_azimuths,
    updated_by_positions,
    updated_if_expected,
)
from sonar_tracking.evaluation.offline.offline_fusion_chain import FusedMoment
from sonar_tracking.evaluation.studies.track_fusion.conditions import ACCELERATION
from sonar_tracking.fusion.bearing_trials import GATE
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.sided_bearings import expected_bearings, sided_bearings
from sonar_tracking.fusion.station_bearings import station_bearings
from sonar_tracking.fusion.target_filters import SMALLEST_VARIANCE
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import seconds

TOLD = MotionStrengths(np.array([ACCELERATION**2]), np.ones(1), 1.0)
"""How the ships really move."""

SPEED_DEVIATION = 6.0
"""Of each component of the velocity of a ship of which nothing is known, m/s."""

CONTACT_GATE = 16.0
"""A contact is the ship's if it is the nearest to the truth within so many variances."""


@dataclass(frozen=True)
class ToldEcho:
    """A contact of a ship.

    Attributes
    ----------
    ship : int
        Its number.
    truth : ndarray, shape (4,)
        x, y, vx, vy of the ship at the stamp, m and m/s.
    error : ndarray, shape (2,)
        By which the contact is beside where the ship reflected the ping, m.
    noise : ndarray, shape (2, 2)
        Covariance that is told of the contact, m^2.
    """

    ship: int
    truth: FloatArray
    error: FloatArray
    noise: FloatArray


@dataclass(frozen=True)
class ToldMoment:
    """What was received at a stamp, and of which ship.

    Attributes
    ----------
    stamp : int
        ns.
    echoes : tuple of ToldEcho
        One a ship at most.
    heard : tuple of tuple of HeardBearing
        Of each station that reports; the numbers of their bearing tracks are those of the ships.
    arrays : tuple of int
        Numbers of their misalignments.
    """

    stamp: int
    echoes: tuple[ToldEcho, ...]
    heard: tuple[tuple[HeardBearing, ...], ...]
    arrays: tuple[int, ...]


def told_moment(
    moment: FusedMoment, arrays: dict[str, int], configuration: TrackFusionConfiguration
) -> ToldMoment:
    """Return what was received at a stamp, and of which ship.

    Parameters
    ----------
    moment : FusedMoment
        With the truth.
    arrays : dict of str to int
        Numbers of the arrays that have been heard of so far; new ones are added.
    configuration : TrackFusionConfiguration
        Speed of sound, floors.
    """
    numbers = [
        arrays.setdefault(one.sensor.sensor_id, len(arrays)) for one in moment.frame.bearings
    ]
    found = [
        station_bearings(bearings, moment.own_ship, number, configuration).found
        for bearings, number in zip(moment.frame.bearings, numbers, strict=True)
    ]
    echoes: tuple[ToldEcho, ...] = ()
    if moment.contacts is not None and moment.frame.active:
        echoes = _echoes(moment.contacts, moment.truth, configuration.sound_speed)
    return ToldMoment(moment.frame.stamp, echoes, tuple(found), tuple(numbers))


def _echoes(contacts: Contacts, truth: TruthTracks, sound_speed: float) -> tuple[ToldEcho, ...]:
    placed, echoes = place_contacts(contacts, sound_speed), []
    for number, position, velocity in zip(truth.id, truth.position, truth.velocity, strict=True):
        apart = placed.position - position - placed.delay[:, None] * velocity
        solved = np.linalg.solve(placed.covariance, apart[..., None])[..., 0]
        distance = np.sum(apart * solved, axis=1)
        if not distance.size or np.min(distance) > CONTACT_GATE:
            continue
        nearest = int(np.argmin(distance))
        true = np.concatenate([position, velocity])
        echoes.append(ToldEcho(int(number), true, apart[nearest], placed.covariance[nearest]))
    return tuple(echoes)


class CentralFilters:
    """Follow the true ships of several runs, with their own contacts and bearings alone.

    Parameters
    ----------
    configuration : TrackFusionConfiguration
        Prior of the alignment, speed of sound.
    n_runs : int
        Stations move alike in all of them, and report at the same stamps.
    exact : bool
        Measurements are taken to be without errors, as they would be at the truth: the covariance
        is then the posterior Cramer-Rao bound.
    """

    def __init__(
        self, configuration: TrackFusionConfiguration, n_runs: int, exact: bool = False
    ) -> None:
        self._exact = exact
        self._variance = max(configuration.alignment_variance, SMALLEST_VARIANCE)
        self._speed = configuration.propagation_speed
        self._n_arrays = 0
        self._row_of: list[dict[int, int]] = [{} for _ in range(n_runs)]
        self._aligned = begun(np.empty((0, 4)), np.empty((0, 4, 4)), TOLD, np.empty(0))
        self._stamp: int | None = None
        self._seen: tuple[AlignedTargets, list[SharedAlignment]] | None = None

    @property
    def _prior(self) -> FloatArray:
        return np.full(self._n_arrays, self._variance)

    def update(self, moments: Sequence[ToldMoment]) -> None:
        """Take in what was received in each run at one stamp."""
        stamp = moments[0].stamp
        if self._stamp is not None:
            self._aligned = predicted(self._aligned, seconds(stamp - self._stamp), TOLD)
        self._stamp = stamp
        self._take_echoes(moments)
        for station, array in enumerate(moments[0].arrays):
            if array == self._n_arrays:
                self._n_arrays += 1
                self._aligned = with_array(self._aligned, self._variance)
            self._take_bearings([moment.heard[station] for moment in moments])

    def states(self, run: int) -> dict[int, tuple[FloatArray, FloatArray]]:
        """Return mean, shape (4,), and covariance, shape (4, 4), of each ship, m and m/s."""
        seen = self._pictures()[run]
        return {
            ship: (seen.mean[place, :4], seen.covariance[place, :4, :4])
            for place, ship in enumerate(self._row_of[run])
        }

    def _pictures(self) -> list[SharedAlignment]:
        """Return what all ships of each run tell together."""
        if self._seen is None or self._seen[0] is not self._aligned:
            own = [self._aligned.rows(self._rows_of(run)) for run in range(len(self._row_of))]
            nothing = [no_information(self._n_arrays) for _ in own]
            self._seen = self._aligned, shared_alignments(own, nothing, self._prior)
        return self._seen[1]

    def _rows_of(self, run: int) -> IndexArray:
        return np.array(list(self._row_of[run].values()), np.intp)

    def _take_echoes(self, moments: Sequence[ToldMoment]) -> None:
        every = [(self._row_of[run], one) for run, own in enumerate(moments) for one in own.echoes]
        if not every:
            return
        # At the stamp: the ship has moved on until it reflected the ping.
        measured = np.array([one.truth[:2] + (not self._exact) * one.error for _, one in every])
        noise = np.array([one.noise for _, one in every])
        rows = np.array([own.get(one.ship, -1) for own, one in every])
        known = np.flatnonzero(rows >= 0)
        if known.size:
            taking = self._aligned.rows(rows[known])
            updated, _ = updated_by_positions(taking, measured[known], noise[known])
            self._aligned = replaced(self._aligned, rows[known], updated)
        for place in np.flatnonzero(rows < 0).tolist():
            own, one = every[place]
            own[one.ship] = len(self._aligned)
            self._begin(one, measured[place])

    def _begin(self, echo: ToldEcho, measured: FloatArray) -> None:
        spread = np.zeros((4, 4))
        spread[:2, :2], spread[2:, 2:] = echo.noise, SPEED_DEVIATION**2 * np.eye(2)
        start = echo.truth[2:] if self._exact else np.zeros(2)
        state = np.concatenate([measured, start])
        new = begun(state[None], spread[None], TOLD, np.empty(0))
        self._aligned = joined(self._aligned, with_arrays(new, self._prior))

    def _take_bearings(self, heard: Sequence[Sequence[HeardBearing]]) -> None:
        """Take in what one station has heard in each run."""
        pairs = [
            (own[one.key[1]], one)
            for own, found in zip(self._row_of, heard, strict=True)
            for one in found
            if one.key[1] in own
        ]
        if not pairs:
            return
        rows = np.array([row for row, _ in pairs])
        aligned = self._aligned.rows(rows)
        told = self._told([one for _, one in pairs], rows)
        expected, spread = expected_bearings(told, aligned, self._speed)
        bearings = sided_bearings(told, expected, self._speed)
        innovation = bearings.innovation(expected)
        updated, _ = updated_if_expected(aligned, bearings, innovation, spread, GATE)
        self._aligned = replaced(self._aligned, rows, updated)

    def _told(self, found: list[HeardBearing], rows: IndexArray) -> list[HeardBearing]:
        """Return the bearings, or where the ships are expected to be heard."""
        if not self._exact:
            return found
        mean = np.empty(self._aligned.mean[:, 0].shape)
        covariance = np.empty(self._aligned.covariance[:, 0].shape)
        for run, seen in enumerate(self._pictures()):
            places = self._rows_of(run)
            mean[places], covariance[places] = seen.mean, seen.covariance
        first = found[0]
        expected, _ = expected_azimuths(
            mean[rows], covariance[rows], first.station, first.array, self._speed, first.lag
        )
        return [
            one.with_azimuth(float(azimuth)) for one, azimuth in zip(found, expected, strict=True)
        ]
