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

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sonar_tracking.active.association.lm_ipda import BankAssociation
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, position_covariance
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.contact_track_list import ContactTrackRows
from sonar_tracking.active.tracks.scene_rows import SceneRows, joined
from sonar_tracking.active.tracks.track_management import ListedTracks
from sonar_tracking.errors import Notice, Severity
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray
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

SCENE_APART = 1 << 40
"""Between the identifiers of two scenes whose tables are joined: more than any has tracks."""


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
        share = _median(self.squares) / MEDIAN_OF_SQUARES
        return max(share, SMALLEST_SHARE) if share < CLEAR_SHARE else 1.0

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
        return (Notice(Severity.WARN, "lasting error", text),)


def monitors_after(
    monitors: Sequence[LastingErrorMonitor],
    listed: ListedTracks,
    tracks: SceneRows,
    pairs: GatePairs,
    association: BankAssociation,
    pings: Sequence[Contacts],
    placed: PlacedContacts,
) -> list[LastingErrorMonitor]:
    """Return the monitor of each scene after another ping.

    Parameters
    ----------
    monitors : sequence of LastingErrorMonitor
        Before it, one a scene.
    listed : ListedTracks
        Which tracks there are, and which have ended.
    tracks : SceneRows
        Whose tracks they are.
    pairs : GatePairs
        Contacts in their gates.
    association : BankAssociation
        Whose contacts they are.
    pings : sequence of Contacts
        The ping as received, in each scene.
    placed : PlacedContacts
        Its contacts, with the noise they are believed to have.
    """
    bank = listed.bank
    goes_on = bank.confirmed & listed.alive
    followed = goes_on[pairs.track].nonzero()[0]
    track = pairs.track[followed]
    probability = bank.contact_probabilities(track, association.weights[followed])
    sure = probability > SURE
    track, contact = track[sure], pairs.contact[followed[sure]]
    scenes = tracks.of(track)
    starts = [m.start or ping.stamp for m, ping in zip(monitors, pings, strict=True)]
    since = [seconds(p.stamp - start) for p, start in zip(pings, starts, strict=True)]
    share = scenes.spread([np.array(monitor.noise_share)[None, None] for monitor in monitors])
    keys = bank.id + tracks.spread([scene * SCENE_APART for scene in range(len(monitors))])
    third = _LastContacts(
        keys[track],
        scenes.spread(since) + placed.delay[contact],
        placed.position[contact],
        placed.covariance[contact] / share,
    )
    after = _followed(monitors, third, keys[goes_on], scenes)
    return [
        replace(monitor, start=start, claimed=claimed_error(ping) or monitor.claimed)
        for monitor, start, ping in zip(after, starts, pings, strict=True)
    ]


@dataclass(frozen=True)
class _LastContacts:
    """Contacts of a ping that belong to tracks almost surely, in the order of their tracks."""

    id: IntArray
    time: FloatArray
    position: FloatArray
    covariance: FloatArray


def _followed(
    monitors: Sequence[LastingErrorMonitor],
    third: _LastContacts,
    tracks: IntArray,
    scenes: SceneRows,
) -> list[LastingErrorMonitor]:
    """Return the monitors with third contacts of some tracks, and with these tracks alone."""
    rows = SceneRows(tuple(len(monitor.id) for monitor in monitors))
    first = rows.spread([scene * SCENE_APART for scene in range(len(monitors))])
    known_ids = joined([monitor.id for monitor in monitors]) + first
    kept = _among(known_ids, tracks)
    if not len(third.id) and kept.all():
        return list(monitors)
    fresh = third.id[~_among(third.id, known_ids)]
    old_ids = known_ids[kept]
    ids = np.sort(np.concatenate([old_ids, fresh])) if len(fresh) else old_ids
    old_rows, rows_of_third = ids.searchsorted(old_ids), ids.searchsorted(third.id)
    columns, last = {}, {}
    for name, nothing in (("time", np.nan), ("position", 0.0), ("covariance", 0.0)):
        old = joined([getattr(monitor, name) for monitor in monitors])[kept]
        column = np.full((len(ids), *old.shape[1:]), nothing)
        column[old_rows] = old
        last[name] = column[rows_of_third]
        column[rows_of_third, 0] = last[name][:, 1]
        column[rows_of_third, 1] = getattr(third, name)
        columns[name] = column
    full, squares = _squares(last["time"], last["position"], last["covariance"], third)
    bounds = [scene * SCENE_APART for scene in range(1, len(monitors))]
    ends = [0, *ids.searchsorted(bounds).tolist(), len(ids)]
    of_scene = SceneRows(tuple(end - begin for begin, end in itertools.pairwise(ends)))
    parts = [of_scene.split(column) for column in columns.values()]
    return [
        LastingErrorMonitor(
            id=own - scene * SCENE_APART,
            time=time,
            position=position,
            covariance=covariance,
            squares=np.concatenate([monitor.squares, new])[-MOST_SQUARES:],
        )
        for scene, (monitor, own, time, position, covariance, new) in enumerate(
            zip(
                monitors,
                of_scene.split(ids),
                *parts,
                scenes.of(full).split(squares),
                strict=True,
            )
        )
    ]


def _among(ids: IntArray, others: IntArray) -> BoolArray:
    """Return which identifiers are among others, both ascending and positive."""
    return np.asarray(np.append(others, -1)[others.searchsorted(ids)] == ids)


def claimed_error(contacts: Contacts) -> ClaimedError | None:
    """Return how far the contacts of a ping may be off, as it says; None = it has none."""
    if not len(contacts.range):
        return None
    return ClaimedError(
        contacts.sensor_position,
        _mean(contacts.range_standard_deviation),
        _mean(contacts.azimuth_standard_deviation),
    )


def _mean(deviation: float | FloatArray) -> float:
    return deviation if isinstance(deviation, float) else float(np.mean(deviation))


def _median(values: FloatArray) -> float:
    """Return the median; that of numpy takes longer to look for its axis than to sort."""
    ascending, middle = np.sort(values), len(values) // 2
    if len(values) % 2:
        return float(ascending[middle])
    return 0.5 * float(ascending[middle - 1] + ascending[middle])


def _squares(
    time: FloatArray, position: FloatArray, covariance: FloatArray, third: _LastContacts
) -> tuple[IndexArray, FloatArray]:
    """Return which third contacts have two before them, and how far they are from their line."""
    before = time[:, 1] - time[:, 0]
    full = np.flatnonzero(before > 0.0)
    ratio = (third.time[full] - time[full, 1]) / before[full]
    step = position[full, 1] - position[full, 0]
    distance = third.position[full] - position[full, 1] - ratio[:, None] * step
    ratio = ratio[:, None, None]
    total = third.covariance[full] + (1.0 + ratio) ** 2 * covariance[full, 1]
    total = total + ratio**2 * covariance[full, 0]
    scaled = np.linalg.solve(total, distance[..., None])[..., 0]
    return full, np.asarray((distance * scaled).sum(axis=1))
