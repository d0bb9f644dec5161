"""All tracks, candidates and confirmed alike, as arrays: one row a track.

Each track is a mixture of one Gaussian a motion mode (interacting multiple models); with one mode
it is a plain Kalman track. All are predicted together, since a Python loop over the candidates
that clutter starts would cost more than the arithmetic.

References
----------
Blom, Bar-Shalom (1988).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from sonar_tracking.active.detection.detection_levels import LEVELS, averaged
from sonar_tracking.active.tracks.mode_changes import changes_after, pooled_changes
from sonar_tracking.active.tracks.mode_prediction import mixed_states, moved_states
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.filtering.few_terms import sum_of_few
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray

PRIOR_TRACKS = 4.0
"""Confirmed tracks that the prior of the modes counts as much as."""


@dataclass(frozen=True)
class TrackBank:
    """State of all tracks.

    Attributes
    ----------
    id : ndarray of int, shape (n,)
        Ascending: older tracks first.
    existence : ndarray, shape (n,)
        Probability that there is a target.
    confirmed : ndarray of bool, shape (n,)
        False = candidate.
    initiated, updated : ndarray of int, shape (n,)
        Stamps of the first and the last contact, ns.
    mean : ndarray, shape (n, n_modes, 4)
        x, y, vx, vy in each mode, m and m/s.
    covariance : ndarray, shape (n, n_modes, 4, 4)
        In each mode, m^2, m^2/s, m^2/s^2.
    mode_probability : ndarray, shape (n, n_modes)
        Probabilities, sum 1.
    detection_weight : ndarray, shape (n, n_levels)
        Probabilities of the levels of P_D in
        :mod:`sonar_tracking.active.detection.detection_levels`, sum 1.
    entered, calm : ndarray, shape (n, n_modes)
        How often each mode or a harder one has been entered before the last ping, pure numbers,
        and time in calmer ones, s; see :mod:`sonar_tracking.active.tracks.mode_changes`.
    shown : ndarray of bool, shape (n, n_modes)
        Whether the target was in that mode or a harder one.
    """

    id: IntArray
    existence: FloatArray
    confirmed: BoolArray
    initiated: IntArray
    updated: IntArray
    mean: FloatArray
    covariance: FloatArray
    mode_probability: FloatArray
    detection_weight: FloatArray
    entered: FloatArray
    calm: FloatArray
    shown: BoolArray

    def __len__(self) -> int:
        return len(self.id)

    def select(self, rows: BoolArray | IntArray | slice) -> TrackBank:
        """Return some of the tracks, by a mask, shape (n,), or by their rows, shape (n_kept,)."""
        if isinstance(rows, slice):
            return TrackBank(*[getattr(self, name)[rows] for name in COLUMNS])
        if rows.dtype == np.bool_:
            rows = rows.nonzero()[0]
        # Several times as fast as an index.
        return TrackBank(*[getattr(self, name).take(rows, axis=0) for name in COLUMNS])

    def append(self, other: TrackBank) -> TrackBank:
        """Return the tracks with others after them."""
        return TrackBank(
            *[np.concatenate((getattr(self, name), getattr(other, name))) for name in COLUMNS]
        )

    def contact_probabilities(self, track: IndexArray, weights: FloatArray) -> FloatArray:
        """Return the probability that each contact in a gate is its track's, over all modes.

        Parameters
        ----------
        track : ndarray of int, shape (n_pairs,)
            Row of the track of each pair.
        weights : ndarray, shape (n_pairs, n_modes)
            Probabilities of association in each mode.

        Returns
        -------
        ndarray, shape (n_pairs,)
            Probabilities.
        """
        return sum_of_few(self.mode_probability[track] * weights, axis=1)

    def moments(self) -> tuple[FloatArray, FloatArray]:
        """Return mean and covariance of the mixture over the modes.

        Returns
        -------
        mean : ndarray, shape (n, 4)
            m and m/s.
        covariance : ndarray, shape (n, 4, 4)
            m^2, m^2/s, m^2/s^2.
        """
        return self._moments

    def position_moments(self) -> tuple[FloatArray, FloatArray]:
        """Return the same with the covariance of the position alone, which is less to compute.

        Returns
        -------
        mean : ndarray, shape (n, 4)
            m and m/s.
        covariance : ndarray, shape (n, 2, 2)
            m^2.
        """
        return self._position_moments

    def moments_of(self, rows: IndexArray) -> tuple[FloatArray, FloatArray]:
        """Return the moments of some of the tracks, by their rows, shape (n_kept,).

        Returns
        -------
        mean : ndarray, shape (n_kept, 4)
            m and m/s.
        covariance : ndarray, shape (n_kept, 4, 4)
            m^2, m^2/s, m^2/s^2.
        """
        if "_moments" in vars(self):
            mean, covariance = self._moments
            return mean.take(rows, axis=0), covariance.take(rows, axis=0)
        columns = (self.mode_probability, self.mean, self.covariance)
        return _mixture(*[column.take(rows, axis=0) for column in columns])

    def remember_moments(self, before: TrackBank, changed: IndexArray) -> None:
        """Take the moments of the position over from the same tracks before an update.

        Parameters
        ----------
        before : TrackBank
            The tracks before it.
        changed : ndarray of int, shape (n_changed,)
            Rows of the tracks whose states it has changed: theirs are computed.
        """
        if self.mean.shape[1] == 1:
            return
        mean, covariance = (each.copy() for each in before.position_moments())
        columns = (self.mode_probability, self.mean, self.covariance)
        mean[changed], covariance[changed] = _position_mixture(
            *[column.take(changed, axis=0) for column in columns]
        )
        vars(self)["_position_moments"] = mean, covariance

    def in_mode(self, mode: int) -> TrackBank:
        """Return the tracks as they are if their motion is that of one mode for sure."""
        only = slice(mode, mode + 1)
        return replace(
            self,
            mean=self.mean[:, only],
            covariance=self.covariance[:, only],
            mode_probability=np.ones((len(self), 1)),
            entered=self.entered[:, only],
            calm=self.calm[:, only],
            shown=self.shown[:, only],
        )

    @cached_property
    def _moments(self) -> tuple[FloatArray, FloatArray]:
        return _mixture(self.mode_probability, self.mean, self.covariance)

    @cached_property
    def _position_moments(self) -> tuple[FloatArray, FloatArray]:
        if "_moments" in vars(self):
            mean, covariance = self._moments
            return mean, covariance[:, :2, :2]
        return _position_mixture(self.mode_probability, self.mean, self.covariance)


def _mixture(
    weight: FloatArray, means: FloatArray, covariances: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean, shape (n, 4), and covariance of as many components as are given."""
    if means.shape[1] == 1:
        return means[:, 0], covariances[:, 0]
    mean = sum_of_few(weight[..., None] * means, axis=1)
    deviation = means - mean[:, None]
    # In place: of many tracks, reading and writing takes longer than the arithmetic.
    spread = deviation[..., :, None] * deviation[..., None, :]
    spread += covariances
    spread *= weight[..., None, None]
    return mean, sum_of_few(spread, axis=1)


def _position_mixture(
    weight: FloatArray, means: FloatArray, covariances: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the same mean, and the covariance of x and y, one entry after the other."""
    if means.shape[1] == 1:
        return means[:, 0], covariances[:, 0, :2, :2]
    mean = sum_of_few(weight[..., None] * means, axis=1)
    away = [means[..., axis] - mean[:, None, axis] for axis in (0, 1)]
    covariance = np.empty((len(mean), 2, 2))
    for row, column in ((0, 0), (0, 1), (1, 1)):
        spread = away[row] * away[column]
        spread += covariances[..., row, column]
        spread *= weight
        covariance[:, row, column] = covariance[:, column, row] = sum_of_few(spread, axis=1)
    return mean, covariance


COLUMNS = tuple(field.name for field in fields(TrackBank))
"""Of the bank, in the order of its constructor."""


def empty_bank(n_modes: int) -> TrackBank:
    """Return a bank without tracks."""
    return TrackBank(
        id=np.zeros(0, dtype=np.int64),
        existence=np.zeros(0),
        confirmed=np.zeros(0, dtype=bool),
        initiated=np.zeros(0, dtype=np.int64),
        updated=np.zeros(0, dtype=np.int64),
        mean=np.zeros((0, n_modes, 4)),
        covariance=np.zeros((0, n_modes, 4, 4)),
        mode_probability=np.zeros((0, n_modes)),
        detection_weight=np.zeros((0, len(LEVELS))),
        entered=np.zeros((0, n_modes)),
        calm=np.zeros((0, n_modes)),
        shown=np.zeros((0, n_modes), dtype=bool),
    )


def predict_bank(
    bank: TrackBank,
    modes: MotionModel,
    interval: float,
    survival_probability: float,
    pooled: FloatArray | None = None,
) -> TrackBank:
    """Return all tracks after an interval: modes mixed, each predicted by its own model.

    Parameters
    ----------
    bank : TrackBank
        At the ping before.
    modes : MotionModel
        Motion model.
    interval : float
        s.
    survival_probability : float
        Pi_11 of the existence recursion.
    pooled : ndarray, shape (2, n_modes) or (n, 2, n_modes), or None
        Changes of mode in the scene of each track, pure numbers and s; None = one scene.
    """
    if pooled is None:
        pooled = scene_changes(bank)
    entered, calm, shown = changes_after(
        bank.mode_probability, bank.entered, bank.calm, bank.shown, interval, modes.static_mode
    )
    transition = modes.transition(interval, entered, calm, pooled)
    mixed, spread, probability = _mix(bank, transition)
    velocity = mixed[..., 2:]
    mean, covariance = moved_states(modes.matrices(velocity, interval), mixed, spread)
    covariance += modes.noise(velocity, interval)
    return replace(
        bank,
        existence=survival_probability * bank.existence,
        mean=mean,
        covariance=covariance,
        mode_probability=probability,
        entered=entered,
        calm=calm,
        shown=shown,
    )


def scene_changes(bank: TrackBank) -> FloatArray:
    """Return how often the targets of one scene have begun to manoeuvre, and in which time.

    Parameters
    ----------
    bank : TrackBank
        All tracks of the scene.

    Returns
    -------
    ndarray, shape (2, n_modes)
        Pure numbers and s; see :mod:`sonar_tracking.active.tracks.mode_changes`.
    """
    return pooled_changes(bank.entered, bank.calm, bank.confirmed)


def new_target_modes(bank: TrackBank, modes: MotionModel) -> FloatArray:
    """Return the mode probabilities of a new target: the prior, and what the confirmed ones do.

    Where a wharf has been seen, what appears there is rather fixed.

    Parameters
    ----------
    bank : TrackBank
        After the ping before.
    modes : MotionModel
        Motion model.

    Returns
    -------
    ndarray, shape (n_modes,)
        Probabilities.
    """
    return averaged(modes.mode_prior, PRIOR_TRACKS, bank.mode_probability[bank.confirmed])


def _mix(bank: TrackBank, transition: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    if transition.shape[-1] == 1:
        return bank.mean, bank.covariance, bank.mode_probability
    joint = bank.mode_probability[:, :, None] * transition
    probability = sum_of_few(joint, axis=1)
    weight = (joint / probability[:, None, :]).swapaxes(1, 2)
    mean, spread = mixed_states(weight, bank.mean, bank.covariance)
    return mean, spread, probability
