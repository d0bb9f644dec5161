"""Tracking bound: the smallest mean square error of a bearing tracker on a known scenario.

Riccati recursion of a Kalman filter with one angle-and-rate state a target that is given, at every
sample time, measurements as informative as the array data can be: the Fisher information of all
bearings, taken at the true bearings. Unlike the information in a Kalman filter of single targets it
couples the targets, and it may be singular where two bearings cross.

References
----------
Tichavsky, Muravchik, Nehorai, "Posterior Cramer-Rao bounds for discrete-time nonlinear filtering",
IEEE Trans. Signal Processing 46(5), 1998, for linear motion and known true path.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray


def tracking_bound(
    information: FloatArray,
    transition: FloatArray,
    process_noise: FloatArray,
    initial_covariance: FloatArray,
) -> FloatArray:
    """Bound on the variance of every filtered bearing at every sample time.

    Parameters
    ----------
    information : ndarray, shape (n_times, n_targets, n_targets)
        Fisher information of the bearings from the data of each sample time, rad^-2.
    transition : ndarray, shape (2, 2)
        Of angle and rate over one sample period; pure numbers, s.
    process_noise : ndarray, shape (2, 2)
        Of angle and rate over one sample period, rad^2, rad^2/s, rad^2/s^2.
    initial_covariance : ndarray, shape (2, 2)
        Of angle and rate one sample period before the first information, units as above.

    Returns
    -------
    ndarray, shape (n_times, n_targets)
        rad^2.
    """
    n_targets = information.shape[-1]
    each_target = np.eye(n_targets)
    all_transitions = np.kron(each_target, transition)
    all_noise = np.kron(each_target, process_noise)
    measured = np.kron(each_target, [[1.0, 0.0]])
    covariance = np.kron(each_target, initial_covariance)
    variances = np.empty(information.shape[:2])
    for step, fisher in enumerate(information):
        predicted = all_transitions @ covariance @ all_transitions.T + all_noise
        # Information form of the update that never inverts the information: it may be singular.
        angles = predicted @ measured.T
        gain = np.linalg.solve(each_target + fisher @ measured @ angles, fisher @ angles.T)
        updated = predicted - angles @ gain
        covariance = (updated + updated.T) / 2
        variances[step] = np.diagonal(measured @ covariance @ measured.T)
    return variances
