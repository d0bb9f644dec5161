"""Which contacts lie in the gates of which tracks.

Pairs are found through the contacts sorted by x and tracks in portions, so that memory stays
bounded.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    TrackGates,
    delayed_position_covariance,
    determinant,
    pairs_of_scenes,
)
from sonar_tracking.active.tracks.pair_limits import (
    CONTACTS_IN_GATE,
    MAXIMUM_BOXED,
    MAXIMUM_PAIRS,
    few_enough,
    half_widths,
    nearest_in_gates,
)
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

BOXED_PER_PORTION = 500_000
"""Contacts in boxes around gates that are looked at together; bounds the memory."""

COMPARED_AT_ONCE = 3000
"""Up to so many of tracks times contacts no search is faster than comparing all."""

BOX_SIZE = 1.5 * GATE_SIZE
"""Half of a box, in standard deviations: a gate at a contact may be wider by its noise."""


@dataclass(frozen=True)
class GatedTracks:
    """Predicted tracks with their gates, or some of them.

    Attributes
    ----------
    mean, spread : ndarray, shape (n, 4) and (n, 4, 4)
        Of x, y, vx, vy, m and m/s; m^2, m^2/s, m^2/s^2.
    gates : TrackGates
        Their gates.
    confirmed : ndarray of bool, shape (n,)
        False = candidate.
    """

    mean: FloatArray
    spread: FloatArray
    gates: TrackGates
    confirmed: BoolArray

    def __len__(self) -> int:
        return len(self.confirmed)

    def select(self, rows: IndexArray) -> GatedTracks:
        """Return some of the tracks, by their rows, shape (n_kept,)."""
        return GatedTracks(
            self.mean[rows], self.spread[rows], self.gates.select(rows), self.confirmed[rows]
        )


def find_pairs(
    bank: TrackBank,
    gates: TrackGates,
    contacts: PlacedContacts,
    amplitudes: FloatArray | None = None,
    thresholds: FloatArray | None = None,
) -> GatePairs:
    """Return all pairs of a track and a contact in its gate, the nearest ones of a crowd.

    Most tracks are candidates, and these have one threshold: where it is above most contacts, as
    in a survey that reports nearly everything, only those with a strong contact are looked at.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    gates : TrackGates
        Their gates.
    contacts : PlacedContacts
        Contacts of the ping.
    amplitudes : ndarray, shape (n_contacts,), optional
        Linear powers; NaN where not measured. All contacts pass if not given.
    thresholds : ndarray, shape (n,), optional
        Linear powers, of each track: weaker contacts are none of it. An amplitude or a threshold
        that is not known (NaN) lets the contact pass.
    """
    tracks = GatedTracks(*bank.moments(), gates, bank.confirmed)
    if amplitudes is None or thresholds is None or not len(bank):
        return _all_pairs(tracks, contacts)
    highest = np.max(thresholds)
    strong = np.flatnonzero(~(amplitudes < highest))
    n_tracks, n_contacts = len(bank), len(amplitudes)
    compared = n_tracks * n_contacts
    limited = compared > MAXIMUM_BOXED or n_tracks * CONTACTS_IN_GATE[0] > MAXIMUM_PAIRS
    if limited or compared <= COMPARED_AT_ONCE or 2 * len(strong) > n_contacts:
        return _passing(_all_pairs(tracks, contacts), amplitudes, thresholds)
    strict = ~(thresholds < highest)
    rows = np.flatnonzero(strict)
    strict[rows[_all_pairs(tracks.select(rows), contacts.select(strong)).track]] = False
    # In a crowd the weak ones count among the nearest, too.
    rows = np.flatnonzero(~strict)
    pairs = _passing(_all_pairs(tracks.select(rows), contacts), amplitudes, thresholds[rows])
    return GatePairs(rows[pairs.track], pairs.contact)


def find_pairs_of_scenes(
    bank: TrackBank,
    tracks: SceneRows,
    gates: TrackGates,
    contacts: PlacedContacts,
    contact_rows: SceneRows,
    amplitudes: FloatArray,
    thresholds: FloatArray,
) -> GatePairs:
    """Return all pairs of a track and a contact of its scene in its gate, as of each by itself.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks of all scenes.
    tracks : SceneRows
        Whose they are.
    gates : TrackGates
        Their gates.
    contacts : PlacedContacts
        Contacts of the ping in all scenes.
    contact_rows : SceneRows
        Whose they are.
    amplitudes : ndarray, shape (n_contacts,)
        Linear powers; NaN where not measured.
    thresholds : ndarray, shape (n,)
        Linear powers, of each track; NaN where not known.
    """
    if tracks.single:
        return find_pairs(bank, gates, contacts, amplitudes, thresholds)
    compared = sum(n * m for n, m in zip(tracks.counts, contact_rows.counts, strict=True))
    if compared > MAXIMUM_BOXED or max(tracks.counts) * CONTACTS_IN_GATE[0] > MAXIMUM_PAIRS:
        parts = zip(
            bank.parts(tracks),
            tracks.parts(gates),
            contact_rows.parts(contacts),
            contact_rows.split(amplitudes),
            tracks.split(thresholds),
            strict=True,
        )
        return pairs_of_scenes([find_pairs(*scene) for scene in parts], tracks, contact_rows)
    all_tracks = GatedTracks(*bank.moments(), gates, bank.confirmed)
    highest = [np.max(each, initial=-np.inf) for each in tracks.split(thresholds)]
    strong = np.flatnonzero(~(amplitudes < contact_rows.spread(highest)))
    if 2 * len(strong) > len(amplitudes):
        found = _pairs_of_all(all_tracks, tracks, contacts, contact_rows)
        return _passing(found, amplitudes, thresholds)
    strict = ~(thresholds < tracks.spread(highest))
    rows = np.flatnonzero(strict)
    loud = _pairs_of_all(
        all_tracks.select(rows), tracks.of(rows), contacts.select(strong), contact_rows.of(strong)
    )
    strict[rows[loud.track]] = False
    # In a crowd the weak ones count among the nearest, too.
    rows = np.flatnonzero(~strict)
    found = _pairs_of_all(all_tracks.select(rows), tracks.of(rows), contacts, contact_rows)
    found = _passing(found, amplitudes, thresholds[rows])
    return GatePairs(rows[found.track], found.contact)


def _pairs_of_all(
    tracks: GatedTracks, track_rows: SceneRows, contacts: PlacedContacts, contact_rows: SceneRows
) -> GatePairs:
    """Return the contacts in all gates; few enough to be looked at in one portion."""
    xs = zip(contact_rows.starts, contact_rows.split(contacts.position[:, 0]), strict=True)
    order = np.concatenate([first + ascending_rows(x) for first, x in xs])
    sorted_x, sorted_y = np.ascontiguousarray(contacts.position.take(order, axis=0).T)
    gates = tracks.gates
    x_of, centre_of = contact_rows.split(sorted_x), track_rows.split(gates.centre[:, 0])
    half_of = track_rows.split(BOX_SIZE * np.sqrt(gates.covariance[:, 0, 0]))
    scenes = list(zip(contact_rows.starts, x_of, centre_of, half_of, strict=True))
    low = np.concatenate([first + x.searchsorted(c - half) for first, x, c, half in scenes])
    high = np.concatenate([first + x.searchsorted(c + half) for first, x, c, half in scenes])
    pairs = _near(np.arange(len(tracks)), low, high, gates, order, sorted_y)
    square = _squared_distances(tracks.mean, tracks.spread, contacts, pairs)
    inside = square < GATE_SIZE**2
    pairs = pairs.keep(inside)
    return pairs.keep(nearest_in_gates(pairs.track, square[inside]))


def _passing(pairs: GatePairs, amplitudes: FloatArray, thresholds: FloatArray) -> GatePairs:
    # Written so that an amplitude or a threshold that is not known lets the contact pass.
    return pairs.keep(~(amplitudes[pairs.contact] < thresholds[pairs.track]))


def _all_pairs(tracks: GatedTracks, contacts: PlacedContacts) -> GatePairs:
    order = ascending_rows(contacts.position[:, 0])
    mean, spread, gates = tracks.mean, tracks.spread, tracks.gates
    if len(tracks) * len(order) <= COMPARED_AT_ONCE:
        pairs = _near_of_few(gates, order, contacts)
        square = _squared_distances(mean, spread, contacts, pairs)
        inside = square < GATE_SIZE**2
        pairs = pairs.keep(inside)
        return pairs.keep(nearest_in_gates(pairs.track, square[inside]))
    sorted_x, sorted_y = np.ascontiguousarray(contacts.position.take(order, axis=0).T)
    low, high = _boxed(gates, sorted_x, tracks.confirmed)
    before = (high - low).cumsum()
    found, columns, squares = [], [], []
    first = 0
    while first < len(tracks):
        reached = before[first - 1] if first else 0
        last = int(before.searchsorted(reached + BOXED_PER_PORTION, side="right"))
        rows = np.arange(first, max(last, first + 1))
        pairs = _near(rows, low[rows], high[rows], gates, order, sorted_y)
        square = _squared_distances(mean, spread, contacts, pairs)
        inside = square < GATE_SIZE**2
        pairs, square = pairs.keep(inside), square[inside]
        kept = nearest_in_gates(pairs.track, square)
        found.append(pairs.track[kept])
        columns.append(pairs.contact[kept])
        squares.append(square[kept])
        first = int(rows[-1]) + 1
    if not found:
        nothing = np.zeros(0, dtype=np.intp)
        return GatePairs(nothing, nothing)
    pairs = GatePairs(np.concatenate(found), np.concatenate(columns))
    return pairs.keep(few_enough(pairs.track, np.concatenate(squares), tracks.confirmed))


def ascending_rows(values: FloatArray) -> IndexArray:
    """Return the rows of values in ascending order, equal ones in that of their rows.

    Parameters
    ----------
    values : ndarray, shape (n,)
        In any unit.

    Returns
    -------
    ndarray of int, shape (n,)
        Rows.
    """
    # Several times as fast as a stable sort, and the same where no two values are equal.
    order = values.argsort()
    ascending = values.take(order)
    if (ascending[1:] == ascending[:-1]).any():
        return values.argsort(kind="stable")
    return order


def _boxed(
    gates: TrackGates, sorted_x: FloatArray, confirmed: BoolArray
) -> tuple[IndexArray, IndexArray]:
    """Return which of the contacts sorted by x lie in the box of each gate: from, to."""
    centre = gates.centre[:, 0]
    half_x = BOX_SIZE * np.sqrt(gates.covariance[:, 0, 0])
    low = sorted_x.searchsorted(centre - half_x)
    high = sorted_x.searchsorted(centre + half_x)
    half = half_widths(high - low, confirmed)
    middle = sorted_x.searchsorted(centre)
    return np.maximum(low, middle - half), np.minimum(high, middle + half)


def _near_of_few(gates: TrackGates, order: IndexArray, contacts: PlacedContacts) -> GatePairs:
    """Return the same as the boxes, by looking at each contact in each gate."""
    x, y = contacts.position[order].T
    near = np.abs(x - gates.centre[:, :1]) < BOX_SIZE * np.sqrt(gates.covariance[:, 0, :1])
    near &= np.abs(y - gates.centre[:, 1:]) < BOX_SIZE * np.sqrt(gates.covariance[:, 1, 1:])
    track, column = near.nonzero()
    return GatePairs(track, order[column])


def _near(
    rows: IndexArray,
    low: IndexArray,
    high: IndexArray,
    gates: TrackGates,
    order: IndexArray,
    sorted_y: FloatArray,
) -> GatePairs:
    """Return pairs in the box around each gate."""
    counts = high - low
    local = np.arange(len(rows)).repeat(counts)
    place = np.arange(len(local)) + (low - (counts.cumsum() - counts)).repeat(counts)
    half_y = BOX_SIZE * np.sqrt(gates.covariance[rows, 1, 1])
    offset = np.abs(sorted_y.take(place) - gates.centre[rows, 1].repeat(counts))
    near = (offset < half_y.repeat(counts)).nonzero()[0]
    return GatePairs(rows.take(local.take(near)), order.take(place.take(near)))


def _squared_distances(
    mean: FloatArray, spread: FloatArray, contacts: PlacedContacts, pairs: GatePairs
) -> FloatArray:
    """Return nu^T S^-1 nu of each pair."""
    delay = contacts.delay.take(pairs.contact)
    state = mean.take(pairs.track, axis=0)
    innovation = contacts.position.take(pairs.contact, axis=0) - state[:, :2]
    innovation -= delay[:, None] * state[:, 2:]
    covariance = delayed_position_covariance(spread.take(pairs.track, axis=0), delay)
    covariance = covariance + contacts.covariance.take(pairs.contact, axis=0)
    x, y = innovation[:, 0], innovation[:, 1]
    square = covariance[:, 1, 1] * x**2 - 2.0 * covariance[:, 0, 1] * x * y
    return np.asarray((square + covariance[:, 0, 0] * y**2) / determinant(covariance))
