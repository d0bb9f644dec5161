"""What the tracker takes for detection, clutter and amplitudes of one ping.

The contacts say it, the parameters fill in. Clutter is uniform per square metre, or per resolution
cell of range and azimuth: then its density falls with the distance, lambda = P_F / (dr dtheta r).

References
----------
Kim, Song (2007), equations 4-5; Jung, Shin (2002), equations 2-3.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.clutter_amplitudes import IN_NOISE, ExcessLaw
from sonar_tracking.active.detection.clutter_profile import ClutterProfile, ring_edges
from sonar_tracking.active.detection.detection_levels import TYPICAL
from sonar_tracking.active.detection.detection_threshold import linear_from_decibel
from sonar_tracking.errors import Notice, Severity
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.contacts import Contacts

SMALLEST_CLUTTER_DENSITY = 1e-14
"""1/m^2; a density of zero would make every contact a certain target."""

TYPICAL_RATIO = 10.0
"""SNR where a method needs one number and nothing is known."""

AVERAGED_LEVELS_DB = np.arange(3.0, 20.5, 1.0)
"""Over which the amplitude likelihood is averaged where the ratio is not known."""

AVERAGED_RATIOS = linear_from_decibel(AVERAGED_LEVELS_DB)
"""The same, as power ratios."""


@dataclass(frozen=True)
class DetectionModel:
    """Detection, clutter and amplitudes of one ping.

    Attributes
    ----------
    detection_probability : float
        P_D at the threshold of the detector, where one number is needed.
    signal_to_noise_ratio_linear : float
        Of a target, power ratio.
    averaged : bool
        Whether amplitudes are judged by the average over levels.
    outlier_share : float
        Of false contacts as strong as targets: no amplitude says more than its inverse.
    threshold : float
        tau of the detector, linear; NaN = unknown.
    false_alarm_probability : float
        P_F of the detector per resolution cell; NaN = unknown.
    cell_size : float
        dr dtheta, m rad: the area of a cell is that times the distance; NaN = unknown.
    uniform_density : float
        False contacts per m^2 at the threshold of the detector; NaN = uniform per cell.
    maximum_range : float
        m; infinite = no limit.
    clutter_factor : float
        By which there is more clutter than claimed.
    minimum_range : float
        Of the survey, m.
    sector : float
        Width of the survey, rad.
    told_detection_probability : float
        P_D that the ping or the user claims; NaN = nobody does.
    clutter_law : ExcessLaw
        Of the amplitudes of false contacts.
    clutter_profile : ClutterProfile, optional
        Where there are more than their share; None = nowhere.
    """

    detection_probability: float
    signal_to_noise_ratio_linear: float
    averaged: bool
    outlier_share: float
    threshold: float
    false_alarm_probability: float
    cell_size: float
    uniform_density: float
    maximum_range: float
    clutter_factor: float = 1.0
    minimum_range: float = 0.0
    sector: float = 2.0 * np.pi
    told_detection_probability: float = np.nan
    clutter_law: ExcessLaw = IN_NOISE
    clutter_profile: ClutterProfile | None = None

    def expected_clutter(self) -> float:
        """Return the mean number of false contacts in a ping; infinite or NaN if unknown."""
        if math.isfinite(self.uniform_density):
            area = 0.5 * self.sector * (self.maximum_range**2 - self.minimum_range**2)
            return float(self.uniform_density * area)
        cells = self.sector * (self.maximum_range - self.minimum_range) / self.cell_size
        return float(self.false_alarm_probability * cells)

    def clutter_density(self, distance: FloatArray) -> FloatArray:
        """Return lambda at the threshold of the detector.

        Parameters
        ----------
        distance : ndarray, shape (n,)
            From the sensor, m.

        Returns
        -------
        ndarray, shape (n,)
            1/m^2.
        """
        if math.isfinite(self.uniform_density):
            uniform = max(self.clutter_factor * self.uniform_density, SMALLEST_CLUTTER_DENSITY)
            density = np.full(len(distance), uniform)
        else:
            area = self.cell_size * np.maximum(distance, 1.0)
            density = self.clutter_factor * (self.false_alarm_probability / area)
        if self.clutter_profile is not None:
            density = density * self.clutter_profile.factor(distance)
        return np.maximum(density, SMALLEST_CLUTTER_DENSITY)

    def expected_in_rings(self, reach: float) -> FloatArray:
        """Return the mean number of false contacts in rings around the sensor.

        Parameters
        ----------
        reach : float
            To which there are rings, m.

        Returns
        -------
        ndarray, shape (n,)
            Pure numbers; read only, since they are kept.
        """
        factor = self.clutter_factor * self.sector
        if math.isfinite(self.uniform_density):
            return _in_rings(reach, self.minimum_range, factor, 0.5 * self.uniform_density, 2)
        density = self.false_alarm_probability / self.cell_size
        return _in_rings(reach, self.minimum_range, factor, density, 1)

    @property
    def amplitude_law(self) -> tuple[object, ...]:
        """All that the likelihood ratio of an amplitude depends on."""
        told = (self.averaged, self.signal_to_noise_ratio_linear, self.outlier_share)
        return told if self.clutter_law == IN_NOISE else (*told, self.clutter_law, self.threshold)

    def amplitude_ratio(self, amplitudes: FloatArray, thresholds: FloatArray) -> FloatArray:
        """Return e(a) of amplitudes above thresholds.

        Parameters
        ----------
        amplitudes, thresholds : ndarray, shape (n,)
            Linear powers, noise mean 1; NaN = not known.

        Returns
        -------
        ndarray, shape (n,)
            Likelihood ratios, pure numbers; 1 where either is not known.
        """
        excess, raised = amplitudes - thresholds, thresholds - self.threshold
        law = self.clutter_law
        if self.averaged:
            ratios = law.likelihood_ratio(excess, raised, AVERAGED_RATIOS[:, None])
            ratio = ratios.mean(axis=0)
        else:
            ratio = law.likelihood_ratio(excess, raised, self.signal_to_noise_ratio_linear)
        share = self.outlier_share
        return np.where(np.isfinite(excess), ratio / (1.0 - share + share * ratio), 1.0)


@lru_cache(maxsize=64)
def _in_rings(
    reach: float, nearest: float, factor: float, density: float, power: int
) -> FloatArray:
    """Return what a density of a power of the distance gives in rings; most pings tell the same."""
    powers = np.maximum(ring_edges(reach), nearest) ** power
    expected = np.asarray(factor * (density * (powers[1:] - powers[:-1])))
    expected.setflags(write=False)
    return expected


def amplitude_ratios(
    models: Sequence[DetectionModel],
    scene: IndexArray,
    amplitudes: FloatArray,
    thresholds: FloatArray,
) -> FloatArray:
    """Return e(a) of amplitudes above thresholds in several scenes.

    Parameters
    ----------
    models : sequence of DetectionModel
        One a scene.
    scene : ndarray of int, shape (n,)
        Of each amplitude.
    amplitudes, thresholds : ndarray, shape (n,)
        Linear powers, noise mean 1; NaN = not known.

    Returns
    -------
    ndarray, shape (n,)
        Likelihood ratios, pure numbers; 1 where either is not known.
    """
    laws = [model.amplitude_law for model in models]
    if len(set(laws)) == 1:
        return models[0].amplitude_ratio(amplitudes, thresholds)
    ratios = np.empty(len(amplitudes))
    for law in dict.fromkeys(laws):
        alike = np.array([each == law for each in laws])[scene]
        model = models[laws.index(law)]
        ratios[alike] = model.amplitude_ratio(amplitudes[alike], thresholds[alike])
    return ratios


class DetectionDefaults(NamedTuple):
    """What fills in what a ping does not carry: some of :class:`ContactTrackerConfiguration`.

    Attributes
    ----------
    maximum_range, clutter_density, detection_probability : float
        m, 1/m^2, a probability; 0 = unknown.
    signal_to_noise_ratio_db : float
        dB; 0 = unknown.
    outlier_share : float
        Of false contacts as strong as targets.
    """

    maximum_range: float
    clutter_density: float
    detection_probability: float
    signal_to_noise_ratio_db: float
    outlier_share: float

    @classmethod
    def of(cls, configuration: ContactTrackerConfiguration) -> DetectionDefaults:
        """Return those of a tracker."""
        return cls(
            configuration.maximum_range,
            configuration.clutter_density,
            configuration.detection_probability,
            configuration.signal_to_noise_ratio_db,
            configuration.outlier_share,
        )


def make_detection_model(
    contacts: Contacts, defaults: DetectionDefaults | ContactTrackerConfiguration
) -> tuple[DetectionModel, tuple[Notice, ...]]:
    """Return what is known of a ping, and what had to be guessed.

    Parameters
    ----------
    contacts : Contacts
        The ping.
    defaults : DetectionDefaults or ContactTrackerConfiguration
        Fill in what the ping does not carry.
    """
    cell_size = contacts.range_resolution * contacts.azimuth_resolution
    per_cell = math.isfinite(cell_size * contacts.false_alarm_probability)
    maximum_range = _known(contacts.maximum_range, defaults.maximum_range or np.inf)
    minimum_range = _known(contacts.minimum_range, 0.0)
    sector = _known(contacts.azimuth_width, 2.0 * np.pi)
    density = contacts.clutter_density
    notices: tuple[Notice, ...] = ()
    if not math.isfinite(density) and not per_cell:
        density = defaults.clutter_density
        density = density or _counted_density(contacts, minimum_range, maximum_range, sector)
    if density <= 0.0:
        text = "The clutter density is zero; the smallest one that makes sense is used instead."
        notices = (Notice(Severity.WARN, "clutter_density", text),)
    told = _known(contacts.detection_probability, defaults.detection_probability or np.nan)
    ratio = contacts.signal_to_noise_ratio_linear
    if defaults.signal_to_noise_ratio_db and not math.isfinite(ratio):
        ratio = float(linear_from_decibel(defaults.signal_to_noise_ratio_db))
    model = DetectionModel(
        told_detection_probability=told,
        detection_probability=min(0.999, max(0.01, _known(told, TYPICAL))),
        signal_to_noise_ratio_linear=_known(ratio, TYPICAL_RATIO),
        averaged=not math.isfinite(ratio),
        outlier_share=defaults.outlier_share,
        threshold=_threshold(contacts),
        false_alarm_probability=contacts.false_alarm_probability,
        cell_size=cell_size,
        uniform_density=density,
        maximum_range=maximum_range,
        minimum_range=minimum_range,
        sector=sector,
    )
    return model, notices


def _known(value: float, otherwise: float) -> float:
    return value if math.isfinite(value) else otherwise


def _threshold(contacts: Contacts) -> float:
    if math.isfinite(contacts.detection_threshold):
        return contacts.detection_threshold
    if contacts.false_alarm_probability > 0.0:
        return -math.log(contacts.false_alarm_probability)
    # The weakest contact is a fair estimate of a threshold that is unknown.
    return float(np.min(contacts.amplitude)) if len(contacts.amplitude) else np.nan


def _counted_density(
    contacts: Contacts, minimum_range: float, maximum_range: float, sector: float
) -> float:
    """Return the number of contacts over the area of the survey, a density that errs high."""
    if not len(contacts.range):
        return SMALLEST_CLUTTER_DENSITY
    reach = maximum_range if np.isfinite(maximum_range) else float(np.max(contacts.range))
    area = 0.5 * sector * (reach**2 - minimum_range**2)
    return len(contacts.range) / max(area, 1.0)
