"""Windows seen with what the data tell of the array: the colour of its noise.

The windows of a run are gone through in order of time, so that the fit of the array does not depend
on how the data are cut into blocks. As long as an array is as it is described, nothing is changed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.passive.array_fit.array_fit import ArrayFit
from sonar_tracking.passive.array_fit.counted_covariance import judged_covariance, judged_size
from sonar_tracking.passive.array_fit.noise_evidence import NoiseEvidence, noise_evidence
from sonar_tracking.passive.array_fit.noise_models import NoiseModel, noise_model
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.passive.subspaces.estimation_memory import (
    CompleteWindow,
    EstimationMemory,
    covariance_snapshots,
)
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.arrays import ComplexArray


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


@dataclass(frozen=True)
class _Judged:
    """A covariance to judge, its snapshots, the noise model, and what it says at white noise."""

    covariance: ComplexArray
    n_snapshots: int
    model: NoiseModel
    white: NoiseEvidence | None = None
    row: int = 0


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
    judged = [[_judged(configuration, window) for window in windows] for _, windows in runs]
    judged = _with_evidence(judged)
    return [_fitted(fit, windows, own) for (fit, windows), own in zip(runs, judged, strict=True)]


def _judged(configuration: SubspaceConfiguration, window: CompleteWindow) -> _Judged | None:
    """Return the covariance of a window that the fit is judged by, None if there is none."""
    memory = window.snapshots_from
    if memory.history.ndim > 2 or memory.header.noise_covariance is not None:
        return None
    if not window.subspaces:
        return None
    snapshots = covariance_snapshots(configuration, memory, window.covariance_end)
    size = judged_size(memory.header.element_positions, len(snapshots))
    model = noise_model(memory.header.element_positions[:size]) if size else None
    if model is None:
        return None
    covariance = judged_covariance(sample_covariance(snapshots), size)
    return _Judged(covariance, len(snapshots), model)


def _with_evidence(runs: list[list[_Judged | None]]) -> list[list[_Judged | None]]:
    """Return the covariances with what they say at white noise, those alike judged together."""
    alike: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for run, windows in enumerate(runs):
        for number, each in enumerate(windows):
            if each is not None:
                alike.setdefault((id(each.model), each.n_snapshots), []).append((run, number))
    for places in alike.values():
        together = [each for run, number in places if (each := runs[run][number]) is not None]
        first = together[0]
        white = noise_evidence(
            np.stack([each.covariance for each in together]),
            first.n_snapshots,
            first.model,
            np.zeros(first.model.n_parameters),
        )
        for row, ((run, number), each) in enumerate(zip(places, together, strict=True)):
            runs[run][number] = replace(each, white=white, row=row)
    return runs


def _fitted(
    fit: ArrayFit, windows: list[CompleteWindow], judged: list[_Judged | None]
) -> FittedWindows:
    fitted = []
    for window, each in zip(windows, judged, strict=True):
        if each is not None:
            share = min((window.covariance_end - fit.fitted_to) / each.n_snapshots, 1.0)
            if share > 0.0:
                colour = fit.colour.update(
                    each.covariance, each.n_snapshots, each.model, share, each.white, each.row
                )
                fit = replace(fit, colour=colour, fitted_to=window.covariance_end)
        fitted.append(window if fit.as_described else _with_fit(window, fit))
    return FittedWindows(fit, fitted)


def _with_fit(window: CompleteWindow, fit: ArrayFit) -> CompleteWindow:
    memory: EstimationMemory = window.snapshots_from
    if memory.header.noise_covariance is not None:
        return window
    noise = fit.noise_covariance(memory.header.element_positions)
    return replace(window, snapshots_from=memory.in_noise(noise))
