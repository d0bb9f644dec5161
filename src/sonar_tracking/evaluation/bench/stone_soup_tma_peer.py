"""One target located from bearings by filters of Stone Soup: peers of the bench on scene S1.

Extended, unscented and particle filter begin with the prior of the product's single filters: the
first bearing, and a range of which nothing else is known. They take bearings only, since Stone Soup
has no measurement model of tonals. Needs Stone Soup installed.

References
----------
Stone Soup 1.9, https://stonesoup.readthedocs.io; Cheong (2011), scene S1.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta, timezone
from typing import Any

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration

EXTENDED, UNSCENTED, PARTICLE = "EKF", "UKF", "particle filter"
KINDS = (EXTENDED, UNSCENTED, PARTICLE)
PARTICLES = 2000

_ORDER = (0, 2, 1, 3)
"""Of x, y, vx, vy in a state x, vx, y, vy."""

_EPOCH = datetime(2026, 1, 1, tzinfo=timezone.utc)


def stone_soup_path(
    frames: Sequence[TmaMeasurement], kind: str, acceleration: float, interval: float
) -> FloatArray:
    """Return where a filter of Stone Soup finds the target after each frame.

    Parameters
    ----------
    frames : sequence of TmaMeasurement
        Of one run (batch of one), in order.
    kind : str
        One of ``KINDS``.
    acceleration : float
        Standard deviation from frame to frame, m/s^2.
    interval : float
        Between frames, s.

    Returns
    -------
    ndarray, shape (n_frames, 4)
        x, y, vx, vy, m and m/s.
    """
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis

    state, predictor, updater = _filter(frames[0], kind, acceleration**2 * interval)
    path = [_mean(state)]
    for number, frame in enumerate(frames[1:], start=1):
        instant = _EPOCH + timedelta(seconds=number * interval)
        detection = Detection(
            [[float(frame.azimuth.reshape(-1)[0])]],
            timestamp=instant,
            measurement_model=_bearing_model(frame),
        )
        prediction = predictor.predict(state, timestamp=instant)
        state = updater.update(SingleHypothesis(prediction, detection))
        path.append(_mean(state))
    return np.array(path)


def _bearing_model(frame: TmaMeasurement) -> Any:
    from stonesoup.models.measurement.nonlinear import Cartesian2DToBearing

    return Cartesian2DToBearing(
        ndim_state=4,
        mapping=(0, 2),
        noise_covar=np.array([[float(np.reshape(frame.azimuth_variance, -1)[0])]]),
        translation_offset=np.reshape(frame.position, (-1, 2))[0][:, None],
    )


def _filter(first: TmaMeasurement, kind: str, density: float) -> tuple[Any, Any, Any]:
    """Return prior, predictor and updater."""
    from stonesoup.models.transition.linear import (
        CombinedLinearGaussianTransitionModel,
        ConstantVelocity,
    )
    from stonesoup.predictor.kalman import ExtendedKalmanPredictor, UnscentedKalmanPredictor
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import ExtendedKalmanUpdater, UnscentedKalmanUpdater

    motion = CombinedLinearGaussianTransitionModel([ConstantVelocity(density)] * 2)
    bank = SingleFilterConfiguration().start(first)
    mean = bank.mean.reshape(-1, bank.mean.shape[-1])[0, list(_ORDER)]
    covariance = bank.covariance.reshape(-1, *bank.covariance.shape[-2:])[0]
    covariance = covariance[np.ix_(_ORDER, _ORDER)]
    if kind == PARTICLE:
        return _particle_filter(mean, covariance, motion)
    prior = GaussianState(mean[:, None], covariance, timestamp=_EPOCH)
    if kind == EXTENDED:
        return prior, ExtendedKalmanPredictor(motion), ExtendedKalmanUpdater(None)
    return prior, UnscentedKalmanPredictor(motion), UnscentedKalmanUpdater(None)


def _particle_filter(mean: FloatArray, covariance: FloatArray, motion: Any) -> tuple[Any, Any, Any]:
    from stonesoup.predictor.particle import ParticlePredictor
    from stonesoup.resampler.particle import ESSResampler
    from stonesoup.types.array import StateVectors
    from stonesoup.types.state import ParticleState
    from stonesoup.updater.particle import ParticleUpdater

    drawn = np.random.default_rng(0).multivariate_normal(mean, covariance, PARTICLES)
    weight = np.full(PARTICLES, 1.0 / PARTICLES)
    prior = ParticleState(StateVectors(drawn.T), weight=weight, timestamp=_EPOCH)
    return prior, ParticlePredictor(motion), ParticleUpdater(None, ESSResampler())


def _mean(state: Any) -> FloatArray:
    return np.asarray(np.ravel(state.mean), dtype=np.float64)[[0, 2, 1, 3]]
