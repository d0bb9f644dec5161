"""Two accounts of an encounter: bearings that the array does not resolve pass, or turn back.

Where two bearings are too near to each other, one filter with enough process noise for a turn
forgets which is which while they cross, and one without takes those that turn back for others that
pass. So both accounts are followed while the array does not resolve a pair: with the steady process
noise of each bearing, and with that of turning back. Each is as probable as the blocks are under
its predictions. The more probable one is told, with a covariance that is that of both around it.
Once the pair is resolved again they are one account if they say the same of every bearing, or if
one of them is improbable; as long as they do not, names are open, and the covariance says so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import BoolArray, FloatArray

_TURNING_BACK = -3.0
"""Log-odds before there is any evidence: those that come near each other mostly pass."""

_DECIDED = 3.0
"""Log-odds from which on the less probable account is dropped: it is 1 in 20."""

_SAME = 9.0
"""Squared distance of two bearings, over their variances, up to which accounts say the same."""


@dataclass(frozen=True)
class Encounter:
    """The account of bearings that turn back, beside that of bearings that pass.

    Attributes
    ----------
    mean : ndarray, shape (..., 2 n)
        Angles and rates, rad and rad/s; where no encounter is open those of the other account.
    covariance : ndarray, shape (..., 2 n, 2 n)
        rad^2, rad^2/s, rad^2/s^2.
    log_odds : ndarray, shape (...)
        Of turning back over passing, pure numbers.
    open : ndarray of bool, shape (...)
        Whether there are two accounts.
    """

    mean: FloatArray
    covariance: FloatArray
    log_odds: FloatArray
    open: BoolArray

    @property
    def turned_back(self) -> BoolArray:
        """Whether the account of turning back is the more probable one, shape (...)."""
        return np.asarray(self.open & (self.log_odds > 0.0))

    def with_account(self, state: KalmanState, log_odds: FloatArray) -> Encounter:
        """Return it with the account of turning back at another instant.

        Parameters
        ----------
        state : KalmanState
            Joint state, shapes (..., 2 n) and (..., 2 n, 2 n), in rad and rad/s.
        log_odds : ndarray, shape (...)
            Pure numbers.
        """
        return replace(self, mean=state.mean, covariance=state.covariance, log_odds=log_odds)

    def told(self, passing: KalmanState) -> KalmanState:
        """Return what is told of the bearings: the more probable account, uncertain as both are.

        Parameters
        ----------
        passing : KalmanState
            Joint state of the account of passing, (..., 2 n) and (..., 2 n, 2 n), rad and rad/s.
        """
        if not self.open.any():
            return passing
        back = self.turned_back[..., None]
        mean = np.where(back, self.mean, passing.mean)
        share = 1.0 / (1.0 + np.exp(-np.clip(self.log_odds, -50.0, 50.0)))[..., None, None]
        both = share * _about(mean, self.mean, self.covariance)
        both = both + (1.0 - share) * _about(mean, passing.mean, passing.covariance)
        return KalmanState(mean, np.where(self.open[..., None, None], both, passing.covariance))

    def settled(self, passing: KalmanState, near: BoolArray) -> tuple[Encounter, KalmanState]:
        """Return it and the account of passing after what can be decided has been decided.

        Parameters
        ----------
        passing : KalmanState
            Joint state of the account of passing, (..., 2 n) and (..., 2 n, 2 n), rad and rad/s.
        near : ndarray of bool, shape (...)
            Whether the array does not resolve a pair.
        """
        begun = near & ~self.open
        over = self.open & ~near & (_same(passing, self) | (np.abs(self.log_odds) > _DECIDED))
        if not (begun | over).any():
            return self, passing
        back = (over & self.turned_back)[..., None]
        mean = np.where(back, self.mean, passing.mean)
        covariance = np.where(back[..., None], self.covariance, passing.covariance)
        one = begun | over
        encounter = Encounter(
            np.where(one[..., None], mean, self.mean),
            np.where(one[..., None, None], covariance, self.covariance),
            np.where(one, _TURNING_BACK, self.log_odds),
            (self.open | begun) & ~over,
        )
        return encounter, KalmanState(mean, covariance)


def no_encounter(state: KalmanState) -> Encounter:
    """Return that a joint state, shapes (..., 2 n) and (..., 2 n, 2 n), has one account only."""
    batch = state.mean.shape[:-1]
    return Encounter(
        state.mean,
        state.covariance,
        np.full(batch, _TURNING_BACK),
        np.zeros(batch, dtype=bool),
    )


def _about(centre: FloatArray, mean: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the second moments of an account about a centre."""
    apart = mean - centre
    return covariance + apart[..., :, None] * apart[..., None, :]


def _same(one: KalmanState, other: Encounter) -> BoolArray:
    """Return whether two accounts say the same of every bearing, shape (...)."""
    n_targets = one.mean.shape[-1] // 2
    angles = slice(0, n_targets)
    apart = (one.mean - other.mean)[..., angles] ** 2
    spread = np.diagonal(one.covariance + other.covariance, axis1=-2, axis2=-1)[..., angles]
    return np.asarray((apart <= _SAME * spread).all(axis=-1))
