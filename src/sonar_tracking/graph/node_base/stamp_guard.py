"""Checks of the stamps of one input topic: what is used, ignored, set aside, or starts afresh.

Pure stamps, no ROS. Streams promise rising stamps and, with ``next_stamp``, when the next message
is due. The guard holds them to it, so that everything behind it may rely on order. A single message
that does not go on with the data so far, whoever sent it, moves nothing: it is set aside until
others follow that go on with it, or the data go on without it.
"""

from __future__ import annotations

from collections import deque
from dataclasses import replace

from sonar_tracking.errors import shown
from sonar_tracking.graph.node_base.stamp_candidate import (
    NEEDED,
    NEEDED_OTHERWISE,
    OUTLASTS,
    Candidate,
    Doubt,
)
from sonar_tracking.graph.node_base.stamp_check import StampCheck, Verdict, seconds_text
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS, UNKNOWN_STAMP

TOLERANCE = 1_000
"""Rounding of stamps that is not a gap or an overlap, ns."""

_REMEMBERED = 256

REORDERED_MESSAGES = 5
"""Of data slower than reset_after so many may come late before that is a new beginning."""

PLAUSIBLE_GAP = 2.5
"""Usual intervals since the message before, up to which a single message is believed."""

PLAUSIBLE_INTERVAL = 20
"""Usual intervals until the next message, up to which a single announcement is believed."""

ESTABLISHED = 3
"""Messages in order, which a few others do not outvote at once."""


class StampGuard:
    """Holds one topic to rising stamps from one sensor.

    Parameters
    ----------
    topic : str
        Named in the sentences.
    reset_after : int
        A step back by more than this many ns, and by more than a few of the usual intervals
        between messages, is a new beginning; a smaller one is an error.
    """

    def __init__(self, topic: str, reset_after: int) -> None:
        self._topic = topic
        self._reset_after = reset_after
        self.reset()

    def reset(self) -> None:
        """Forget everything received so far."""
        self.last_stamp = UNKNOWN_STAMP
        self.expected = UNKNOWN_STAMP
        self._sensor_id: str | None = None
        self._recent: deque[int] = deque(maxlen=_REMEMBERED)
        self._held: list[Candidate] = []
        self._begun_again: int | None = None
        self._ignored = 0

    def has_begun(self, stamp: int) -> bool:
        """Tell whether the latest message belongs to data that begin at a stamp, ns."""
        return abs(self.last_stamp - stamp) <= self._largest_step_back()

    def expect_new_beginning(self, stamp: int) -> None:
        """Tell that another input of the node has begun again at a stamp, ns.

        What still comes from before is ignored, as long as it can be told from the new data. What
        was set aside is forgotten: its messages are judged once more.
        """
        self._held = []
        if self.last_stamp == UNKNOWN_STAMP or self.expected == END_OF_DATA:
            self.reset()
        elif not self.has_begun(stamp):
            self._begun_again = stamp
            self._ignored = 0

    def check(self, stamp: int, next_stamp: int, sensor_id: str, usable: bool = True) -> StampCheck:
        """Judge one message and, unless it is refused, remember it.

        Parameters
        ----------
        stamp, next_stamp : int
            Of the message, ns.
        sensor_id : str
            Of the message.
        usable : bool
            Whether its content is: one that is not proves nothing about time.

        Returns
        -------
        StampCheck
            On RESET the guard has already forgotten what was before.
        """
        if self._begun_again is not None:
            if self._is_from_before(stamp, self._begun_again):
                self._ignored += 1
                sentence = f"{self._named(stamp)} was ignored: it is from before a new beginning."
                return StampCheck(Verdict.DUPLICATE, sentence)
            self.reset()
        judged = self._judge(stamp, next_stamp, sensor_id)
        if not usable and (isinstance(judged, Candidate) or not self._is_due(stamp)):
            sentence = f"{self._named(stamp)} was rejected: it is not usable, nor is it due."
            return StampCheck(Verdict.REJECT, sentence)
        if isinstance(judged, Candidate):
            judged = self._weigh(judged)
        elif judged.verdict in (Verdict.ACCEPT, Verdict.GAP):
            # What is missing may have been set aside, if too late a next stamp was announced.
            fills = self._fills_gap(judged.verdict, stamp, sensor_id)
            judged = replace(judged, confirms=fills, dropped=0 if fills else len(self._held))
        if judged.verdict in (Verdict.ACCEPT, Verdict.GAP, Verdict.RESET):
            judged = self._remember(judged, stamp, next_stamp, sensor_id, usable)
        return judged

    def _is_from_before(self, stamp: int, begun_again: int) -> bool:
        """Tell whether a message goes on with the old data, and no queue is longer than it."""
        goes_on = stamp > self.last_stamp and stamp > begun_again + self._reset_after
        return goes_on and self._ignored < _REMEMBERED

    def _is_due(self, stamp: int) -> bool:
        """Tell whether a message comes when the next one is to come."""
        if self.last_stamp == UNKNOWN_STAMP:
            return True
        if self.expected not in (UNKNOWN_STAMP, END_OF_DATA):
            return abs(stamp - self.expected) <= TOLERANCE
        return 2 * (stamp - self.last_stamp) <= 3 * self._usual_interval()

    def _remember(
        self, judged: StampCheck, stamp: int, next_stamp: int, sensor_id: str, usable: bool
    ) -> StampCheck:
        held, self._held = self._held, []
        if judged.verdict is Verdict.RESET:
            self.reset()
        if judged.confirms:
            self._recent.extend(each.stamp for each in held)
        usual = self._usual_interval()
        self._recent.append(stamp)
        self.last_stamp = stamp
        self._sensor_id = sensor_id
        far = usual and next_stamp - stamp > PLAUSIBLE_INTERVAL * usual
        believed = usable and (not far or next_stamp == END_OF_DATA)
        self.expected = next_stamp if believed else UNKNOWN_STAMP
        return replace(judged, next_stamp=self.expected)

    def _judge(self, stamp: int, next_stamp: int, sensor_id: str) -> StampCheck | Candidate:
        at = self._named(stamp)
        if stamp <= UNKNOWN_STAMP:
            return StampCheck(
                Verdict.REJECT,
                f"{self._topic}: a message without a stamp was rejected; "
                "the sender must set header.stamp to the instant of the data.",
            )
        if next_stamp != UNKNOWN_STAMP and next_stamp < stamp:
            return StampCheck(
                Verdict.REJECT,
                f"{at} was rejected: its next_stamp {seconds_text(next_stamp)} is earlier; "
                "the sender must set next_stamp to the stamp of the message after it, or zero.",
            )
        if self.last_stamp == UNKNOWN_STAMP:
            return StampCheck(Verdict.ACCEPT)
        if stamp == self.last_stamp:
            if next_stamp != self.expected:
                self.expected = UNKNOWN_STAMP  # two announcements: neither is believed
            return self._duplicate(at)
        if self.expected == END_OF_DATA:
            return self._judge_after_end(stamp, next_stamp, sensor_id)
        back = self.last_stamp - stamp
        if back > self._largest_step_back():
            return Candidate(
                stamp,
                next_stamp,
                sensor_id,
                Doubt.BEGINNING,
                f"{self._topic}: stamps went back by {back / NANOSECONDS:.3f} s to "
                f"{seconds_text(stamp)} (a looped recording or a restarted source?)",
            )
        if sensor_id != self._sensor_id:
            return Candidate(
                stamp,
                next_stamp,
                sensor_id,
                Doubt.OTHER_SENSOR,
                f"{at} comes from sensor '{shown(sensor_id)}', but the data so far come from "
                f"'{shown(self._sensor_id or '')}'; give each sensor its own namespace",
            )
        return self._judge_order(stamp, next_stamp, sensor_id, at)

    def _judge_after_end(
        self, stamp: int, next_stamp: int, sensor_id: str
    ) -> StampCheck | Candidate:
        ahead = stamp - self.last_stamp
        if sensor_id == self._sensor_id and 0 < ahead <= PLAUSIBLE_GAP * self._usual_interval():
            return StampCheck(
                Verdict.ACCEPT,
                f"{self._topic}: the end of the data was announced, but they go on at "
                f"{seconds_text(stamp)}; the sender must announce it with its last message only.",
            )
        return Candidate(
            stamp,
            next_stamp,
            sensor_id,
            Doubt.AFTER_END,
            f"{self._topic}: data begin again at {seconds_text(stamp)} after the end of the data",
        )

    def _usual_interval(self) -> int:
        """Return the mean interval between messages, ns; 0 = not known yet."""
        intervals = len(self._recent) - 1
        if intervals > 0:
            return (self._recent[-1] - self._recent[0]) // intervals
        announced = self.expected not in (UNKNOWN_STAMP, END_OF_DATA)
        return self.expected - self.last_stamp if announced else 0

    def _largest_step_back(self) -> int:
        """Return by how much a late message may be late, ns."""
        return max(self._reset_after, REORDERED_MESSAGES * self._usual_interval())

    def _judge_order(
        self, stamp: int, next_stamp: int, sensor_id: str, at: str
    ) -> StampCheck | Candidate:
        if stamp < self.last_stamp:
            if stamp in self._recent:
                return self._duplicate(at)
            back = (self.last_stamp - stamp) / NANOSECONDS
            return Candidate(
                stamp,
                next_stamp,
                sensor_id,
                Doubt.EARLIER,
                f"{at} is {back:.3f} s earlier than the one before; the sender must publish in "
                "order (a step back by more than "
                f"{self._largest_step_back() / NANOSECONDS:g} s, parameter reset_after or a few "
                "messages, is taken as a new beginning)",
            )
        if self.expected != UNKNOWN_STAMP and stamp < self.expected - TOLERANCE:
            return Candidate(
                stamp,
                next_stamp,
                sensor_id,
                Doubt.OVERLAP,
                f"{at} is earlier than {seconds_text(self.expected)}, which the message before it "
                "announced as the next stamp; the sender must not publish overlapping data (is "
                "there a second publisher?)",
            )
        return self._judge_gap(stamp, next_stamp, sensor_id)

    def _judge_gap(self, stamp: int, next_stamp: int, sensor_id: str) -> StampCheck | Candidate:
        """Judge a message that comes when it is due, or later."""
        usual = self._usual_interval()
        since, announced = self.last_stamp, self.expected != UNKNOWN_STAMP
        if announced:
            since = self.expected
            if stamp <= since + TOLERANCE:
                return StampCheck(Verdict.ACCEPT)
        gap = stamp - since
        sentence = (
            f"{self._topic}: {gap / NANOSECONDS:.3f} s of data are missing between "
            f"{seconds_text(since)} and {seconds_text(stamp)}; "
            "check the source and whether messages are lost on the way."
        )
        largest = PLAUSIBLE_GAP * usual
        if next_stamp == END_OF_DATA:
            # Nothing follows that could tell.
            largest = max(PLAUSIBLE_INTERVAL * usual, self._reset_after)
        if usual and stamp - self.last_stamp > largest:
            return Candidate(stamp, next_stamp, sensor_id, Doubt.GAP, sentence.removesuffix("."))
        return StampCheck(Verdict.GAP, sentence) if announced else StampCheck(Verdict.ACCEPT)

    def _weigh(self, candidate: Candidate) -> StampCheck:
        """Judge a message that does not go on with the data by those that came before it."""
        if any(
            (each.stamp, each.sensor_id) == (candidate.stamp, candidate.sensor_id)
            for each in self._held
        ):
            return self._duplicate(self._named(candidate.stamp))
        goes_on = self._held and self._goes_on(self._held[-1], candidate)
        dropped = 0 if goes_on else len(self._held)
        self._held = [*self._held, candidate] if goes_on else [candidate]
        first = self._held[0]
        if not self._outvotes(first.doubt):
            sentence = f"{candidate.sentence}; it was set aside until the next ones tell."
            return StampCheck(Verdict.HOLD, sentence, dropped=dropped)
        if first.doubt in (Doubt.GAP, Doubt.OVERLAP):
            return StampCheck(Verdict.GAP, f"{first.sentence}.", confirms=True)
        return StampCheck(Verdict.RESET, f"{first.sentence}; everything was reset.", confirms=True)

    def _fills_gap(self, verdict: Verdict, stamp: int, sensor_id: str) -> bool:
        """Tell whether what was set aside leads up to a message that is in order."""
        if not self._held or self._held[0].doubt is not Doubt.OVERLAP:
            return False
        last = self._held[-1]
        leads = verdict is Verdict.GAP or abs(last.next_stamp - stamp) <= TOLERANCE
        return leads and last.stamp < stamp and last.sensor_id == sensor_id

    def _goes_on(self, before: Candidate, candidate: Candidate) -> bool:
        alike = candidate.doubt is before.doubt or (
            before.doubt is Doubt.OVERLAP and candidate.doubt is Doubt.GAP
        )
        return alike and candidate.sensor_id == before.sensor_id and candidate.stamp > before.stamp

    def _outvotes(self, doubt: Doubt) -> bool:
        """Tell whether the messages set aside are believed, and not the data before them."""
        agree = len(self._held)
        if agree > 1 and self._held[-1].next_stamp == END_OF_DATA:
            agree = NEEDED_OTHERWISE  # nothing follows that could agree
        if agree < NEEDED.get(doubt, NEEDED_OTHERWISE):
            return False
        if doubt not in OUTLASTS or len(self._recent) < ESTABLISHED:
            return True
        span = self._held[-1].stamp - self._held[0].stamp
        return span > self._largest_step_back() or len(self._held) >= _REMEMBERED

    def _named(self, stamp: int) -> str:
        return f"{self._topic}: the message stamped {seconds_text(stamp)}"

    def _duplicate(self, at: str) -> StampCheck:
        return StampCheck(
            Verdict.DUPLICATE,
            f"{at} was ignored: it was already received (is something publishing twice?).",
        )
