"""Spectra of an array's beams: Hann frames, exact delays in the frequency domain.

A plane wave from theta reaches element m earlier than the origin of the array by
tau_m = (x_m sin theta + y_m cos theta) / c, so that bin f of its spectrum is turned back by
exp(-2 pi j f tau_m) and the elements are averaged: no approximation for any bandwidth. The bins
are evenly spaced, so that each factor is the product of one for a block of bins and one for the
place in it: few exponentials, and no sum of roundings.
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.records.arrays import ComplexArray, FloatArray


def element_spectra(frame: FloatArray, first_bin: int, last_bin: int) -> ComplexArray:
    """Return the spectra of the elements under a Hann window.

    Parameters
    ----------
    frame : ndarray, shape (n_samples, n_elements)
        Time series, linear amplitude; n_samples even.
    first_bin, last_bin : int
        Bins k / (n_samples / sample_rate) returned, the last one excluded.

    Returns
    -------
    ndarray, shape (last_bin - first_bin, n_elements), complex
        Linear amplitude, scaled so that white noise of variance 1 has the power 1.
    """
    n_samples = len(frame)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(n_samples) / n_samples)
    window /= np.sqrt(0.375 * n_samples)
    return np.asarray(np.fft.rfft(frame * window[:, None], axis=0)[first_bin:last_bin])


def beam_powers(
    spectra: ComplexArray,
    frequencies: FloatArray,
    element_positions: FloatArray,
    sound_speed: float,
    arrival_angles: FloatArray,
) -> FloatArray:
    """Return the power spectra of beams.

    Parameters
    ----------
    spectra : ndarray, shape (n_bins, n_elements), complex
        Of the elements, linear amplitude.
    frequencies : ndarray, shape (n_bins,)
        Of the bins, evenly spaced, Hz.
    element_positions : ndarray, shape (n_elements, 3)
        m.
    sound_speed : float
        m/s.
    arrival_angles : ndarray, shape (n_beams,)
        rad from broadside.

    Returns
    -------
    ndarray, shape (n_beams, n_bins)
        Linear: a wave from the direction of the beam has the power it has on one element.
    """
    n_bins, n_elements = spectra.shape
    block = max(math.isqrt(n_bins), 1)
    n_blocks = -(-n_bins // block)
    padded = np.zeros((n_blocks * block, n_elements), dtype=np.complex128)
    padded[:n_bins] = spectra
    blocks = padded.reshape(n_blocks, block, n_elements)
    step = frequencies[1] - frequencies[0] if n_bins > 1 else 0.0
    within = (step * np.arange(block))[:, None]
    powers = np.empty((len(arrival_angles), n_bins))
    for beam, angle in enumerate(arrival_angles):
        lead = element_positions[:, 0] * np.sin(angle) + element_positions[:, 1] * np.cos(angle)
        turn = -2j * np.pi / sound_speed * lead
        turned = blocks * np.exp(turn * within)
        sums = turned @ np.exp(turn * frequencies[::block, None])[:, :, None]
        powers[beam] = np.abs(sums.reshape(-1)[:n_bins] / n_elements) ** 2
    return powers


def strongest_power(
    spectrum: ComplexArray,
    frequency: float,
    element_positions: FloatArray,
    sound_speed: float,
) -> float:
    """Return the power of the strongest beam in any direction, for one bin.

    Parameters
    ----------
    spectrum : ndarray, shape (n_elements,), complex
        One bin of the elements' spectra, linear amplitude.
    frequency : float
        Hz.
    element_positions : ndarray, shape (n_elements, 3)
        m.
    sound_speed : float
        m/s.

    Returns
    -------
    float
        Linear.
    """
    n_elements = len(element_positions)
    if element_positions[:, 1].any():
        angles = np.linspace(-np.pi, np.pi, 8 * n_elements, endpoint=False)
    else:
        angles = np.arcsin(np.linspace(-1.0, 1.0, 4 * n_elements + 1))
    lead = element_positions[:, :1] * np.sin(angles) + element_positions[:, 1:2] * np.cos(angles)
    turn = np.exp(-2j * np.pi / sound_speed * frequency * lead)
    return float(np.max(np.abs(spectrum @ turn / n_elements) ** 2))
