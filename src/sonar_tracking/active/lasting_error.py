"""Which part of the error of contacts lasts from ping to ping.

A sensor says how far its contacts may be off; it does not say whether that is noise, new at each
ping, or lasts: a ship of 100 m that reflects at the near side, a heading that is one degree off, a
stamp that is late. A filter that takes lasting errors for noise averages them away and claims to
know the position much better than it does.

What is new at each ping is seen in three successive contacts of one track: the third one, against
the line through the first two, has the covariance R_3 + (1 + rho)^2 R_2 + rho^2 R_1 if all of R is
noise, with rho the ratio of the intervals. Where the squares of many tracks are smaller by a factor
w^2, the noise of a contact is w^2 R, and the rest, (1 - w^2) R, lasts: the filter takes the
former, and the latter is added to what is published.

References
----------
S. F. Schmidt's consider filter for errors that are budgeted, not estimated: Bar-Shalom, Li,
Kirubarajan (2001), section 5.6 on the consistency that is restored by it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sonar_tracking.active.association.lm_ipda import BankAssociation
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, position_covariance
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.contact_track_list import ContactTrackRows
from sonar_tracking.active.tracks.track_management import ListedTracks
from sonar_tracking.errors import Notice, Severity
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.time import seconds

MEDIAN_OF_SQUARES = 2.0 * float(np.log(2.0))
"""Of a chi-square variable of two degrees of freedom."""

LEAST_SQUARES, MOST_SQUARES = 20, 200
"""From so many on they are believed; so many of the newest count."""

CLEAR_SHARE = 0.6
"""Only where the noise has less than this share of the variance anything is taken for lasting."""

SMALLEST_SHARE = 1e-3
"""Contacts that never vary, as of a simulation, are not believed to be without noise."""

SURE = 0.9
"""Probability from which a contact is a track's."""

LASTING_TIME = 20.0
"""In which a lasting error changes, s."""


@dataclass(frozen=True)
class ClaimedError:
    """How far contacts may be off, as the sensor says, and where it is.

    Attributes
    ----------
    position : tuple of float
        Of the sensor in ``map``, m.
    range_standard_deviation, azimuth_standard_deviation : float
        The mean of the contacts, m and rad.
    """

    position: tuple[float, float]
    range_standard_deviation: float
    azimuth_standard_deviation: float


@dataclass(frozen=True)
class LastingErrorMonitor:
    """Last contacts of the tracks, and how well three of them lie on a line.

    Attributes
    ----------
    id : ndarray of int, shape (n,)
        Identifiers of the tracks, ascending.
    time : ndarray, shape (n, 2)
        When their last two contacts were reflected, s from the first ping; NaN = there is none.
    position : ndarray, shape (n, 2, 2)
        Where, m.
    covariance : ndarray, shape (n, 2, 2, 2)
        Of the positions, as the sensor claims, m^2.
    squares : ndarray, shape (n_squares,)
        Normalised squared distances of third contacts, oldest first, pure numbers.
    start : int
        Stamp of the first ping, ns; 0 = there was none.
    claimed : ClaimedError or None
        Of the last ping with contacts.
    """

    id: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    time: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    position: FloatArray = field(default_factory=lambda: np.zeros((0, 2, 2)))
    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 2, 2, 2)))
    squares: FloatArray = field(default_factory=lambda: np.zeros(0))
    start: int = 0
    claimed: ClaimedError | None = None

    @cached_property
    def noise_share(self) -> float:
        """Return w^2, the share of the claimed variance that is new at each ping, 0 to 1."""
        if len(self.squares) < LEAST_SQUARES:
            return 1.0
        share = float(np.median(self.squares)) / MEDIAN_OF_SQUARES
        return max(share, SMALLEST_SHARE) if share < CLEAR_SHARE else 1.0

    def after(
        self,
        listed: ListedTracks,
        pairs: GatePairs,
        association: BankAssociation,
        contacts: Contacts,
        placed: PlacedContacts,
    ) -> LastingErrorMonitor:
        """Return the monitor after another ping.

        Parameters
        ----------
        listed : ListedTracks
            Which tracks there are, and which have ended.
        pairs : GatePairs
            Contacts in their gates.
        association : BankAssociation
            Whose contacts they are.
        contacts : Contacts
            The ping as received.
        placed : PlacedContacts
            Its contacts, with the noise they are believed to have.
        """
        bank = listed.bank
        probability = bank.contact_probabilities(pairs.track, association.weights)
        sure = (probability > SURE) & (bank.confirmed & listed.alive)[pairs.track]
        track, contact = pairs.track[sure], pairs.contact[sure]
        start = self.start or contacts.stamp
        time = seconds(contacts.stamp - start) + placed.delay[contact]
        claimed = placed.covariance[contact] / self.noise_share
        third = _LastContacts(bank.id[track], time, placed.position[contact], claimed)
        return replace(
            self._with(third, bank.id[bank.confirmed & listed.alive]),
            start=start,
            claimed=_claimed_error(contacts) or self.claimed,
        )

    def without_it(self, contacts: Contacts) -> Contacts:
        """Return a ping whose contacts have the errors that are new at each ping alone."""
        factor = float(np.sqrt(self.noise_share))
        if factor == 1.0:
            return contacts
        return replace(
            contacts,
            range_standard_deviation=factor * contacts.range_standard_deviation,
            azimuth_standard_deviation=factor * contacts.azimuth_standard_deviation,
        )

    def with_it(self, rows: ContactTrackRows) -> ContactTrackRows:
        """Return tracks whose covariances hold the lasting errors, too."""
        if self.noise_share == 1.0 or self.claimed is None:
            return rows
        separation = rows.state[:, :2] - np.array(self.claimed.position)
        distance = np.maximum(np.hypot(separation[:, 0], separation[:, 1]), 1e-3)
        lasting = (1.0 - self.noise_share) * position_covariance(
            separation / distance[:, None],
            distance,
            self.claimed.range_standard_deviation,
            self.claimed.azimuth_standard_deviation,
        )
        covariance = rows.covariance.copy()
        covariance[:, :2, :2] += lasting
        covariance[:, 2:, 2:] += lasting / LASTING_TIME**2
        return replace(rows, covariance=covariance)

    def notices(self) -> tuple[Notice, ...]:
        """Return what a user should know."""
        if self.noise_share == 1.0:
            return ()
        text = (
            f"Contacts of a track vary by {100.0 * np.sqrt(self.noise_share):.0f} % of the "
            "standard deviation that is claimed for them; the rest is taken for an error that "
            "lasts, and is part of the covariances of the tracks. Check the deviations of the "
            "contacts, if targets are small and the heading is good."
        )
        return (Notice(Severity.OK, "lasting error", text),)

    def _with(self, third: _LastContacts, tracks: IntArray) -> LastingErrorMonitor:
        """Return the monitor with third contacts of some tracks, and with these tracks alone."""
        kept = _among(self.id, tracks) & ~_among(self.id, third.id)
        if not len(third.id) and kept.all():
            return self
        row = np.searchsorted(self.id, third.id)
        known = _among(third.id, self.id)
        times = np.full((len(third.id), 2), np.nan)
        positions = np.zeros((len(third.id), 2, 2))
        covariances = np.zeros((len(third.id), 2, 2, 2))
        times[known] = self.time[row[known]]
        positions[known] = self.position[row[known]]
        covariances[known] = self.covariance[row[known]]
        squares = _squares(times, positions, covariances, third)
        ids = np.concatenate([self.id[kept], third.id])
        order = np.argsort(ids, kind="stable")

        def merged(old: FloatArray, second: FloatArray, newest: FloatArray) -> FloatArray:
            new = np.stack([second[:, 1], newest], axis=1)
            return np.concatenate([old[kept], new])[order]

        return replace(
            self,
            id=ids[order],
            time=merged(self.time, times, third.time),
            position=merged(self.position, positions, third.position),
            covariance=merged(self.covariance, covariances, third.covariance),
            squares=np.concatenate([self.squares, squares])[-MOST_SQUARES:],
        )


@dataclass(frozen=True)
class _LastContacts:
    """Contacts of a ping that belong to tracks almost surely, in the order of their tracks."""

    id: IntArray
    time: FloatArray
    position: FloatArray
    covariance: FloatArray


def _among(ids: IntArray, others: IntArray) -> BoolArray:
    """Return which identifiers are among others, both ascending and positive."""
    return np.asarray(np.append(others, -1)[others.searchsorted(ids)] == ids)


def _claimed_error(contacts: Contacts) -> ClaimedError | None:
    if not len(contacts.range):
        return None
    return ClaimedError(
        contacts.sensor_position,
        float(np.mean(contacts.range_standard_deviation)),
        float(np.mean(contacts.azimuth_standard_deviation)),
    )


def _squares(
    time: FloatArray, position: FloatArray, covariance: FloatArray, third: _LastContacts
) -> FloatArray:
    """Return the squared distances of third contacts from the line through the two before."""
    before = time[:, 1] - time[:, 0]
    full = np.flatnonzero(before > 0.0)
    ratio = (third.time[full] - time[full, 1]) / before[full]
    step = position[full, 1] - position[full, 0]
    distance = third.position[full] - position[full, 1] - ratio[:, None] * step
    ratio = ratio[:, None, None]
    total = third.covariance[full] + (1.0 + ratio) ** 2 * covariance[full, 1]
    total = total + ratio**2 * covariance[full, 0]
    scaled = np.linalg.solve(total, distance[..., None])[..., 0]
    return np.asarray(np.sum(distance * scaled, axis=1))
