"""Birth, confirmation, coasting, end and duplicates of tracks.

Every contact that no track explains starts one candidate. Existence confirms it; a confirmed track
ends when existence falls below the termination probability, a candidate when it has not been
detected about three times. Of two tracks whose positions and velocities cannot be told apart the
younger one ends, so that no target has two identities.

References
----------
Kim, Song (2007), section 3; the rules it leaves open are stated in the functions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.contacts.contact_positions import IDENTITY, PlacedContacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.contact_track_list import ContactTrackRows
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray
from sonar_tracking.records.bearings import TrackStatus

DUPLICATE_DISTANCE = 1.5
"""Standard deviations of the difference of two states below which they are one target's."""

COMPARED_TRACKS = 64
"""Of those that share a contact, with how many younger ones each is compared."""

MISSES_OF_A_CANDIDATE = 3
RANGE_MARGIN = 1.2
"""A track ends so far beyond the largest range."""


def survivors(
    bank: TrackBank,
    distance: FloatArray,
    maximum_range: float,
    detection_probability: float,
    configuration: ContactTrackerConfiguration,
) -> BoolArray:
    """Return which tracks go on.

    Parameters
    ----------
    bank : TrackBank
        After the update.
    distance : ndarray, shape (n,)
        From the sensor, m.
    maximum_range : float
        m.
    detection_probability : float
        P_D of candidates.
    configuration : ContactTrackerConfiguration
        Limits.

    Returns
    -------
    ndarray of bool, shape (n,)
        True = goes on.
    """
    missed = (1.0 - detection_probability) ** MISSES_OF_A_CANDIDATE
    least = np.where(
        bank.confirmed,
        configuration.termination_probability,
        1.5 * configuration.initial_existence * missed,
    )
    _, covariance = bank.position_moments()
    variance = covariance[:, 0, 0] + covariance[:, 1, 1]
    good = (bank.existence >= least) & (variance <= configuration.maximum_position_variance)
    return good & (distance <= RANGE_MARGIN * maximum_range)


def duplicates(bank: TrackBank, pairs: GatePairs, weights: FloatArray) -> BoolArray:
    """Return which tracks repeat another one; only tracks that share a contact are compared.

    In a crowd a track is compared with those next to it in age only.

    Two tracks that each have a contact of their own are two targets side by side, however near.

    Parameters
    ----------
    bank : TrackBank
        After the update.
    pairs : GatePairs
        Contacts in the gates of this ping.
    weights : ndarray, shape (n_pairs, n_modes)
        Probabilities of association in each mode.

    Returns
    -------
    ndarray of bool, shape (n,)
        True = ends as a duplicate.
    """
    repeated = np.zeros(len(bank), dtype=bool)
    if not len(pairs.contact) or np.bincount(pairs.contact).max() < 2:
        return repeated
    both = _sharing_tracks(pairs)
    among = np.zeros(len(bank), dtype=bool)
    among[both] = True
    rows, place = np.flatnonzero(among), np.cumsum(among) - 1
    mean, covariance = bank.moments_of(rows)
    first, second = _near_each_other(place.take(both), mean, covariance)
    if not len(first):
        return repeated
    difference = mean[first] - mean[second]
    spread = _regular(covariance[first] + covariance[second])
    first, second = rows[first], rows[second]
    scaled = np.linalg.solve(spread, difference[..., None])[..., 0]
    near = (difference * scaled).sum(axis=1) < DUPLICATE_DISTANCE**2
    own = _own_contact(bank, pairs, weights)
    near &= (own[first] == own[second]) | (own[first] < 0) | (own[second] < 0)
    first, second = first[near], second[near]
    # Rows are in order of age; a confirmed track never ends for a candidate.
    ends = np.where(bank.confirmed[second] & ~bank.confirmed[first], first, second)
    repeated[ends] = True
    return repeated


def start_candidates(
    contacts: PlacedContacts,
    existence: FloatArray,
    stamp: int,
    first_id: int | IntArray,
    modes: MotionModel,
    mode_prior: FloatArray,
    detection_weight: FloatArray,
) -> TrackBank:
    """Return one candidate a contact: at rest, its velocity unknown.

    Parameters
    ----------
    contacts : PlacedContacts
        Contacts that no track explains.
    existence : ndarray, shape (n_contacts,)
        Existence probability of each.
    stamp : int
        Of the ping, ns.
    first_id : int or ndarray of int, shape (n_contacts,)
        Identifier of the first one; each has its row more.
    modes : MotionModel
        Tells how fast new targets are in each mode.
    mode_prior : ndarray, shape (n_modes,) or (n_contacts, n_modes)
        Probabilities of the modes.
    detection_weight : ndarray, shape (n_levels,) or (n_contacts, n_levels)
        Probabilities of the levels of their P_D.
    """
    count, n_modes = len(existence), modes.n_modes
    mean = np.zeros((count, n_modes, 4))
    mean[..., :2] = contacts.position[:, None]
    variance = modes.speed_deviation[:, None, None] ** 2 * IDENTITY
    delay = contacts.delay[:, None, None, None]
    covariance = np.empty((count, n_modes, 4, 4))
    # The position is that at the reflection: at the stamp it was delay * velocity before.
    covariance[..., :2, :2] = contacts.covariance[:, None] + delay**2 * variance
    covariance[..., :2, 2:] = covariance[..., 2:, :2] = -delay * variance
    covariance[..., 2:, 2:] = variance
    return TrackBank(
        id=first_id + np.arange(count, dtype=np.int64),
        existence=existence,
        confirmed=np.zeros(count, dtype=bool),
        initiated=np.full(count, stamp, dtype=np.int64),
        updated=np.full(count, stamp, dtype=np.int64),
        mean=mean,
        covariance=covariance,
        mode_probability=np.ones((count, 1)) * mode_prior,
        detection_weight=np.ones((count, 1)) * detection_weight,
        entered=np.zeros((count, n_modes)),
        calm=np.zeros((count, n_modes)),
        # A target that is new may be in the middle of a turn: that is none that began.
        shown=np.ones((count, n_modes), dtype=bool),
    )


@dataclass(frozen=True)
class ListedTracks:
    """Which tracks are shown.

    Attributes
    ----------
    bank : TrackBank
        After the update, before tracks were removed.
    alive : ndarray of bool, shape (n,)
        Tracks that go on.
    was_shown : ndarray of bool, shape (n,)
        Shown at the ping before.
    detected : ndarray, shape (n,)
        Probability that a contact was the track's.
    """

    bank: TrackBank
    alive: BoolArray
    was_shown: BoolArray
    detected: FloatArray

    def select(self, rows: slice) -> ListedTracks:
        """Return some of the tracks, next to each other."""
        return ListedTracks(
            self.bank.select(rows), self.alive[rows], self.was_shown[rows], self.detected[rows]
        )


def limit_tracks(
    listed: ListedTracks, candidates: TrackBank, maximum_tracks: int
) -> tuple[ListedTracks, TrackBank]:
    """Return tracks and candidates of which the least probable end if there are too many.

    Parameters
    ----------
    listed : ListedTracks
        Tracks and what became of them.
    candidates : TrackBank
        What the ping starts.
    maximum_tracks : int
        Largest number of both together; confirmed tracks go first.
    """
    rows = np.flatnonzero(listed.alive)
    excess = len(rows) + len(candidates) - maximum_tracks
    if excess <= 0:
        return listed, candidates
    bank = listed.bank
    worth = np.concatenate([(bank.existence + bank.confirmed)[rows], candidates.existence])
    stays = np.ones(len(worth), dtype=bool)
    stays[np.argsort(worth, kind="stable")[:excess]] = False
    alive = listed.alive.copy()
    alive[rows] = stays[: len(rows)]
    return replace(listed, alive=alive), candidates.select(stays[len(rows) :])


def listed_rows(listed: ListedTracks, tentative_probability: float) -> IndexArray:
    """Return the rows of the tracks that are shown, shape (n_shown,).

    What has been shown once is shown until it ends, which is reported once.

    Parameters
    ----------
    listed : ListedTracks
        Tracks and what became of them.
    tentative_probability : float
        Existence from which a candidate is shown.
    """
    bank = listed.bank
    likely = bank.confirmed | (bank.existence >= tentative_probability)
    return np.flatnonzero(listed.was_shown | (listed.alive & likely))


def list_tracks(
    listed: ListedTracks, rows: IndexArray, static_mode: int | None
) -> ContactTrackRows:
    """Return the complete picture: confirmed tracks, likely candidates, and what has ended.

    Parameters
    ----------
    listed : ListedTracks
        Tracks and what became of them.
    rows : ndarray of int, shape (n_shown,)
        Those that are shown, from :func:`listed_rows`.
    static_mode : int or None
        Mode of what is fixed; None = there is none.
    """
    bank = listed.bank
    confirmed = bank.confirmed[rows]
    status = np.where(confirmed, int(TrackStatus.CONFIRMED), int(TrackStatus.TENTATIVE))
    status[confirmed & (listed.detected[rows] < 0.5)] = int(TrackStatus.COASTED)
    status[~listed.alive[rows]] = int(TrackStatus.TERMINATED)
    mean, covariance = bank.moments_of(rows)
    static = None if static_mode is None else bank.mode_probability[rows, static_mode] > 0.5
    return ContactTrackRows(
        id=bank.id[rows],
        status=status,
        existence=bank.existence[rows],
        state=mean,
        covariance=covariance,
        initiated=bank.initiated[rows],
        updated=bank.updated[rows],
        static=static,
    )


def _regular(covariance: FloatArray) -> FloatArray:
    """Return covariances, shape (n, 4, 4), with diagonals just large enough to be inverted."""
    diagonal = np.einsum("nii->ni", covariance)
    result = covariance.copy()
    np.einsum("nii->ni", result)[...] = diagonal * (1.0 + 1e-9) + 1e-12
    return result


def _own_contact(bank: TrackBank, pairs: GatePairs, weights: FloatArray) -> IndexArray:
    """Return the contact that is more probably than not each track's, -1 = none is."""
    probability = bank.contact_probabilities(pairs.track, weights)
    likely = probability > 0.5
    own = np.full(len(bank), -1, dtype=np.intp)
    own[pairs.track[likely]] = pairs.contact[likely]
    return own


def _sharing_tracks(pairs: GatePairs) -> IndexArray:
    """Return rows of tracks (older, younger) with a common contact, shape (2, n)."""
    order = np.argsort(pairs.contact, kind="stable")
    contact, track = pairs.contact[order], pairs.track[order]
    found = []
    for lag in range(1, min(len(contact), COMPARED_TRACKS + 1)):
        same = contact[lag:] == contact[:-lag]
        if not np.any(same):
            break
        # Pairs are in the order of the tracks, and tracks in the order of their age.
        found.append(np.stack([track[:-lag][same], track[lag:][same]]))
    return np.concatenate(found, axis=1)


def _near_each_other(
    both: IndexArray, mean: FloatArray, covariance: FloatArray
) -> tuple[IndexArray, IndexArray]:
    """Return the rows, each two once, whose states are near in each of their components."""
    first, second = both
    variance = np.einsum("nii->ni", covariance)
    # In a crowd nearly all are apart in their first component.
    for column in range(mean.shape[1]):
        value, own = mean[:, column], variance[:, column]
        square = (value.take(first) - value.take(second)) ** 2
        near = square < DUPLICATE_DISTANCE**2 * (own.take(first) + own.take(second))
        first, second = first[near], second[near]
    keys = np.sort(first * len(mean) + second)
    once = np.ones(len(keys), dtype=bool)
    np.not_equal(keys[1:], keys[:-1], out=once[1:])
    first, second = np.divmod(keys[once], len(mean))
    return first, second
