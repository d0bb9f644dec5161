"""Pictures of the ships around, from their AIS as it comes.

A picture waits for reports after its instant, so that ships are interpolated between two reports
rather than predicted; those that report more seldom are predicted for a while, and said to be.
"""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from sonar_tracking.bags.nmea.ais_reports import AisReports, is_ais
from sonar_tracking.bags.nmea.nmea_input_configuration import AisTruthConfiguration
from sonar_tracking.bags.nmea.own_ship_sentences import own_ship_report
from sonar_tracking.bags.nmea.sentence_time import SentenceTime
from sonar_tracking.bags.nmea.sentences import Sentence, read_sentence
from sonar_tracking.bags.nmea.ship_histories import FAR, LONGEST_REST, ShipHistory, report_state
from sonar_tracking.errors import InputError
from sonar_tracking.geodesy import FARTHEST, surface_distances
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import nanoseconds, seconds

NO_DATUM = (
    "an AIS report came before the datum was known; it is not used: give the parameter datum, or "
    "start own_ship_nmea"
)

_MOST_AT_ONCE = 60
"""Pictures that are made up for when time leaps on; earlier ones are left out."""


class LiveShips:
    """Makes pictures of the lines of a stream.

    Parameters
    ----------
    configuration : AisTruthConfiguration
        Period, delay and prediction.
    datum : Datum or None
        Of ``map``; None = not known yet.

    Attributes
    ----------
    datum : Datum or None
        The same; may be set once.
    used : Counter of str
        Sentences of each format that are used.
    faults : Counter of str
        How many lines or reports of each kind could not be used.
    """

    def __init__(self, configuration: AisTruthConfiguration, datum: Datum | None = None) -> None:
        self.datum = datum
        self.used: Counter[str] = Counter()
        self.faults: Counter[str] = Counter()
        self._period = nanoseconds(configuration.period)
        self._delay = nanoseconds(configuration.delay)
        self._prediction = configuration.longest_prediction
        self._time = SentenceTime()
        self._reports = AisReports(self._time)
        self._ships: dict[int, ShipHistory] = {}
        self._told = 0

    def take(self, line: bytes) -> list[PositionTracks]:
        """Take one line; return the pictures that are due."""
        try:
            self._take(read_sentence(line))
        except InputError as error:
            self.faults[str(error)] += 1
        return self._due()

    def take_time(self, stamp: int) -> list[PositionTracks]:
        """Take the time (ns) of something else that is heard; return the pictures that are due."""
        try:
            self._time.take_instant(seconds(stamp))
        except InputError as error:
            self.faults[str(error)] += 1
        return self._due()

    def _take(self, sentence: Sentence) -> None:
        if is_ais(sentence):
            self._take_ais(sentence)
            return
        report = own_ship_report(sentence)
        if report is not None and not math.isnan(report.time_of_day):
            self._time.take(report.time_of_day, report.day)
            self.used[report.format] += 1

    def _take_ais(self, sentence: Sentence) -> None:
        report = self._reports.take(sentence)
        self.used[sentence.format] += 1
        if report is None:
            return
        if not self._time.is_dated:
            raise InputError("an AIS report came before any date was known; it is not used")
        if self.datum is None:
            raise InputError(NO_DATUM)
        place = (np.array(report.latitude_deg), np.array(report.longitude_deg))
        if surface_distances(*place, self.datum) > FARTHEST:
            raise InputError(FAR)
        ship = self._ships.setdefault(report.mmsi, ShipHistory())
        ship.add(self._time.stamp(report.instant), report_state(report, self.datum))

    def _due(self) -> list[PositionTracks]:
        if not self._time.is_dated or self.datum is None:
            return []
        last = (self._time.stamp(self._time.now) - self._delay) // self._period
        if last < self._told - _MOST_AT_ONCE:  # the source began again
            self._told, self._ships = last, {}
        first = max(self._told + 1, last - _MOST_AT_ONCE + 1) if self._told else last
        pictures = [self._picture(number * self._period) for number in range(first, last + 1)]
        self._told = max(self._told, last)
        if pictures:
            self._forget(pictures[-1].stamp)
        return pictures

    def _picture(self, stamp: int) -> PositionTracks:
        known = {mmsi: ship.at(stamp, self._prediction) for mmsi, ship in self._ships.items()}
        rows = [(mmsi, one) for mmsi, one in known.items() if one is not None]
        status = (TrackStatus.CONFIRMED, TrackStatus.COASTED)
        return PositionTracks(
            stamp=stamp,
            id=np.array([mmsi for mmsi, _ in rows], np.uint64),
            status=np.array([status[one.is_predicted] for _, one in rows], np.uint8),
            source=np.full(len(rows), TrackSource.TRUTH, np.uint8),
            state=np.array([one.state for _, one in rows]).reshape(-1, 4),
            existence_probability=np.ones(len(rows)),
            next_stamp=stamp + self._period,
        )

    def _forget(self, stamp: int) -> None:
        oldest = stamp - nanoseconds(LONGEST_REST)
        self._ships = {m: ship for m, ship in self._ships.items() if ship.stamps[-1] >= oldest}
        for ship in self._ships.values():
            ship.forget_before(stamp)
