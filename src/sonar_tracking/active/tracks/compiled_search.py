"""The search for contacts in gates, compiled; None where no compiler was."""

from __future__ import annotations

from types import ModuleType

import numpy as np

from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.active.tracks.contact_gating import SMALLEST_SHARE, GatePairs
from sonar_tracking.active.tracks.pair_limits import CONTACTS_IN_GATE, nearest_in_gates
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.searched_tables import GatedTracks, SearchedContacts
from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray, IntArray

COMPILED = compiled_module("active.tracks.compiled_gates")
"""The compiled search, None where there is none."""


def search_compiled(
    module: ModuleType, tracks: GatedTracks, contacts: SearchedContacts, box_size: float
) -> GatePairs:
    """Return the contacts in all gates that pass the thresholds, the nearest ones of a crowd.

    Parameters
    ----------
    module : module
        :data:`COMPILED`.
    tracks : GatedTracks
        Not too many to be looked at with all of their contacts.
    contacts : SearchedContacts
        Of the same scenes.
    box_size : float
        Half of the box around a gate that is looked at, in standard deviations.
    """
    pairs, squares, crowded = in_gates(module, tracks, contacts, box_size)
    if not crowded:
        return pairs
    pairs = pairs.keep(nearest_in_gates(pairs.track, squares))
    weak = contacts.amplitude.take(pairs.contact) < tracks.threshold.take(pairs.track)
    return pairs.keep(~weak)


def in_gates(
    module: ModuleType, tracks: GatedTracks, contacts: SearchedContacts, box_size: float
) -> tuple[GatePairs, FloatArray, bool]:
    """Return the contacts in all gates that pass the thresholds; in a crowd weak ones, too.

    Parameters
    ----------
    module : module
        :data:`COMPILED`.
    tracks : GatedTracks
        Not too many to be looked at with all of their contacts.
    contacts : SearchedContacts
        Of the same scenes.
    box_size : float
        Half of the box around a gate that is looked at, in standard deviations.

    Returns
    -------
    pairs : GatePairs
        Of tracks and contacts.
    squares : ndarray, shape (n_pairs,)
        nu^T S^-1 nu, pure numbers (variances).
    crowded : bool
        Whether there is a crowd.
    """
    centre, covariance = tracks.gates.centre, tracks.gates.covariance
    half_x = box_size * np.sqrt(covariance[:, 0, 0])
    placed = contacts.placed
    columns = (
        centre[:, 0] - half_x,
        centre[:, 0] + half_x,
        centre[:, 1],
        box_size * np.sqrt(covariance[:, 1, 1]),
        tracks.mean,
        tracks.spread,
        tracks.threshold,
        placed.position,
        placed.covariance,
        placed.delay,
        contacts.amplitude,
    )
    found_tracks, found_contacts, squares, crowded = module.search(
        (
            _ends(tracks.scenes),
            _ends(contacts.scenes),
            *(np.ascontiguousarray(column) for column in (*contacts.by_x(), *columns)),
        ),
        (len(tracks), len(contacts), len(tracks.scenes.counts), tracks.spread.shape[-1]),
        GATE_SIZE**2,
        SMALLEST_SHARE,
        CONTACTS_IN_GATE[0],
    )
    pairs = GatePairs(
        np.frombuffer(found_tracks, dtype=np.int64), np.frombuffer(found_contacts, dtype=np.int64)
    )
    return pairs, np.frombuffer(squares, dtype=np.float64), crowded


def _ends(rows: SceneRows) -> IntArray:
    return np.cumsum(rows.counts, dtype=np.int64)
