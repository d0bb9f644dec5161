"""Rows of beam power and spectra of a recording, message by message."""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.bags.storage.bag_records import IMAGE_TYPE, SAMPLES_TYPE, topics_of_type
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.display.bearing_time_record import Waterfall
from sonar_tracking.display.lofar_gram import GramRows
from sonar_tracking.display.waterfalls.beam_power import beam_power_row
from sonar_tracking.display.waterfalls.broadband_energy import BroadbandEnergy
from sonar_tracking.display.waterfalls.lofar_rows import LofarBeams, LofarRow
from sonar_tracking.passive.lines.background_normalisation import BackgroundNormaliser
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks
from sonar_tracking.records.lines import LofarRows
from sonar_tracking.records.samples import ArraySamples


class RecordedWaterfalls:
    """Collects the rows of every array of a bag.

    Spectra are those that were recorded; where there are none, they are made of the samples.

    Parameters
    ----------
    bag : Bag
        Whose topics tell what there is.
    """

    def __init__(self, bag: Bag) -> None:
        self.waterfalls: dict[str, Waterfall] = {}
        self.grams: dict[str, GramRows] = {}
        self._truths = {name for name, topic in bag.topics.items() if topic.role == "truth"}
        self._energies: dict[str, BroadbandEnergy] = {}
        self._beams: dict[str, LofarBeams] = {}
        self._normalisers: dict[tuple[float, float, int], BackgroundNormaliser] = {}
        pictures = [name for name in topics_of_type(bag, IMAGE_TYPE) if name.endswith("/lofar")]
        self._made = [] if pictures else topics_of_type(bag, SAMPLES_TYPE)

    def take(self, topic: str, record: Any) -> None:
        """Take the record of a message."""
        if isinstance(record, ArraySnapshots):
            row = beam_power_row(record)
            if row is not None:
                self.waterfalls.setdefault(topic, Waterfall("narrowband")).add(row)
        elif isinstance(record, ArraySamples):
            self._samples(topic, record)
        elif isinstance(record, LofarRows):
            self.grams.setdefault(topic, GramRows()).add(record)
        elif isinstance(record, BearingTracks) and self._made and topic not in self._truths:
            self._beams_of(record.sensor.sensor_id).take_tracks(record)

    def _samples(self, topic: str, block: ArraySamples) -> None:
        row = self._energies.setdefault(topic, BroadbandEnergy()).row(block)
        if row is not None:
            self.waterfalls.setdefault(topic, Waterfall("broadband")).add(row)
        if topic in self._made:
            for spectrum in self._beams_of(block.sensor.sensor_id).rows(block):
                rows = self.grams.setdefault(topic, GramRows())
                rows.add(self._over_background(spectrum, block.sensor.frame_id))

    def _beams_of(self, sensor_id: str) -> LofarBeams:
        return self._beams.setdefault(sensor_id, LofarBeams())

    def _over_background(self, row: LofarRow, frame_id: str) -> LofarRows:
        settings = LineTrackerConfiguration()
        key = row.first_frequency, row.bin_width, len(row.level_db)
        if key not in self._normalisers:
            frequencies = row.first_frequency + row.bin_width * np.arange(len(row.level_db))
            half_width = max(2, round(settings.background_half_width / row.bin_width))
            self._normalisers[key] = BackgroundNormaliser(
                np.asarray(frequencies, np.float64), half_width, settings.false_alarm_probability
            )
        power = 10.0 ** (row.level_db.astype(np.float64) / 10.0)
        over = self._normalisers[key].normalise(power)
        return LofarRows(
            stamp=(row.begin + row.end) // 2,
            track_id=np.array([row.track_id], np.uint64),
            first_frequency=row.first_frequency,
            bin_width=row.bin_width,
            level_db=np.asarray(10.0 * np.log10(np.maximum(over, 1e-9)), np.float32)[None],
            frame_id=frame_id,
        )
