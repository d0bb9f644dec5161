"""The recursion of PAST and OPAST over the snapshots of a portion: compiled, or in numpy.

For each snapshot x: y = W^H x; h = P y; g = h / (beta + Re y^H h); P <- (P - g h^H) / beta;
P <- (P + P^H) / 2; W <- W + (x - W y) g^H. Without the fourth step P loses its symmetry after a few
hundred snapshots and the recursion diverges.

OPAST keeps W orthonormal: q = P y / beta; gamma = 1 / (1 + y^H q); p = gamma (x - W y);
P <- P / beta - gamma q q^H, made Hermitian; tau = (1/|q|^2) (1/sqrt(1 + |p|^2 |q|^2) - 1);
p' = tau W q + (1 + tau |q|^2) p; W <- W + p' q^H.

``compiled_past`` is there if a compiler was when the package was installed. The coding in numpy,
which is two hundred times slower, takes every sum in the same order, real and imaginary parts
apart: both give the same bits.

References
----------
B. Yang, "Projection approximation subspace tracking", IEEE Trans. Signal Processing 43(1), 1995;
K. Abed-Meraim, A. Chkeif, Y. Hua, "Fast orthonormal PAST algorithm", IEEE Signal Processing
Letters 7(3), 2000.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import ComplexArray, FloatArray

_LANES = 4
"""Partial sums of a scalar product over the elements."""


COMPILED = compiled_module("passive.subspaces.compiled_past")
"""The compiled recursion, None where there is none."""


def lead_through(
    data: ComplexArray,
    basis: ComplexArray,
    inverse: ComplexArray,
    forgetting_factor: float,
    orthonormal: bool,
) -> tuple[ComplexArray, ComplexArray]:
    """Return W and P after all snapshots.

    Parameters
    ----------
    data : ndarray, shape (..., n_snapshots, n_elements), complex
        Linear amplitude.
    basis : ndarray, shape (..., n_elements, n_columns), complex
        W before them, pure numbers.
    inverse : ndarray, shape (..., n_columns, n_columns), complex
        P before them, Hermitian, 1 over linear power.
    forgetting_factor : float
        beta, per snapshot.
    orthonormal : bool
        OPAST instead of PAST.

    Returns
    -------
    basis : ndarray, shape (..., n_elements, n_columns), complex
        Pure numbers.
    inverse : ndarray, shape (..., n_columns, n_columns), complex
        1 over linear power.
    """
    if COMPILED is None:
        return _in_numpy(data, basis, inverse, forgetting_factor, orthonormal)
    batch, (n_snapshots, n_elements) = data.shape[:-2], data.shape[-2:]
    n_runs = int(np.prod(batch))
    led, weights = (np.array(each, dtype=np.complex128, order="C") for each in (basis, inverse))
    COMPILED.advance(
        np.ascontiguousarray(data, dtype=np.complex128),
        led,
        weights,
        (n_runs, n_snapshots, n_elements, basis.shape[-1]),
        forgetting_factor,
        orthonormal,
    )
    return led, weights


def _in_numpy(
    data: ComplexArray,
    basis: ComplexArray,
    inverse: ComplexArray,
    forgetting_factor: float,
    orthonormal: bool,
) -> tuple[ComplexArray, ComplexArray]:
    beta = forgetting_factor
    w, p = _Parts.of(basis), _Parts.of(inverse)
    for n in range(data.shape[-2]):
        x = _Parts.of(data[..., n, :, None])
        y = _projected(w, x)
        h = _Parts(
            _in_order(p.re * _row(y.re) - p.im * _row(y.im)),
            _in_order(p.re * _row(y.im) + p.im * _row(y.re)),
        )
        power = _in_order(_row(y.re * h.re + y.im * h.im))
        if orthonormal:
            gamma = 1.0 / (1.0 + power / beta)
            h = _Parts(h.re / beta, h.im / beta)
            p = _downdated(p, h, gamma * beta, beta)
            outside = _subtracted(x, w, y)
            outside = _Parts(outside.re * gamma, outside.im * gamma)
            q_power, p_power = _power(h), _power(outside)
            # (1/sqrt(1 + ab) - 1) / a without the cancellation, and with its limit 0 at a = 0.
            root = np.sqrt(1.0 + p_power * q_power)
            tau = -p_power / (root * (1.0 + root))
            along = 1.0 + tau * q_power
            outside = _Parts(outside.re * along, outside.im * along)
            outside = _subtracted(outside, w, _Parts(-tau * h.re, -tau * h.im))
            gain = np.ones_like(power)
        else:
            gain = 1.0 / (beta + power)
            p = _downdated(p, h, gain, beta)
            outside = _subtracted(x, w, y)
        re, im = _row(gain * h.re), _row(gain * h.im)
        w = _Parts(
            w.re + (outside.re * re + outside.im * im), w.im + (outside.im * re - outside.re * im)
        )
    return w.joined(), p.joined()


@dataclass(frozen=True)
class _Parts:
    """Real and imaginary part of a matrix."""

    re: FloatArray
    im: FloatArray

    @classmethod
    def of(cls, matrix: ComplexArray) -> _Parts:
        return cls(matrix.real, matrix.imag)

    def joined(self) -> ComplexArray:
        return self.re + 1j * self.im


def _projected(w: _Parts, x: _Parts) -> _Parts:
    """Return W^H x as a column."""
    return _Parts(
        _sum_of_lanes(w.re * x.re + w.im * x.im), _sum_of_lanes(w.re * x.im - w.im * x.re)
    )


def _downdated(p: _Parts, h: _Parts, share: FloatArray, beta: float) -> _Parts:
    """Return (P - share h h^H) / beta, Hermitian."""
    re = share * (h.re * _row(h.re) + h.im * _row(h.im))
    im = share * (h.im * _row(h.re) - h.re * _row(h.im))
    return _Parts(
        (0.5 * (p.re + np.swapaxes(p.re, -1, -2)) - re) / beta,
        (0.5 * (p.im - np.swapaxes(p.im, -1, -2)) - im) / beta,
    )


def _subtracted(x: _Parts, w: _Parts, v: _Parts) -> _Parts:
    """Return x - W v as a column."""
    re, im = _row(v.re), _row(v.im)
    return _Parts(
        _in_order(np.concatenate([x.re, -(w.re * re - w.im * im)], axis=-1)),
        _in_order(np.concatenate([x.im, -(w.re * im + w.im * re)], axis=-1)),
    )


def _power(column: _Parts) -> FloatArray:
    return _in_order(_row(column.re * column.re + column.im * column.im))


def _sum_of_lanes(terms: FloatArray) -> FloatArray:
    """Return the sums over the elements as a column, each lane in order, then the lanes."""
    *batch, n_elements, n_columns = terms.shape
    padded = np.zeros((*batch, -(-n_elements // _LANES) * _LANES, n_columns))
    padded[..., :n_elements, :] = terms
    lanes = np.cumsum(padded.reshape(*batch, -1, _LANES, n_columns), axis=-3)[..., -1, :, :]
    total = (lanes[..., 0, :] + lanes[..., 1, :]) + (lanes[..., 2, :] + lanes[..., 3, :])
    return np.asarray(total[..., None])


def _in_order(terms: FloatArray) -> FloatArray:
    """Return the sums along the rows, one term after the other."""
    return np.asarray(np.cumsum(terms, axis=-1)[..., -1:])


def _row(column: FloatArray) -> FloatArray:
    return np.swapaxes(column, -1, -2)
