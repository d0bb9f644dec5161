"""Lines of every tracked bearing, from the element time series of an array.

Frame by frame: a beam on each confirmed bearing, exact at every frequency; its spectrum over the
background (one row of a LOFAR picture); bins above a threshold of constant false-alarm
probability; their frequencies; tonal tracks. Assumes tones that keep their frequency within a bin
over a frame, and a plane wave from the tracked bearing.

Whose line is it? Sidelobes let a strong tone into every beam, so that a peak is dropped if any
direction hears its frequency stronger than its beam does by ``ownership_margin_db``. Of the beams
that remain (neighbours that overlap) the strongest gets the line, or the one that had it before
unless it is weaker by that margin. Peaks less than two bins apart are one line. Lines of own ship
are left out by their frequencies, silent and faulty elements by their power.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import Notice
from sonar_tracking.filtering.assignment import load_solver
from sonar_tracking.passive.lines.line_analysis import LineAnalysis
from sonar_tracking.passive.lines.line_tracker_configuration import (
    LineTrackerConfiguration,
    check_line_tracker,
)
from sonar_tracking.passive.lines.line_tracks import HeardLine, LineTrack, LineTracks
from sonar_tracking.passive.lines.sample_frames import SampleFrame, SampleFramer
from sonar_tracking.passive.lines.usable_elements import element_notices, usable_elements
from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import Beams, FrequencyLines, LofarRows
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS

RESOLUTION_BINS = 2.0
"""Peaks closer than this, in whatever beams, are one line."""


@dataclass(frozen=True)
class LineUpdate:
    """What one frame gave.

    Attributes
    ----------
    lines : FrequencyLines
        Lines heard, empty if there were none.
    rows : LofarRows or None
        None if samples of the frame are missing.
    notices : tuple of Notice
        What a user should know.
    """

    lines: FrequencyLines
    rows: LofarRows | None
    notices: tuple[Notice, ...] = ()


class LineTrackerStage:
    """Finds and follows the lines of one array.

    Parameters
    ----------
    configuration : LineTrackerConfiguration
        Its parameters.

    Attributes
    ----------
    analysis : LineAnalysis or None
        Bins and thresholds, known from the first block on.

    Raises
    ------
    ConfigurationError
        If the parameters do not fit together.
    """

    def __init__(self, configuration: LineTrackerConfiguration | None = None) -> None:
        self._configuration = configuration or LineTrackerConfiguration()
        check_line_tracker(self._configuration)
        self._lines = LineTracks(self._configuration)
        self.reset()

    def warm_up(self) -> None:
        """Load the solver of assignments before the first data need it."""
        load_solver()

    def reset(self) -> None:
        """Forget all data and lines; identifiers go on."""
        self._framer = SampleFramer(self._configuration.frame_length)
        self._pictures: tuple[BearingTracks, ...] = ()
        self.analysis: LineAnalysis | None = None
        self._notices: tuple[Notice, ...] = ()
        self._used: BoolArray | None = None
        self._lines.clear()

    def update(
        self, samples: ArraySamples, tracks: Sequence[BearingTracks] = ()
    ) -> tuple[LineUpdate, ...]:
        """Take a block of samples and return the lines of every frame it completes.

        Parameters
        ----------
        samples : ArraySamples
            The next block.
        tracks : sequence of BearingTracks
            Pictures since the block before, in order; a frame listens where the latest one at or
            before its middle says.

        Returns
        -------
        tuple of LineUpdate
            One a frame. After the last block one without lines follows for the frame the data end
            in, which passes the end of the data on.

        Raises
        ------
        InputError
            If the block cannot be used; its samples are missing then.
        """
        self._pictures = (*self._pictures, *tracks)
        frames = self._framer.frames(samples)
        if self.analysis is None:
            self.analysis = LineAnalysis(self._configuration, samples)
            self._notices = self.analysis.notices()
        return tuple(self._update_frame(frame, self.analysis) for frame in frames)

    def _update_frame(self, frame: SampleFrame, analysis: LineAnalysis) -> LineUpdate:
        notices, self._notices = self._notices, ()
        beams = self._beams(frame.stamp)
        self._lines.predict(frame.stamp)
        if frame.samples is None:
            return LineUpdate(_report(frame, beams, (), analysis.frame_length), None, notices)
        spectra = analysis.spectra(frame.samples)
        used = usable_elements(spectra)
        notices += element_notices(used, np.ones_like(used) if self._used is None else self._used)
        self._used = used
        power = analysis.beam_powers(spectra, used, beams.arrival_angle)
        normalised = analysis.normaliser.normalise(power)
        peaks = analysis.hear(spectra, used, power, normalised, beams.track_id)
        heard = self._attribute(peaks, analysis)
        confirmed = self._lines.update(frame.stamp, heard, analysis.bin_width)
        return LineUpdate(
            lines=_report(frame, beams, confirmed, analysis.frame_length),
            rows=analysis.rows(frame, beams, normalised),
            notices=notices,
        )

    def _beams(self, stamp: int) -> Beams:
        """Bearings at an instant, from the latest picture at or before it; forget older ones."""
        known = [index for index, each in enumerate(self._pictures) if each.stamp <= stamp]
        if not known:
            return Beams(np.empty(0, np.uint64), np.empty(0), np.empty(0))
        self._pictures = self._pictures[known[-1] :]
        tracks = self._pictures[0]
        rows = tracks.established
        rows &= np.isfinite(tracks.arrival_angle)
        step = (stamp - tracks.stamp) / NANOSECONDS
        rate = np.nan_to_num(tracks.arrival_angle_rate[rows])
        covariance = tracks.covariance[rows]
        variance = covariance[:, 0, 0] + step * (2.0 * covariance[:, 0, 1])
        variance += step**2 * covariance[:, 1, 1]
        return Beams(tracks.id[rows], tracks.arrival_angle[rows] + step * rate, variance)

    def _attribute(
        self, heard: list[tuple[HeardLine, float]], analysis: LineAnalysis
    ) -> list[HeardLine]:
        """Return each line once, on the bearing track it belongs to."""
        margin = 10.0 ** (self._configuration.ownership_margin_db / 10.0)
        resolution = RESOLUTION_BINS * analysis.bin_width
        taken: list[HeardLine] = []
        for line, power in sorted(heard, key=lambda each: -each[1]):
            if any(abs(line.frequency - other.frequency) < resolution for other in taken):
                continue
            rivals = {
                other.track_id: other
                for other, level in heard
                if abs(other.frequency - line.frequency) < resolution and level * margin >= power
            }
            owners = [
                each.track_id
                for each in self._lines.lines
                if each.confirmed and abs(each.state[0] - line.frequency) < analysis.bin_width
            ]
            owner = next((each for each in owners if each in rivals), line.track_id)
            taken.append(line if owner == line.track_id else rivals[owner])
        return taken


def _report(
    frame: SampleFrame,
    beams: Beams,
    confirmed: Sequence[tuple[LineTrack, HeardLine]],
    frame_length: float,
) -> FrequencyLines:
    track_id = np.array([heard.track_id for _, heard in confirmed], np.uint64)
    beam_of = {int(each): beam for beam, each in enumerate(beams.track_id)}
    rows = [beam_of[int(each)] for each in track_id]
    return FrequencyLines(
        stamp=frame.stamp,
        track_id=track_id,
        arrival_angle=beams.arrival_angle[rows],
        arrival_angle_variance=beams.variance[rows],
        line_id=np.array([line.line_id for line, _ in confirmed], np.uint64),
        frequency=np.array([heard.frequency for _, heard in confirmed]),
        standard_deviation=np.sqrt([heard.variance for _, heard in confirmed]),
        signal_to_noise_ratio=np.array([heard.signal_to_noise_ratio for _, heard in confirmed]),
        integration_time=np.full(len(confirmed), frame_length),
        next_stamp=frame.next_stamp,
        sensor=frame.sensor,
    )
