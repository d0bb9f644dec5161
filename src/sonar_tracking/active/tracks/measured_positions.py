"""What an update of a track measured, as one position: for whoever fuses it with something else.

With the position x- of covariance M before the update and x+ of covariance N after it, one
measurement z of covariance R does the same,

    R^-1 = N^-1 - M^-1,    R^-1 z = N^-1 x+ - M^-1 x-.

Before and after are those of one motion, the mixture over the modes. Contacts of which several may
be the target's make N larger: in a direction in which N is larger than M nothing was measured.

References
----------
Bar-Shalom, Li, Kirubarajan (2001), section 8.2 (information form); Musicki, La Scala (2008) for the
update.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.pair_updates import mix_updates, update_pairs
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.records.arrays import FloatArray, IndexArray

LEAST_DETECTED = 0.01
"""Probability that any contact is the track's, below which nothing was measured."""

LEAST_INFORMATION = 1e-10
"""In a direction, 1/m^2: nothing was measured there, and nothing can divide by it."""


def measured_positions(
    predicted: TrackBank,
    contacts: PlacedContacts,
    pairs: GatePairs,
    probability: FloatArray,
    rows: IndexArray,
) -> tuple[FloatArray, FloatArray]:
    """Return what a ping measured of some tracks.

    Parameters
    ----------
    predicted : TrackBank
        All tracks, at the stamp of the ping.
    contacts : PlacedContacts
        Of the ping.
    pairs : GatePairs
        Who may belong to whom.
    probability : ndarray, shape (n_pairs,)
        That a contact is the track's, whatever the mode.
    rows : ndarray of int, shape (n,)
        Which tracks, ascending.

    Returns
    -------
    position : ndarray, shape (n, 2)
        At the stamp of the ping, m; NaN = nothing was measured.
    covariance : ndarray, shape (n, 2, 2)
        m^2.
    """
    place = np.full(len(predicted), -1)
    place[rows] = np.arange(len(rows))
    own = place[pairs.track] >= 0
    ours = GatePairs(place[pairs.track[own]], pairs.contact[own])
    before = _of_one_motion(predicted.select(rows))
    updates = update_pairs(before, contacts, ours)
    weights = probability[own]
    after = mix_updates(before, ours, updates, weights[:, None])
    detected = np.bincount(ours.track, weights, len(rows)) >= LEAST_DETECTED
    position, covariance = np.full((len(rows), 2), np.nan), np.full((len(rows), 2, 2), np.nan)
    position[detected], covariance[detected] = _difference(
        before.select(detected), after.select(detected)
    )
    return position, covariance


def _of_one_motion(bank: TrackBank) -> TrackBank:
    mean, covariance = bank.moments()
    alone = bank.in_mode(0)
    return replace(alone, mean=mean[:, None], covariance=covariance[:, None])


def _difference(before: TrackBank, after: TrackBank) -> tuple[FloatArray, FloatArray]:
    """Return the measurement that leads from one to the other."""
    prior, posterior = before.mean[:, 0, :2], after.mean[:, 0, :2]
    known = np.linalg.inv(after.covariance[:, 0, :2, :2])
    gained = known - np.linalg.inv(before.covariance[:, 0, :2, :2])
    values, vectors = np.linalg.eigh(symmetrised(gained))
    told = values > LEAST_INFORMATION
    variance = 1.0 / np.where(told, values, LEAST_INFORMATION)
    covariance = (vectors * variance[:, None, :]) @ vectors.swapaxes(-1, -2)
    change = np.einsum("nij,nj->ni", known, posterior - prior)
    along = np.einsum("nji,nj->ni", vectors, change)
    moved = np.einsum("nij,nj->ni", vectors, np.where(told, variance * along, 0.0))
    return prior + moved, symmetrised(covariance)
