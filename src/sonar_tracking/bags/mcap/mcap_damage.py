"""What is damaged in an MCAP file, and which messages are missing for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from mcap.records import Channel

from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.mcap.mcap_summary import McapSummary

_PLACES_NAMED = 3


class DamageReport:
    """Takes what a scan finds, in the order of the file.

    Parameters
    ----------
    summary : McapSummary
        What the closing part of the file says.

    Attributes
    ----------
    numbered : bool
        Whether the messages of each topic are numbered without gaps, as our writer does.
    places : int
        How many places are damaged.
    finished : bool
        Whether the end of the data was found.
    """

    def __init__(self, summary: McapSummary) -> None:
        self.numbered = False
        self.finished = False
        self._summary = summary
        self._places: list[str] = []
        self.places = 0
        self._bytes = 0
        self._counts: Counter[int] = Counter()
        self._recorded: dict[int, int] = {}
        self._unverified = 0
        self._latest: int | None = None
        self._before: tuple[int | None, Counter[int]] | None = None
        self._after: int | None = None
        self._may_lack = False

    @property
    def damaged(self) -> bool:
        """Whether anything was found."""
        return self._before is not None

    def note(self, start: int, end: int, reason: str) -> None:
        """Take that the bytes from ``start`` to ``end`` are of no use."""
        self._bytes += max(end - start, 0)
        self.places += 1
        self._may_lack = True
        self._say(reason)

    def lose(self, channel: int, length: int, reason: str) -> None:
        """Take that a message of a chunk is not what was written, in so many bytes of the file."""
        self._recorded[channel] = self._recorded.get(channel, 0) + 1
        self._bytes += length
        self.places += reason not in self._places
        self._say(reason)

    def orphan(self, position: int) -> None:
        """Take that nothing says of which topic the message at ``position`` is."""
        self._may_lack = True
        self.places += 1
        self._say(f"a message at byte {position} belongs to no topic")

    def take(self, channel: int, sequence: int, log_time: int, verified: bool) -> None:
        """Take that a message is whole."""
        if self._after is None and self._before is not None:
            self._after = log_time if self._latest is None else max(log_time, self._latest)
        self._latest = log_time if self._latest is None else max(self._latest, log_time)
        self._counts[channel] += 1
        self._recorded[channel] = sequence + 1
        self._unverified += not verified

    def unlike_checksum(self) -> None:
        """Take that some byte of the file is damaged that no other checksum speaks of."""
        self._say("its checksum does not fit")

    def end(self, size: int) -> None:
        """Take that there is no more."""
        if not self._summary.closed:
            if self.finished:
                self._say("its closing part is damaged")
            elif not any("it ends at" in place for place in self._places):
                self._say(f"it ends at byte {size} without its closing part")
        elif self._summary.message_counts is not None and not self.damaged and self._lost():
            self._say("messages that its closing part counts are missing")

    def text(self) -> str:
        """Return what is damaged, in words; empty if nothing is."""
        said = list(self._places)
        if self.places > len(said):
            said.append(f"{self.places} places are damaged")
        if self._bytes:
            said.append(f"{self._bytes:,} bytes are of no use")
        if said and self._unverified:
            said.append(f"{self._unverified} messages have no checksum and may be altered")
        return "; ".join(said)

    def losses(self, channels: Mapping[int, Channel]) -> list[Loss]:
        """Return the messages that are missing.

        Parameters
        ----------
        channels : mapping
            Those of the file by number.
        """
        if self._before is None:
            return []
        first, before = self._before
        intact = {_topic(channels, number): count for number, count in before.items()}
        lost = self._lost()
        losses = [
            Loss(_topic(channels, number), count, first, self._after, intact)
            for number, count in lost.items()
        ]
        counted = self._summary.message_counts is not None or self.numbered
        whole_end = self.finished or self._summary.closed
        if (not counted and self._may_lack) or (self.numbered and not whole_end):
            losses.append(Loss("", 0, first, self._after, intact))
        return losses

    def _lost(self) -> dict[int, int]:
        """Return how many messages are missing, by channel, as far as they are counted."""
        recorded = self._summary.message_counts
        if recorded is None:
            recorded = self._recorded if self.numbered else {}
        lost = {number: count - self._counts[number] for number, count in recorded.items()}
        return {number: count for number, count in lost.items() if count > 0}

    def _say(self, reason: str) -> None:
        if self._before is None:
            self._before = (self._latest, Counter(self._counts))
        self._after = None
        room = len(self._places) < _PLACES_NAMED or "it ends at" in reason
        if room and reason not in self._places:
            self._places.append(reason)


def _topic(channels: Mapping[int, Channel], number: int) -> str:
    """Return the name of a topic, empty where its description is lost."""
    return channels[number].topic if number in channels else ""
