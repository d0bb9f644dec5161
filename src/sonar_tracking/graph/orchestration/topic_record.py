"""What the orchestration keeps of each topic it sees: count and digests."""

from __future__ import annotations

from sonar_tracking.bags.storage.digest import STEP_BYTES, CanonicalDigest


class TopicRecord:
    """Count and digest of the messages of one topic, in order of publication.

    Parameters
    ----------
    type_name : str
        Full name of the message type.
    keep_steps : bool
        Keep the begin of the digest after every message, to find the first one that differs.
    """

    def __init__(self, type_name: str, keep_steps: bool = False) -> None:
        self._digest = CanonicalDigest(type_name)
        self._keep_steps = keep_steps
        self.messages = 0
        self.steps = bytearray()

    def add(self, data: bytes) -> None:
        """Add one serialised message."""
        self._digest.add(data)
        self.messages += 1
        if self._keep_steps:
            self.steps += self._digest.step()

    def hexdigest(self) -> str:
        """Return the digest of all messages so far."""
        return self._digest.hexdigest()


def first_difference(recorded: TopicRecord, replayed: TopicRecord) -> int | None:
    """Return the number (from 1) of the first message that differs, None if none does.

    A shorter record is equal to the beginning of a longer one: compare the counts apart.
    """
    common = min(len(recorded.steps), len(replayed.steps))
    for begin in range(0, common, STEP_BYTES):
        end = begin + STEP_BYTES
        if recorded.steps[begin:end] != replayed.steps[begin:end]:
            return end // STEP_BYTES
    return None
