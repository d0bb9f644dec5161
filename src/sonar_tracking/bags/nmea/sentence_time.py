"""The time line of a stream of sentences: times of day, and dates from some of them."""

from __future__ import annotations

import math

from sonar_tracking.errors import InputError
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS, nanoseconds

DAY = 86_400.0
"""s."""

LONGEST_STEP, LONGEST_BACK = 3600.0, 60.0
"""On and back in time from one sentence to the next, s; beyond it the next one must agree."""

LEAPS = "its time leaps, and the next one does not agree; it is not used"


class SentenceTime:
    """Instants of sentences, in s from a midnight that a date may tell only later.

    A time of day more than half a day before the last one is of the next day. An instant that leaps
    by hours is believed if the next one does so, too.

    Attributes
    ----------
    now : float
        Instant of the last sentence that had a time, s; NaN = none had.
    """

    def __init__(self) -> None:
        self.now = math.nan
        self._first_day: int | None = None
        self._doubted = math.nan

    @property
    def is_dated(self) -> bool:
        """Whether a date has been told."""
        return self._first_day is not None

    def take(self, time_of_day: float, day: int | None = None) -> float:
        """Return the instant of a sentence, s.

        Parameters
        ----------
        time_of_day : float
            UTC, s.
        day : int, optional
            Days since 1970-01-01, if it tells them.

        Raises
        ------
        InputError
            If it leaps; two in a row that agree are believed.
        """
        first = self._first_day
        if day is not None and first is None:
            first = day - round((self._continued(time_of_day) - time_of_day) / DAY)
        if day is None or first is None:
            instant = self._continued(time_of_day)
        else:
            instant = (day - first) * DAY + time_of_day
        self._believe(instant)
        self._first_day = first
        return instant

    def take_instant(self, instant: float) -> float:
        """Return the instant of a sentence whose time since 1970 (s) is told, s."""
        day = math.floor(instant / DAY)
        return self.take(instant - day * DAY, day)

    def advance(self, instant: float) -> None:
        """Take an instant of which only the second was told, if it is later than all others, s."""
        self.now = max(self.now, instant)

    def stamp(self, instant: float, day_without_date: int = 0) -> int:
        """Return an instant as a stamp.

        Parameters
        ----------
        instant : float
            s, as :meth:`take` returned it.
        day_without_date : int
            Taken for the first day if none was told, days since 1970-01-01.

        Returns
        -------
        int
            ns, between 1970 and 2038.
        """
        first = day_without_date if self._first_day is None else self._first_day
        stamp = first * round(DAY) * NANOSECONDS + nanoseconds(instant)
        return min(max(stamp, 1), END_OF_DATA - 1)

    def _believe(self, instant: float) -> None:
        """Take an instant for the present, s; one that leaps only after another one that did."""
        doubted, self._doubted = self._doubted, math.nan
        near = math.isnan(self.now) or -LONGEST_BACK <= instant - self.now <= LONGEST_STEP
        follows = doubted <= instant and (instant - doubted <= LONGEST_STEP or doubted > self.now)
        if not (near or follows):
            self._doubted = instant
            raise InputError(LEAPS)
        self.now = instant

    def _continued(self, time_of_day: float) -> float:
        if math.isnan(self.now):
            return time_of_day
        day = math.floor(self.now / DAY)
        since = self.now - day * DAY
        if time_of_day < since - 0.5 * DAY:
            day += 1
        elif time_of_day > since + 0.5 * DAY:
            day -= 1
        return day * DAY + time_of_day
