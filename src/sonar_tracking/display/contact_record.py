"""Contact record: bearing and range of active sonar contacts over time, tracks on top.

Time runs downwards. Seen from the sensor clutter is a haze in both panels and a target a line,
also where the chart shows a knot. Bearings are compass bearings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.display.bearing_time_record import TRACK_COLOURS
from sonar_tracking.display.picture_files import loudness_colours, new_figure, save_picture
from sonar_tracking.display.position_history import PositionHistory
from sonar_tracking.motion import compass_from_azimuth
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.time import seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection


MOST_CONTACTS = 100_000
"""Of more, evenly chosen ones are drawn."""


@dataclass(frozen=True)
class ContactRecord:
    """Contacts of successive pings as seen from the sensor.

    Attributes
    ----------
    start : int
        Stamp of time zero, ns.
    times, bearings_deg, ranges, levels_db : ndarray, shape (n_contacts,)
        s, deg clockwise from north, m, dB above the noise (NaN = not measured).
    sensor_times : ndarray, shape (n_pings,)
        s.
    sensor_positions : ndarray, shape (n_pings, 2)
        m; NaN = unknown.
    """

    start: int
    times: FloatArray
    bearings_deg: FloatArray
    ranges: FloatArray
    levels_db: FloatArray
    sensor_times: FloatArray
    sensor_positions: FloatArray

    def seen(self, history: PositionHistory) -> FloatArray:
        """Return a track as the sensor sees it, between its first and its last ping.

        Parameters
        ----------
        history : PositionHistory
            Track in ``map``.

        Returns
        -------
        ndarray, shape (n, 3)
            Time (s), compass bearing (deg), range (m), NaN where the track was lost for a while;
            empty if the sensor's place is unknown.
        """
        times = history.seconds(self.start)
        known = np.all(np.isfinite(self.sensor_positions), axis=1)
        if not known.any():
            return np.empty((0, 3))
        at, places = self.sensor_times[known], self.sensor_positions[known]
        rows = (times >= at[0]) & (times <= at[-1])
        sensor = np.stack([np.interp(times[rows], at, places[:, k]) for k in (0, 1)], axis=-1)
        east, north = (history.positions_with_gaps()[rows] - sensor).T
        bearing = compass_from_azimuth(np.arctan2(north, east))
        return np.stack([times[rows], bearing, np.hypot(east, north)], axis=-1)


def contact_record(pings: Sequence[Contacts], start: int) -> ContactRecord:
    """Return the record of successive pings; contacts that are not finite are left out.

    Parameters
    ----------
    pings : sequence of Contacts
        In order.
    start : int
        Stamp of time zero, ns.
    """
    sensor_times = np.array([seconds(ping.stamp - start) for ping in pings])
    counts = [len(ping.range) for ping in pings]
    times = np.repeat(sensor_times, counts)
    ranges, azimuths, power = (
        np.concatenate([np.empty(0), *parts])
        for parts in (
            [ping.range for ping in pings],
            [ping.azimuth for ping in pings],
            [_amplitude(ping) for ping in pings],
        )
    )
    good = np.isfinite(ranges) & np.isfinite(azimuths)
    levels = np.full(len(power), np.nan)
    measured = power > 0.0
    levels[measured] = 10.0 * np.log10(power[measured])
    return ContactRecord(
        start=start,
        times=times[good],
        bearings_deg=compass_from_azimuth(azimuths[good]),
        ranges=ranges[good],
        levels_db=levels[good],
        sensor_times=sensor_times,
        sensor_positions=np.array([ping.sensor_position for ping in pings]).reshape(-1, 2),
    )


def draw_contact_record(
    record: ContactRecord,
    tracks: Sequence[PositionHistory],
    truth: Sequence[PositionHistory],
    path: Path,
    title: str = "",
) -> tuple[Path, Path]:
    """Draw a contact record, and return the files written.

    Parameters
    ----------
    record : ContactRecord
        The contacts.
    tracks, truth : sequence of PositionHistory
        Lines on top.
    path : Path
        Image file.
    title : str
        Heading.
    """
    figure = new_figure(11.0, 7.5)
    panels = figure.subplots(1, 2, sharey=True)
    figure.suptitle(title, fontsize=10)
    for axes, values in zip(panels, (record.bearings_deg, record.ranges), strict=True):
        dots = _draw_contacts(axes, record, values)
    if np.isfinite(record.levels_db).any():
        label = "level, dB above the noise"
        figure.colorbar(dots, ax=list(panels), label=label, shrink=0.5, aspect=30, pad=0.01)
    for number, history in enumerate(tracks):
        colour = TRACK_COLOURS[number % len(TRACK_COLOURS)]
        _draw_line(panels, record.seen(history), f"track {history.id}", colour, "-", 1.8)
    for number, history in enumerate(truth):
        label = "" if number else "truth"
        _draw_line(panels, record.seen(history), label, "black", "--", 0.8)
    last = max([*record.sensor_times, 1.0])
    panels[0].set(xlim=(0, 360), xlabel="bearing, deg from north", ylabel="time, s")
    panels[0].set_xticks(range(0, 361, 45))
    panels[0].set_ylim(last, float(min([*record.sensor_times, 0.0])))
    panels[1].set(xlim=(0, 1.02 * max([*record.ranges, 1.0])), xlabel="range, m")
    if len(tracks) <= 12 and panels[1].get_legend_handles_labels()[0]:
        panels[1].legend(loc="upper right", fontsize=8, framealpha=0.9)
    return save_picture(figure, path)


def _amplitude(ping: Contacts) -> FloatArray:
    return ping.amplitude if len(ping.amplitude) else np.full(len(ping.range), np.nan)


def _draw_contacts(axes: Axes, record: ContactRecord, values: FloatArray) -> PathCollection:
    chosen = slice(None, None, 1 + len(values) // MOST_CONTACTS)
    levels = record.levels_db[chosen]
    known = np.isfinite(levels).any()
    low, high = np.nanpercentile(levels, [5.0, 99.5]) if known else (0.0, 1.0)
    return axes.scatter(
        values[chosen],
        record.times[chosen],
        c=np.nan_to_num(levels, nan=low) if known else np.full(len(levels), 0.6),
        s=float(np.clip(30_000.0 / max(len(levels), 1), 2.0, 9.0)),
        cmap=loudness_colours(),
        vmin=low - 0.7 * (high - low),
        vmax=high,
        linewidths=0.0,
        rasterized=True,
    )


def _draw_line(
    panels: Sequence[Axes], seen: FloatArray, label: str, colour: str, style: str, width: float
) -> None:
    if not len(seen):
        return
    times, bearing, distance = seen.T
    # The line is broken where it passes through north.
    bearing = np.where(np.abs(np.diff(bearing, append=bearing[-1])) > 180.0, np.nan, bearing)
    for axes, values in zip(panels, (bearing, distance), strict=True):
        axes.plot(values, times, color=colour, linestyle=style, linewidth=width, label=label)
