"""What else but errors of the elements lifts the floors of strong sources.

Echoes that arrive with a source are coherent with it: more steering vectors explain the
eigenvectors then, as many as the smoothed covariance counts. Two sources that are nearer to each
other than MUSIC resolves leave one shallow valley: a pair in its place explains them. The
covariances of all runs are looked at side by side.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.geometry import beamwidth, is_uniform_line
from sonar_tracking.passive.array_fit.alike_cases import alike
from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.strong_sources import StrongSources, stacked_vectors
from sonar_tracking.passive.directions.projection_fit import (
    ProjectionProblem,
    fits_below,
    projection_fit,
)
from sonar_tracking.passive.sources.mdl import smoothed_size, source_counts
from sonar_tracking.passive.sources.music import bearings_in_covariances
from sonar_tracking.passive.sources.spatial_smoothing import forward_backward_smoothed
from sonar_tracking.records.arrays import BoolArray, FloatArray

_MORE_SOURCES = 2
"""Coherent ones, beside those that the rank shows."""

_EXPLAINED = 0.3
"""Share of the floors that coherent sources, or a pair, may leave."""

_PAIR, _PAIR_STEPS = 0.15, 8
"""Where a pair of sources is sought, of the beamwidth to either side of a valley."""


def otherwise_explained(cases: Sequence[tuple[StrongSources, JudgedCovariance]]) -> list[bool]:
    """Return which floors coherent sources explain, or a pair that is not resolved.

    Parameters
    ----------
    cases : sequence of (StrongSources, JudgedCovariance)
        The strong sources in a covariance, and the covariance.
    """
    # Coherent sources first: to tell them takes one fit, and a pair several.
    explained = _coherent(cases)
    left = [row for row, known in enumerate(explained) if not known]
    for row, pair in zip(left, _unresolved_pairs([cases[row][0] for row in left]), strict=True):
        explained[row] = pair
    return explained


def _coherent(cases: Sequence[tuple[StrongSources, JudgedCovariance]]) -> list[bool]:
    """Return where coherent sources explain what plane waves of the rank do not."""
    coherent = [False] * len(cases)
    kinds = {
        row: (strong.kind, judged.n_snapshots)
        for row, (strong, judged) in enumerate(cases)
        if judged.covariance is not None and is_uniform_line(judged.positions)
    }
    for rows in alike(kinds):
        judged = [each for row in rows if (each := cases[row][1].covariance) is not None]
        covariances, n_snapshots = np.stack(judged), cases[rows[0]][1].n_snapshots
        n_elements, n_strong = cases[rows[0]][0].vectors.shape
        size = smoothed_size(n_elements, n_snapshots)
        counts = source_counts(covariances, n_snapshots)
        smoothed = forward_backward_smoothed(covariances, size)
        most = min(n_strong + _MORE_SOURCES, size - 1, n_elements // 3)
        for count in range(n_strong + 1, most + 1):
            places = np.flatnonzero(counts == count)
            if len(places):
                strong = [cases[rows[place]][0] for place in places.tolist()]
                first = strong[0]
                angles = bearings_in_covariances(
                    smoothed[places], count, first.positions[:size], first.wavenumber
                )
                for place, told in zip(places, _explained_by(angles, strong), strict=True):
                    coherent[rows[place]] = bool(told)
    return coherent


def _explained_by(angles: FloatArray, found: Sequence[StrongSources]) -> BoolArray:
    """Return where sources at some angles, rad, NaN = none, explain the floors; shape (n,)."""
    explained = np.zeros(len(found), dtype=bool)
    resolved = np.count_nonzero(np.isfinite(angles), axis=-1)
    for n_resolved in set(resolved[resolved > 0].tolist()):
        rows = np.flatnonzero(resolved == n_resolved)
        own = [found[row] for row in rows.tolist()]
        problem = ProjectionProblem(stacked_vectors(own), own[0].positions, own[0].wavenumber)
        left = problem.error(projection_fit(problem, angles[rows, :n_resolved]))
        explained[rows] = left < _EXPLAINED * np.array([each.floor for each in own])
    return explained


def _unresolved_pairs(found: Sequence[StrongSources]) -> list[bool]:
    """Return where a pair of sources, nearer than MUSIC resolves, is what is seen.

    It takes the place of a valley, and that of the worst one if its sources are not coherent.
    """
    pairs = [False] * len(found)
    for rows in alike({row: each.kind for row, each in enumerate(found)}):
        own = [found[row] for row in rows]
        first = own[0]
        vectors, most = stacked_vectors(own), _EXPLAINED * np.array([each.floor for each in own])
        starts = [_pair_starts(each) for each in own]
        told = np.zeros(len(own), dtype=bool)
        for kind in (0, 1):
            left = np.flatnonzero(~told)
            if not len(left) or not len(starts[0][kind]):
                continue
            problem = ProjectionProblem(vectors[left], first.positions, first.wavenumber)
            begun = np.stack([starts[row][kind] for row in left.tolist()])
            told[left] = fits_below(problem, begun, most[left], _PAIR_STEPS)
        for row, pair in zip(rows, told, strict=True):
            pairs[row] = bool(pair)
    return pairs


def _pair_starts(strong: StrongSources) -> tuple[FloatArray, FloatArray]:
    """Return where fits of a pair begin, with coherent sources and with others, (n, n_angles)."""
    angles = strong.angles
    worst = int(np.argmax(strong.floors))
    apart = _PAIR * beamwidth(strong.positions, strong.wavenumber)
    step = apart / np.maximum(np.cos(angles), apart)
    pairs = np.stack([angles - step, angles + step], axis=-1)
    coherent, others = list[FloatArray](), list[FloatArray]()
    for each, pair in enumerate(pairs):
        coherent.append(np.concatenate([np.delete(angles, each), pair]))
        if each != worst:
            others.append(np.concatenate([np.delete(angles, [each, worst]), pair]))
    return np.stack(coherent), np.array(others).reshape(-1, len(angles))
