"""Which contacts lie in the gates of which tracks.

Pairs are found through the contacts sorted by x and tracks in portions, so that memory stays
bounded. ``compiled_gates`` does the same without lists of all that is looked at, and is there if a
compiler was when the package was installed; the bits are those of the coding in numpy.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.active.tracks.compiled_search import COMPILED, search_compiled
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
from sonar_tracking.active.tracks.scene_rows import SceneRows, joined
from sonar_tracking.active.tracks.searched_tables import (
    GatedTracks,
    SearchedContacts,
    ascending_rows,
)
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

BOXED_PER_PORTION = 500_000
"""Contacts in boxes around gates that are looked at together; bounds the memory."""

COMPARED_AT_ONCE = 3000
"""Up to so many of tracks times contacts no search is faster than comparing all."""

BOX_SIZE = 1.5 * GATE_SIZE
"""Half of a box, in standard deviations: a gate at a contact may be wider by its noise."""

NOTHING = np.zeros(0, dtype=np.intp)


def find_pairs(
    bank: TrackBank,
    gates: TrackGates,
    contacts: PlacedContacts,
    amplitudes: FloatArray | None = None,
    thresholds: FloatArray | None = None,
    scenes: tuple[SceneRows, SceneRows] | None = None,
) -> GatePairs:
    """Return all pairs of a track and a contact in its gate, the nearest ones of a crowd.

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
    scenes : tuple of SceneRows, optional
        Whose the tracks and whose the contacts are: pairs are of one scene. All of one if not
        given.
    """
    n_contacts = len(contacts.distance)
    of_tracks, of_contacts = scenes or (SceneRows((len(bank),)), SceneRows((n_contacts,)))
    moments = bank.moments() if contacts.delay.any() else bank.position_moments()
    tracks = GatedTracks(
        *moments,
        gates,
        bank.confirmed,
        np.full(len(bank), np.nan) if thresholds is None else thresholds,
        of_tracks,
    )
    searched = SearchedContacts(
        contacts, np.full(n_contacts, np.nan) if amplitudes is None else amplitudes, of_contacts
    )
    limited = _limited(tracks, searched)
    if COMPILED is not None and not limited:
        return search_compiled(COMPILED, tracks, searched, BOX_SIZE)
    if of_tracks.single or not limited:
        return _pairs_of_strong(tracks, searched)
    rows = zip(of_tracks.slices, of_contacts.slices, strict=True)
    parts = [
        _pairs_of_strong(
            tracks.select(np.arange(own.start, own.stop)),
            searched.select(np.arange(heard.start, heard.stop)),
        )
        for own, heard in rows
    ]
    return pairs_of_scenes(parts, of_tracks, of_contacts)


def _limited(tracks: GatedTracks, contacts: SearchedContacts) -> bool:
    """Return whether there may be more pairs than are looked at."""
    counts = zip(tracks.scenes.counts, contacts.scenes.counts, strict=True)
    compared = sum(n_tracks * n_contacts for n_tracks, n_contacts in counts)
    most = max(tracks.scenes.counts) * CONTACTS_IN_GATE[0]
    return compared > MAXIMUM_BOXED or most > MAXIMUM_PAIRS


def _pairs_of_strong(tracks: GatedTracks, contacts: SearchedContacts) -> GatePairs:
    """Return the pairs, looked for among strong contacts first.

    Most tracks are candidates, and these have one threshold: where it is above most contacts, as
    in a survey that reports nearly everything, only those with a strong contact are looked at.
    """
    highest = [np.max(own, initial=-np.inf) for own in tracks.scenes.split(tracks.threshold)]
    strong = np.flatnonzero(~(contacts.amplitude < contacts.scenes.spread(highest)))
    if (
        _limited(tracks, contacts)
        or _compared_at_once(tracks, contacts)
        or 2 * len(strong) > len(contacts)
    ):
        return _pairs_in_gates(tracks, contacts)
    strict = ~(tracks.threshold < tracks.scenes.spread(highest))
    rows = np.flatnonzero(strict)
    strict[rows[_pairs_in_gates(tracks.select(rows), contacts.select(strong)).track]] = False
    # In a crowd the weak ones count among the nearest, too.
    rows = np.flatnonzero(~strict)
    pairs = _pairs_in_gates(tracks.select(rows), contacts)
    return GatePairs(rows[pairs.track], pairs.contact)


def _compared_at_once(tracks: GatedTracks, contacts: SearchedContacts) -> bool:
    return tracks.scenes.single and len(tracks) * len(contacts) <= COMPARED_AT_ONCE


def _pairs_in_gates(tracks: GatedTracks, contacts: SearchedContacts) -> GatePairs:
    """Return the contacts in all gates that pass the thresholds."""
    limited = _limited(tracks, contacts)
    found, squares = [GatePairs(NOTHING, NOTHING)], [np.zeros(0)]
    for pairs in _near_in_portions(tracks, contacts):
        if not limited:
            pairs = _that_count(pairs, tracks, contacts)
        square = _squared_distances(tracks, contacts.placed, pairs)
        inside = square < GATE_SIZE**2
        pairs, square = pairs.keep(inside), square[inside]
        nearest = nearest_in_gates(pairs.track, square)
        found.append(pairs.keep(nearest))
        squares.append(square[nearest])
    pairs = GatePairs(joined([p.track for p in found]), joined([p.contact for p in found]))
    if limited:
        pairs = pairs.keep(few_enough(pairs.track, joined(squares), tracks.confirmed))
    return pairs.keep(~_weak(pairs, tracks, contacts))


def _weak(pairs: GatePairs, tracks: GatedTracks, contacts: SearchedContacts) -> BoolArray:
    """Return which contacts are below the threshold, shape (n_pairs,); unknown ones are not."""
    return np.asarray(contacts.amplitude.take(pairs.contact) < tracks.threshold.take(pairs.track))


def _that_count(pairs: GatePairs, tracks: GatedTracks, contacts: SearchedContacts) -> GatePairs:
    """Return the pairs, of all in boxes, that pass the threshold or count in a crowd."""
    weak = _weak(pairs, tracks, contacts)
    if not weak.any():
        return pairs
    crowded = np.bincount(pairs.track, minlength=len(tracks)) > CONTACTS_IN_GATE[0]
    return pairs.keep(~weak | crowded.take(pairs.track))


def _near_in_portions(tracks: GatedTracks, contacts: SearchedContacts) -> Iterator[GatePairs]:
    """Yield the pairs in the box around each gate, in portions of tracks."""
    if _compared_at_once(tracks, contacts):
        yield _near_of_few(tracks.gates, contacts.placed)
        return
    order, sorted_x, sorted_y = contacts.by_x()
    low, high = _boxed(tracks, contacts.scenes, sorted_x)
    before = (high - low).cumsum()
    first = 0
    while first < len(tracks):
        reached = before[first - 1] if first else 0
        last = int(before.searchsorted(reached + BOXED_PER_PORTION, side="right"))
        rows = np.arange(first, max(last, first + 1))
        yield _near(rows, low[rows], high[rows], tracks.gates, order, sorted_y)
        first = int(rows[-1]) + 1


def _boxed(
    tracks: GatedTracks, scenes: SceneRows, sorted_x: FloatArray
) -> tuple[IndexArray, IndexArray]:
    """Return which of the contacts, sorted by x in their scenes, are in each box: from, to."""
    gates = tracks.gates
    centre = gates.centre[:, 0]
    half_x = BOX_SIZE * np.sqrt(gates.covariance[:, 0, 0])
    of_scenes = list(zip(scenes.starts.tolist(), scenes.split(sorted_x), strict=True))

    def place(x: FloatArray) -> IndexArray:
        parts = zip(of_scenes, tracks.scenes.split(x), strict=True)
        return joined([first + own.searchsorted(sought) for (first, own), sought in parts])

    low, high = place(centre - half_x), place(centre + half_x)
    counts = high - low
    half = half_widths(counts, tracks.confirmed)
    if half is counts:
        return low, high
    middle = place(centre)
    return np.maximum(low, middle - half), np.minimum(high, middle + half)


def _near_of_few(gates: TrackGates, contacts: PlacedContacts) -> GatePairs:
    """Return the same as the boxes, by looking at each contact in each gate."""
    order = ascending_rows(contacts.position[:, 0])
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
    tracks: GatedTracks, contacts: PlacedContacts, pairs: GatePairs
) -> FloatArray:
    """Return nu^T S^-1 nu of each pair."""
    delay = contacts.delay.take(pairs.contact)
    state = tracks.mean.take(pairs.track, axis=0)
    innovation = contacts.position.take(pairs.contact, axis=0) - state[:, :2]
    if delay.any():
        innovation -= delay[:, None] * state[:, 2:]
    covariance = delayed_position_covariance(tracks.spread.take(pairs.track, axis=0), delay)
    covariance = covariance + contacts.covariance.take(pairs.contact, axis=0)
    x, y = innovation[:, 0], innovation[:, 1]
    square = covariance[:, 1, 1] * x**2 - 2.0 * covariance[:, 0, 1] * x * y
    return np.asarray((square + covariance[:, 0, 0] * y**2) / determinant(covariance))
