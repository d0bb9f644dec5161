"""Cheong's fused line: all lines normalised to one virtual line, which never stops.

Each line is scaled by its own frequency in the first frame (18) and the scaled lines are averaged
with weights 1 / sigma (19). A line first heard later is scaled by what the virtual line was then
(20), (21) and used from the next frame on (22). Weights and reference are as printed, for
comparison: the reference is one noisy measurement whose error the line carries for ever, and no
term of the variance accounts for it, so that the filter is overconfident.

References
----------
Cheong (2011), "A robust target motion analysis algorithm for discontinuous frequency
measurements" (in Korean), eqs. 17-25.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, predict_bank
from sonar_tracking.tma.estimators.measurement_model import range_rate
from sonar_tracking.tma.estimators.recursion import elapsed, estimate_of, extended_step
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaEstimate, TmaMeasurement
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration


@dataclass(frozen=True)
class LineReferences:
    """What each line is scaled by.

    Attributes
    ----------
    virtual : ndarray, shape (...)
        f_A: frequency of the virtual line in the first frame with a line, Hz; NaN before.
    reference : ndarray, shape (..., n_lines)
        f^(i)(T_f), measured or, for a line first heard later, inferred, Hz; NaN = not heard yet.
    """

    virtual: FloatArray
    reference: FloatArray


class CheongFusedLine:
    """Cheong's filter on azimuth and one fused line.

    Parameters
    ----------
    configuration : SingleFilterConfiguration
        Its parameters; it is never restarted.
    """

    def __init__(self, configuration: SingleFilterConfiguration | None = None) -> None:
        self._configuration = configuration or SingleFilterConfiguration()
        self._bank: HypothesisBank | None = None
        self._references: LineReferences | None = None
        self._stamp = 0

    def update(self, measurement: TmaMeasurement) -> TmaEstimate:
        """Take one measurement in and return where the target is.

        Parameters
        ----------
        measurement : TmaMeasurement
            With one finite azimuth.
        """
        if self._references is None:
            self._references = first_references(measurement)
        fused = fuse_lines(measurement, self._references)
        if self._bank is None:
            self._bank, self._stamp = self._configuration.start(fused), measurement.stamp
        interval = elapsed(self._stamp, measurement.stamp)
        predicted = self._predict_line(self._bank, fused, interval)
        self._references = add_references(measurement, self._references, fused, predicted)
        acceleration = self._configuration.acceleration
        self._bank = extended_step(self._bank, fused, interval, acceleration)
        self._stamp = measurement.stamp
        return estimate_of(self._bank, fused)

    def _predict_line(
        self, bank: HypothesisBank, measurement: TmaMeasurement, interval: float
    ) -> FloatArray:
        """Return the virtual line the filter expects: the only bridge when every line is gone."""
        moved = predict_bank(bank, interval, np.asarray(0.0))
        rate = range_rate(moved.mean, measurement)[..., 0]
        expected = moved.mean[..., 0, KINEMATIC] * (1.0 - rate / measurement.sound_speed)
        return np.where(moved.known[..., 0], expected, np.nan)


def fused_frames(measurements: Sequence[TmaMeasurement]) -> list[TmaMeasurement]:
    """Return frames with Cheong's one line instead of their own, for a batch estimator.

    Parameters
    ----------
    measurements : sequence of TmaMeasurement
        All frames in order. A line that comes when all known ones are gone starts a new reference
        at the virtual line's first frequency: there is no filter that could bridge the gap.
    """
    references = first_references(measurements[0])
    frames = []
    for measurement in measurements:
        fused = fuse_lines(measurement, references)
        nothing = np.full(references.virtual.shape, np.nan)
        references = add_references(measurement, references, fused, nothing)
        frames.append(fused)
    return frames


def first_references(measurement: TmaMeasurement) -> LineReferences:
    """Return the references of the lines present in the first frame.

    The virtual line takes the frequency of the line with the largest f / sigma.
    """
    heard = measurement.heard
    reference = np.where(heard, measurement.frequency, np.nan)
    return LineReferences(_leading(measurement), reference)


def fuse_lines(measurement: TmaMeasurement, references: LineReferences) -> TmaMeasurement:
    """Return the measurement with one fused line (18), (19) and the variance of that average.

    Parameters
    ----------
    measurement : TmaMeasurement
        Any number of lines.
    references : LineReferences
        Lines without a reference are not used.
    """
    used = measurement.heard & np.isfinite(references.reference)
    scale = references.virtual[..., None] / np.where(used, references.reference, 1.0)
    deviation = np.where(used, measurement.frequency_deviation, 1.0)
    weight = np.where(used, 1.0 / deviation, 0.0)
    total = np.sum(weight, axis=-1)
    safe = np.where(total > 0.0, total, 1.0)
    scaled = np.where(used, measurement.frequency * scale, 0.0)
    noise = np.where(used, weight * deviation * scale, 0.0)
    fused = np.sum(weight * scaled, axis=-1) / safe
    return replace(
        measurement,
        frequency=np.where(total > 0.0, fused, np.nan)[..., None],
        frequency_deviation=(np.sqrt(np.sum(noise**2, axis=-1)) / safe)[..., None],
    )


def add_references(
    measurement: TmaMeasurement,
    references: LineReferences,
    fused: TmaMeasurement,
    predicted: FloatArray,
) -> LineReferences:
    """Return the references with those of lines first heard now (20), (21).

    Parameters
    ----------
    measurement : TmaMeasurement
        The frame.
    references : LineReferences
        Before the frame.
    fused : TmaMeasurement
        Its fused line, for the ratio.
    predicted : ndarray, shape (...)
        The fused line the filter expects, Hz; used when no known line is present.
    """
    virtual = np.where(np.isfinite(references.virtual), references.virtual, _leading(measurement))
    current = np.where(np.isfinite(fused.frequency[..., 0]), fused.frequency[..., 0], predicted)
    current = np.where(np.isfinite(current), current, virtual)
    inferred = measurement.frequency * (virtual / current)[..., None]
    new = measurement.heard & ~np.isfinite(references.reference)
    return LineReferences(virtual, np.where(new, inferred, references.reference))


def _leading(measurement: TmaMeasurement) -> FloatArray:
    """Return the frequency with the largest f / sigma of the lines present; NaN = none."""
    quality = np.where(
        measurement.heard, measurement.frequency / measurement.frequency_deviation, -np.inf
    )
    if measurement.n_lines == 0:
        return np.full(quality.shape[:-1], np.nan)
    best = np.argmax(quality, axis=-1)[..., None]
    return np.take_along_axis(measurement.frequency, best, axis=-1)[..., 0]
