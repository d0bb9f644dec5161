"""Whose a new track with echoes is: of a target whose echoes were lost, or of a new one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.target_filters import TargetFilters
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.stations.station_association import FREE, associate

ANY_SPEED = 10.0
"""Deviation of each component of the velocity of a target of which nothing is known, m/s."""


@dataclass(frozen=True)
class Met:
    """Whose a new track may be.

    Attributes
    ----------
    target : FusedTarget or None
        Of which target it is, or may be; None = it is a new one.
    sure : bool
        Whether it is of that target; if not, it may be of a new one just as well.
    """

    target: FusedTarget | None
    sure: bool = True


def met_targets(
    state: FloatArray,
    covariance: FloatArray,
    lost: Sequence[FusedTarget],
    filters: TargetFilters,
    configuration: TrackFusionConfiguration,
) -> list[Met]:
    """Return the target of each new track.

    Parameters
    ----------
    state, covariance : ndarray, shapes (n, 4) and (n, 4, 4)
        Of the new tracks, m and m/s; m^2, m^2/s, m^2/s^2.
    lost : sequence of FusedTarget
        Targets without a track in this list.
    filters : TargetFilters
        Of all targets.
    configuration : TrackFusionConfiguration
        Odds and the area in which tracks begin.
    """
    if not lost:
        return [Met(None)] * len(state)
    seen = filters.picture()
    rows = [filters.targets.index(one) for one in lost]
    odds = log_odds_of_one_target(
        state,
        covariance,
        seen.mean[rows, :4],
        seen.covariance[rows, :4, :4],
        configuration.clutter_area,
    )
    needed = np.log(configuration.association_odds * len(lost))
    chosen = associate(odds + needed, 1.0)
    return [
        Met(None) if row == FREE else Met(lost[row], bool(odds[row, column] >= needed))
        for column, row in enumerate(chosen)
    ]


def log_odds_of_one_target(
    state: FloatArray,
    covariance: FloatArray,
    known: FloatArray,
    known_covariance: FloatArray,
    area: float,
) -> FloatArray:
    """Return how much likelier tracks are of known targets than of new ones.

    Parameters
    ----------
    state, covariance : ndarray, shapes (n, 4) and (n, 4, 4)
        Of the tracks, m and m/s; m^2, m^2/s, m^2/s^2.
    known, known_covariance : ndarray, shapes (n_known, 4) and (n_known, 4, 4)
        Of the targets, the same units.
    area : float
        In which a new one may be anywhere, m^2.

    Returns
    -------
    ndarray, shape (n_known, n)
        Logs, pure numbers.
    """
    apart = state[None] - known[:, None]
    spread = covariance[None] + known_covariance[:, None]
    solved = np.linalg.solve(spread, apart[..., None])[..., 0]
    square = np.sum(apart * solved, axis=-1)
    together = -0.5 * (square + np.linalg.slogdet(spread)[1]) - 2.0 * np.log(2.0 * np.pi)
    velocity = covariance[:, 2:, 2:] + ANY_SPEED**2 * np.eye(2)
    solved = np.linalg.solve(velocity, state[:, 2:, None])[..., 0]
    square = np.sum(state[:, 2:] * solved, axis=-1)
    alone = -0.5 * (square + np.linalg.slogdet(velocity)[1]) - np.log(2.0 * np.pi)
    return np.asarray(together - (alone - np.log(area)))
