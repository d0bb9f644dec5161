"""Tonal tracks: frequency and drift of every line, from peak to confirmed line to end.

One Kalman filter a line, state (frequency, drift), drift a random walk. Peaks go to lines by the
assignment of least total squared innovation; a peak on another bearing track than the line's costs
``HANDOVER_COST`` more, so that a line keeps its owner while that one hears it. A peak without a
line begins a tentative one; M detections among N frames confirm it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.filtering.assignment import least_cost_pairs
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import NANOSECONDS

HANDOVER_COST = 9.0
"""Squared standard deviations."""


@dataclass(frozen=True)
class HeardLine:
    """One line in one beam at one instant.

    Attributes
    ----------
    track_id : int
        Bearing track it is heard on.
    frequency, variance : float
        Hz and Hz^2.
    signal_to_noise_ratio : float
        Linear, in the analysis bandwidth.
    """

    track_id: int
    frequency: float
    variance: float
    signal_to_noise_ratio: float


@dataclass(frozen=True)
class LineTrack:
    """One line that is followed.

    Attributes
    ----------
    line_id : int
        Never reused.
    track_id : int
        Bearing track it was heard on last.
    stamp : int
        Instant of the state, ns.
    state : ndarray, shape (2,)
        Frequency, Hz, and drift, Hz/s.
    covariance : ndarray, shape (2, 2)
        Of the state, Hz^2, Hz^2/s, Hz^2/s^2.
    detections : tuple of bool
        Whether it was heard, in the latest frames.
    confirmed : bool
        Once confirmed it stays so.
    """

    line_id: int
    track_id: int
    stamp: int
    state: FloatArray
    covariance: FloatArray
    detections: tuple[bool, ...] = (True,)
    confirmed: bool = False

    def predict(self, stamp: int, drift_noise: float) -> LineTrack:
        """Return the line at a later instant."""
        step = (stamp - self.stamp) / NANOSECONDS
        transition = np.array([[1.0, step], [0.0, 1.0]])
        noise = drift_noise * np.array([[step**3 / 3.0, step**2 / 2.0], [step**2 / 2.0, step]])
        covariance = transition @ self.covariance @ transition.T + noise
        return replace(self, stamp=stamp, state=transition @ self.state, covariance=covariance)

    def update(self, heard: HeardLine) -> LineTrack:
        """Return the line after it was heard."""
        variance = self.covariance[0, 0] + heard.variance
        gain = self.covariance[:, 0] / variance
        return replace(
            self,
            track_id=heard.track_id,
            state=self.state + gain * (heard.frequency - self.state[0]),
            covariance=self.covariance - np.outer(gain, gain) * variance,
        )


class LineTracks:
    """All lines that are followed.

    Parameters
    ----------
    configuration : LineTrackerConfiguration
        Gate, confirmation, deletion, drift.
    """

    def __init__(self, configuration: LineTrackerConfiguration) -> None:
        self._configuration = configuration
        self._next_id = configuration.first_id
        self.lines: tuple[LineTrack, ...] = ()

    def clear(self) -> None:
        """End all lines; identifiers go on."""
        self.lines = ()

    def predict(self, stamp: int) -> None:
        """Bring all lines to an instant that is not earlier, ns."""
        noise = self._configuration.drift_noise
        self.lines = tuple(line.predict(stamp, noise) for line in self.lines)

    def update(
        self, stamp: int, heard: Sequence[HeardLine], bin_width: float
    ) -> tuple[tuple[LineTrack, HeardLine], ...]:
        """Take in what was heard at the stamp of the last prediction.

        Parameters
        ----------
        stamp : int
            ns.
        heard : sequence of HeardLine
            Each line once.
        bin_width : float
            Of the spectrum, Hz.

        Returns
        -------
        tuple of (LineTrack, HeardLine)
            The confirmed lines that were heard, by rising identifier.
        """
        pairs = self._assign(heard, bin_width)
        kept = []
        reported = []
        for index, line in enumerate(self.lines):
            peak = pairs.get(index)
            line = self._count_detection(line if peak is None else line.update(heard[peak]), peak)
            if not self._lives(line):
                continue
            kept.append(line)
            if peak is not None and line.confirmed:
                reported.append((line, heard[peak]))
        for peak in sorted(set(range(len(heard))) - set(pairs.values())):
            line = self._count_detection(self._new(stamp, heard[peak]), peak)
            kept.append(line)
            if line.confirmed:
                reported.append((line, heard[peak]))
        self.lines = tuple(kept)
        return tuple(reported)

    def _assign(self, heard: Sequence[HeardLine], bin_width: float) -> dict[int, int]:
        """Return the peak of each line that has one, by their numbers."""
        if not self.lines or not heard:
            return {}
        frequency = np.array([peak.frequency for peak in heard])
        variance = np.array([peak.variance for peak in heard])
        owner = np.array([peak.track_id for peak in heard])
        largest = self._configuration.gate**2
        alone = largest + HANDOVER_COST + 1.0
        cost = np.full((len(self.lines), len(heard)), alone)
        for index, line in enumerate(self.lines):
            innovation = frequency - line.state[0]
            spread = line.covariance[0, 0] + variance
            reach = np.maximum(self._configuration.gate * np.sqrt(spread), 0.5 * bin_width)
            total = np.minimum(innovation**2 / spread, largest)
            total += HANDOVER_COST * (owner != line.track_id)
            total -= HANDOVER_COST * line.confirmed  # an old line goes before a new one
            inside = np.abs(innovation) <= reach
            cost[index, inside] = total[inside]
        lines, peaks = least_cost_pairs(cost)
        return {
            int(line): int(peak)
            for line, peak in zip(lines, peaks, strict=True)
            if cost[line, peak] < alone
        }

    def _new(self, stamp: int, heard: HeardLine) -> LineTrack:
        line = LineTrack(
            line_id=self._next_id,
            track_id=heard.track_id,
            stamp=stamp,
            state=np.array([heard.frequency, 0.0]),
            covariance=np.diag([heard.variance, self._configuration.maximum_drift**2]),
            detections=(),
        )
        self._next_id += 1
        return line

    def _count_detection(self, line: LineTrack, peak: int | None) -> LineTrack:
        configuration = self._configuration
        length = max(configuration.confirmation_frames, configuration.deletion_frames)
        detections = (*line.detections, peak is not None)[-length:]
        hits = sum(detections[-configuration.confirmation_frames :])
        confirmed = line.confirmed or hits >= configuration.confirmation_hits
        return replace(line, detections=detections, confirmed=confirmed)

    def _lives(self, line: LineTrack) -> bool:
        configuration = self._configuration
        if line.confirmed:
            latest = line.detections[-configuration.deletion_frames :]
            return any(latest) or len(latest) < configuration.deletion_frames
        window = line.detections[-configuration.confirmation_frames :]
        missed = len(window) - sum(window)
        return missed <= configuration.confirmation_frames - configuration.confirmation_hits
