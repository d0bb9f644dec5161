"""What the orchestration keeps of each topic it sees: count and digests."""

from __future__ import annotations

from sonar_tracking.bags.contents.digest import STEP_BYTES, CanonicalDigest

_TOGETHER, _KEPT_BYTES = 32, 1_000_000
"""Most messages, and bytes, that wait: digested together they take half of the time, since code and
data are in the cache of the processor."""


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
        self._pending: list[bytes] = []
        self._pending_bytes = 0
        self._steps = bytearray()
        self.messages = 0

    def add(self, data: bytes) -> None:
        """Add one serialised message."""
        self.messages += 1
        self._pending.append(data)
        self._pending_bytes += len(data)
        if len(self._pending) >= _TOGETHER or self._pending_bytes >= _KEPT_BYTES:
            self._digest_pending()

    @property
    def steps(self) -> bytearray:
        """Begin of the digest after every message, if that is kept."""
        self._digest_pending()
        return self._steps

    def hexdigest(self) -> str:
        """Return the digest of all messages so far."""
        self._digest_pending()
        return self._digest.hexdigest()

    def _digest_pending(self) -> None:
        for data in self._pending:
            self._digest.add(data)
            if self._keep_steps:
                self._steps += self._digest.step()
        self._pending.clear()
        self._pending_bytes = 0


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
