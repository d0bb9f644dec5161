"""Windows seen with what the data tell of the array: faults of elements, their errors, the noise.

The windows of a run are gone through in order of time, so that the fit of the array does not depend
on how the data are cut into blocks. As long as an array is as it is described, nothing is changed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.filtering.eigenpairs import eigenpairs, stacked_eigenpairs
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.array_fit.array_fit import ArrayFit, updated_fits
from sonar_tracking.passive.array_fit.judged_covariance import (
    JudgedCovariance,
    judged_covariance,
    judged_size,
)
from sonar_tracking.passive.array_fit.noise_colour import updated_colours
from sonar_tracking.passive.array_fit.noise_evidence import noise_evidence
from sonar_tracking.passive.array_fit.noise_models import noise_model
from sonar_tracking.passive.array_fit.strong_sources import MOST_ELEMENTS
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.passive.subspaces.estimation_memory import (
    CompleteWindow,
    covariance_snapshots,
)
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration


@dataclass(frozen=True)
class FittedWindows:
    """The windows of one run.

    Attributes
    ----------
    fit : ArrayFit
        After the last of them.
    windows : list of CompleteWindow
        Each with the fit of the array of its time.
    """

    fit: ArrayFit
    windows: list[CompleteWindow]


def fitted_windows(
    configuration: SubspaceConfiguration, runs: list[tuple[ArrayFit, list[CompleteWindow]]]
) -> list[FittedWindows]:
    """Return the windows of several runs with what the data tell of their arrays.

    Parameters
    ----------
    configuration : SubspaceConfiguration
        Parameters of the stage.
    runs : list of (ArrayFit, list of CompleteWindow)
        The fit before, and the windows in order of time, of each run.
    """
    judged = [[_judged(configuration, window, fit) for window in windows] for fit, windows in runs]
    coloured = [fit.colour.coloured for fit, _ in runs]
    judged = _with_evidence(_with_eigenpairs(judged, coloured), coloured)
    fitted = [FittedWindows(fit, []) for fit, _ in runs]
    for number in range(max((len(windows) for _, windows in runs), default=0)):
        rows = [row for row, (_, windows) in enumerate(runs) if number < len(windows)]
        for row in rows:
            before, windows = runs[row]
            if fitted[row].fit.faults.found != before.faults.found:
                judged[row][number] = _judged(configuration, windows[number], fitted[row].fit)
        latest = [(fitted[row], runs[row][1][number], judged[row][number]) for row in rows]
        for row, each in zip(rows, _one_more_window(latest), strict=True):
            fitted[row] = each
    return fitted


def _one_more_window(
    runs: list[tuple[FittedWindows, CompleteWindow, JudgedCovariance | None]],
) -> list[FittedWindows]:
    """Return the windows of several runs with one more of each, the noise of all judged at once."""
    shares = [
        0.0
        if each is None
        else min((window.covariance_end - fitted.fit.fitted_to) / each.n_snapshots, 1.0)
        for fitted, window, each in runs
    ]
    fits = [fitted.fit for fitted, _, _ in runs]
    new = [
        (row, window, each, share)
        for row, ((_, window, each), share) in enumerate(zip(runs, shares, strict=True))
        if each is not None and share > 0.0
    ]
    colours = updated_colours([(fits[row].colour, each, share) for row, _, each, share in new])
    judged = [
        (fits[row], each, colour, window.covariance_end)
        for (row, window, each, _), colour in zip(new, colours, strict=True)
    ]
    for (row, _, _, _), fit in zip(new, updated_fits(judged), strict=True):
        fits[row] = fit
    return [
        FittedWindows(fit, [*fitted.windows, _as_fitted(window, fit, fitted.fit, each)])
        for fit, (fitted, window, each) in zip(fits, runs, strict=True)
    ]


def _as_fitted(
    window: CompleteWindow, fit: ArrayFit, before: ArrayFit, judged: JudgedCovariance | None
) -> CompleteWindow:
    """Return a window with the fit after it, and its covariance if the faults are as before."""
    if judged is not None and fit.faults.found == before.faults.found:
        window = replace(window, covariance=judged.covariance, eigenpairs=judged.eigenpairs)
    if fit.as_described:
        return window
    return replace(window, snapshots_from=window.snapshots_from.fitted(fit))


def _judged(
    configuration: SubspaceConfiguration, window: CompleteWindow, fit: ArrayFit
) -> JudgedCovariance | None:
    """Return the covariance of a window that the fit is judged by, None if there is none."""
    memory = window.snapshots_from
    if memory.history.ndim > 2 or not window.subspaces:
        return None
    if configuration.steering_error > 0.0:
        # What is no plane wave is known to be there: neither noise nor elements can be judged.
        return None
    header = memory.header
    if fit.faults.found:
        memory = memory.fitted(replace(fit, colour=replace(fit.colour, coloured=False)))
    snapshots = covariance_snapshots(configuration, memory, window.covariance_end)
    positions = header.element_positions
    size = judged_size(positions, len(snapshots))
    if size == 0:
        return None
    noise = header.noise_covariance
    of_noise = judged_covariance(snapshots, size)
    whole = None
    if len(positions) <= MOST_ELEMENTS:
        whole = of_noise if size == len(positions) else sample_covariance(snapshots)
    return JudgedCovariance(
        whole,
        of_noise,
        len(snapshots),
        positions,
        wavenumber(header.center_frequency, header.sound_speed),
        np.flatnonzero(memory.used),
        noise,
        noise_model(positions[:size]) if noise is None else None,
    )


def _with_eigenpairs(
    runs: list[list[JudgedCovariance | None]], coloured: list[bool]
) -> list[list[JudgedCovariance | None]]:
    """Return the covariances in white noise with their eigenpairs, which many steps ask for."""
    alike: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for run, windows in enumerate(runs):
        for number, each in enumerate(windows):
            if each is None or each.covariance is None or each.noise is not None or coloured[run]:
                continue
            if each.n_snapshots >= len(each.covariance):
                alike.setdefault(each.covariance.shape, []).append((run, number))
    for places in alike.values():
        together = [each for run, number in places if (each := runs[run][number]) is not None]
        known = [each.covariance for each in together if each.covariance is not None]
        pairs = eigenpairs(np.stack(known))
        for row, ((run, number), each) in enumerate(zip(places, together, strict=True)):
            runs[run][number] = replace(each, eigenpairs=pairs.of(row))
    return runs


def _with_evidence(
    runs: list[list[JudgedCovariance | None]], coloured: list[bool]
) -> list[list[JudgedCovariance | None]]:
    """Return the covariances with what they say at white noise, those alike judged together.

    Where the noise is known to be coloured already, they are not asked.
    """
    alike: dict[tuple[int, int, bool], list[tuple[int, int]]] = {}
    for run, windows in enumerate(runs):
        for number, each in enumerate(windows):
            if each is not None and each.model is not None and not coloured[run]:
                kind = (id(each.model), each.n_snapshots, each.judged_whole)
                alike.setdefault(kind, []).append((run, number))
    for places in alike.values():
        together = [each for run, number in places if (each := runs[run][number]) is not None]
        model = together[0].model
        if model is None:
            continue
        white = noise_evidence(
            np.stack([each.of_noise for each in together]),
            together[0].n_snapshots,
            model,
            np.zeros(model.n_parameters),
            eigenpairs=stacked_eigenpairs(
                [each.eigenpairs if each.judged_whole else None for each in together]
            ),
        )
        for row, ((run, number), each) in enumerate(zip(places, together, strict=True)):
            runs[run][number] = replace(each, white=white.of(row))
    return runs
