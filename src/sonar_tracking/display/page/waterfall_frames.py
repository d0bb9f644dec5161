"""Frames of the waterfalls: rows of beam power and LOFAR, stacked dots, own ship's legs.

Rows of beam power go to every page. The spectrum of a beam and the dots of a track go to the pages
from when one of them has selected it, with what is known of the past.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np

from sonar_tracking.display.page.hearing_log import HearingLog
from sonar_tracking.display.page.own_ship_legs import OwnShipLegs
from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_frames import (
    Frame,
    binary_frame,
    rounded,
    seconds_of,
    text_frame,
)
from sonar_tracking.display.page.past_tracks import PastTracks
from sonar_tracking.display.page.solution_dots import solution_dots
from sonar_tracking.display.page.stacked_dots import DotStack
from sonar_tracking.display.page.track_frames import StationPlaces
from sonar_tracking.display.waterfalls.beam_power import beam_power_row
from sonar_tracking.display.waterfalls.beam_rows import BeamRow
from sonar_tracking.display.waterfalls.broadband_energy import BroadbandEnergy
from sonar_tracking.display.waterfalls.lofar_history import LofarHistory
from sonar_tracking.display.waterfalls.lofar_rows import LofarBeams, LofarRow
from sonar_tracking.display.waterfalls.waterfall_cascade import ScaledRow, WaterfallCascade
from sonar_tracking.errors import InputError
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks, Sensor
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS, nanoseconds
from sonar_tracking.tma.targets.station_view import StationView

MOST_SELECTED = 3
"""Beams and tracks that are sent at the same time, those selected last."""

DOTS_PERIOD = nanoseconds(5.0)
"""Between two pictures of the dots of a track, ns."""

MOST_DOTS = 300
"""Of a stack that are sent; of more, evenly chosen ones, the newest among them."""


class WaterfallFrames:
    """Makes frames of what arrays and trackers give.

    Parameters
    ----------
    own_ship : OwnShipLog
        Own ship.
    places : StationPlaces
        Where the sensors are.
    history_seconds : float
        Data time kept of beams that nobody has selected yet, s.
    """

    def __init__(self, own_ship: OwnShipLog, places: StationPlaces, history_seconds: float) -> None:
        self._own_ship, self._places = own_ship, places
        self._cascades: dict[str, WaterfallCascade] = {}
        self._energies: dict[str, BroadbandEnergy] = {}
        self._beams: dict[str, LofarBeams] = {}
        self._spectra = LofarHistory(history_seconds)
        self._log = HearingLog()
        self._heard: dict[str, str] = {}
        self._legs = OwnShipLegs()
        self._newest: dict[str, PositionTracks] = {}
        self._past: dict[str, PastTracks] = {}
        self._history_seconds = history_seconds
        self._lofar_selected: dict[tuple[str, int, float], None] = {}
        self._dots_selected: dict[tuple[str, int], int] = {}

    def own_ship(self, state: OwnShipState) -> Iterator[Frame]:
        """Take own ship's state; yield her legs where they have changed."""
        if self._legs.add(state):
            yield self._legs_frame(state.stamp)

    def snapshots(self, topic: str, block: ArraySnapshots) -> Iterator[Frame]:
        """Yield the rows that a block of snapshots completes."""
        row = beam_power_row(block)
        if row is not None:
            yield from self._rows(topic, "narrowband", self._placed(row, block.sensor))

    def samples(self, topic: str, block: ArraySamples) -> Iterator[Frame]:
        """Yield the rows of energy and of selected spectra that a block of samples completes."""
        energy = self._energies.setdefault(topic, BroadbandEnergy())
        row = energy.row(block)
        if row is not None:
            yield from self._rows(topic, "broadband", self._placed(row, block.sensor))
        for spectrum in self._beams_of(block.sensor.sensor_id).rows(block):
            self._spectra.add(spectrum)
            if _selection(spectrum) in self._lofar_selected:
                yield _lofar_frame(spectrum)

    def bearings(self, topic: str, tracks: BearingTracks, view: StationView | None) -> None:
        """Take what a sensor has heard, and where it was: beams follow, dots are made of it.

        Of a sensor with several lists the first counts; truth is not heard.
        """
        sensor_id = tracks.sensor.sensor_id
        if "truth" in topic.split("/") or self._heard.setdefault(sensor_id, topic) != topic:
            return
        self._beams_of(sensor_id).take_tracks(tracks)
        if view is not None:
            self._log.add_bearings(tracks, view)

    def lines(self, lines: FrequencyLines) -> None:
        """Take the lines a sensor has heard."""
        view = self._places.view(lines.sensor, lines.stamp)
        if view is not None:
            self._log.add_lines(lines, view)

    def tracks(self, topic: str, tracks: PositionTracks) -> Iterator[Frame]:
        """Take a list of tracks; yield the dots of those selected."""
        self._newest[topic] = tracks
        self._past.setdefault(topic, PastTracks(self._history_seconds)).add(tracks)
        for selected, track in tuple(self._dots_selected):
            last = self._dots_selected[selected, track]
            if selected == topic and not last <= tracks.stamp < last + DOTS_PERIOD:
                yield from self._dots(topic, track)

    def select(self, said: Mapping[str, Any]) -> Iterator[Frame]:
        """Select what is sent from now on; yield what is known of it.

        Parameters
        ----------
        said : mapping
            ``view`` is ``lofar``, with ``sensor`` and ``track`` (a bearing track) or ``beam`` (an
            arrival angle, rad), or ``dots``, with ``topic`` and ``track``, and ``t``, a data time
            in s, where the solution at that time is meant.

        Raises
        ------
        InputError
            If it makes no sense.
        """
        try:
            if said["view"] == "lofar":
                sensor, track = str(said["sensor"]), int(said.get("track") or 0)
                beam = 0.0 if track else round(_wrapped(float(said["beam"])), 4)
                yield from self._select_spectrum(sensor, track, beam)
            elif said["view"] == "dots":
                topic, track = str(said["topic"]), int(said["track"])
                if said.get("t") is None:
                    _remember(self._dots_selected, (topic, track), 0)
                    yield from self._dots(topic, track)
                else:
                    yield from self._past_dots(topic, track, nanoseconds(float(said["t"])))
        except (KeyError, TypeError, ValueError, OverflowError):
            raise InputError(
                "select needs view lofar, sensor and track or beam; or view dots, topic and track."
            ) from None

    def _select_spectrum(self, sensor: str, track: int, beam: float) -> Iterator[Frame]:
        _remember(self._lofar_selected, (sensor, track, beam), None)
        for sensor_id, beams in self._beams.items():
            beams.directions = self._directions(sensor_id)
        if track:
            yield from map(_lofar_frame, self._spectra.of(sensor, track))

    def _beams_of(self, sensor_id: str) -> LofarBeams:
        if sensor_id not in self._beams:
            self._beams[sensor_id] = LofarBeams()
            self._beams[sensor_id].directions = self._directions(sensor_id)
        return self._beams[sensor_id]

    def _directions(self, sensor_id: str) -> tuple[float, ...]:
        """Return the selected arrival angles of a sensor, rad."""
        return tuple(
            angle
            for sensor, track, angle in self._lofar_selected
            if sensor == sensor_id and not track
        )

    def _placed(self, row: BeamRow, sensor: Sensor) -> BeamRow:
        """Return a row with the direction of its array as the trackers take it."""
        view = self._places.view(sensor, row.middle)
        return row if view is None else replace(row, axis_azimuth=view.axis)

    def _rows(self, topic: str, content: str, row: BeamRow) -> Iterator[Frame]:
        cascade = self._cascades.setdefault(topic, WaterfallCascade())
        completed = cascade.add(row)
        pending = cascade.pending() if completed else []
        for scaled in chain(completed, pending):
            yield self._row_frame(topic, content, scaled)

    def _row_frame(self, topic: str, content: str, scaled: ScaledRow) -> Frame:
        row, axis = scaled.row, scaled.row.axis
        own_ship = self._own_ship.state_at(row.middle)
        header = {
            "t0": seconds_of(row.begin),
            "t1": seconds_of(row.end),
            "topic": topic,
            "content": content,
            "sensor": row.sensor_id,
            "scale": scaled.scale,
            "integrated": row.integrated,
            "axis_azimuth": row.axis_azimuth,
            "heading": own_ship.yaw if own_ship else np.nan,
            "angles": {
                "first": axis.first,
                "step": axis.step,
                "count": axis.count,
                "of": "sine" if axis.sine else "angle",
            },
            "unit": "dB",
        }
        kind = "waterfall" if scaled.complete else "waterfall_open"
        stream = f"{topic} {scaled.scale:g}"
        return binary_frame(kind, seconds_of(row.end), stream, header, row.level_db)

    def _dots(self, topic: str, track: int) -> Iterator[Frame]:
        tracks = self._newest.get(topic)
        for frame in self._solution(topic, tracks, track):
            self._dots_selected[topic, track] = tracks.stamp if tracks else 0
            yield frame

    def _past_dots(self, topic: str, track: int, stamp: int) -> Iterator[Frame]:
        past = self._past.get(topic)
        yield from self._solution(topic, past.at(stamp) if past else None, track)

    def _solution(self, topic: str, tracks: PositionTracks | None, track: int) -> Iterator[Frame]:
        if tracks is None:
            return
        for row in np.flatnonzero(tracks.id == track)[:1]:
            stacks = solution_dots(tracks, int(row), self._log)
            yield _dots_frame(topic, track, tracks.stamp, stacks)

    def _legs_frame(self, stamp: int) -> Frame:
        legs = [
            {
                "t0": seconds_of(leg.begin),
                "t1": seconds_of(leg.end),
                "turning": leg.turning,
                "course_deg": leg.course_deg,
            }
            for leg in self._legs.legs()
        ]
        return text_frame("legs", seconds_of(stamp), "", legs=legs)


def _wrapped(angle: float) -> float:
    """Return an angle in [-pi, pi], rad; NaN and infinity raise ValueError."""
    if not math.isfinite(angle):
        raise ValueError
    return math.remainder(angle, 2.0 * math.pi)


def _selection(row: LofarRow) -> tuple[str, int, float]:
    return row.sensor_id, row.track_id, 0.0 if row.track_id else round(row.angle, 4)


def _remember(selected: dict[Any, Any], key: Any, value: Any) -> None:
    """Make a selection the newest, and forget the oldest of too many."""
    selected.pop(key, None)
    selected[key] = value
    while len(selected) > MOST_SELECTED:
        del selected[next(iter(selected))]


def _lofar_frame(row: LofarRow) -> Frame:
    header: dict[str, Any] = {
        "t0": seconds_of(row.begin),
        "t1": seconds_of(row.end),
        "sensor": row.sensor_id,
        "track": row.track_id,
        "angle": row.angle,
        "frequency": {
            "first": row.first_frequency,
            "step": row.bin_width,
            "count": len(row.level_db),
        },
        "unit": "dB re 1/Hz",
    }
    if not row.track_id:
        header["beam"] = _selection(row)[2]
    stream = f"{row.sensor_id} {row.track_id} {_selection(row)[2]}"
    return binary_frame("lofar", seconds_of(row.end), stream, header, row.level_db)


def _dots_frame(topic: str, track: int, stamp: int, stacks: tuple[DotStack, ...]) -> Frame:
    """Return the dots of a track; they take the place of those it had before."""
    entries = []
    for stack in stacks:
        chosen = slice(None, None, -(1 + len(stack.stamps) // MOST_DOTS))
        entries.append(
            {
                "label": stack.label,
                "frequency": stack.frequency,
                "times": stack.stamps[chosen][::-1] / NANOSECONDS,
                "residual": rounded(stack.residual[chosen][::-1]),
                "deviation": rounded(stack.deviation[chosen][::-1]),
            }
        )
    stream = f"{topic} {track}"
    return text_frame("dots", seconds_of(stamp), stream, topic=topic, track=track, stacks=entries)
