"""Whether a replay has published what the recorded run had published."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from sonar_tracking.bags.contents.earlier_layouts import earlier_layout
from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.storage_file import BagMessage
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.graph.orchestration.topic_record import TopicRecord, first_difference


class ReplayComparison:
    """Collects the recorded outputs while the inputs are played, and compares at the end.

    Parameters
    ----------
    bag : Bag
        The recording.
    replayed : mapping of str to TopicRecord
        What the replay publishes, by topic.
    played : set of str
        Topics that are played from the bag: there is nothing to compare them with.

    Attributes
    ----------
    topics : set of str
        The recorded outputs it wants to see.
    """

    def __init__(
        self, bag: Bag, replayed: Mapping[str, TopicRecord], played: Collection[str]
    ) -> None:
        self._recorded = {
            name: TopicRecord(topic.type_name, keep_steps=True)
            for name, topic in bag.topics.items()
            if topic.role == "output"
            and name in replayed
            and name not in played
            # Somebody else's recorder lists topics on which it has heard nothing.
            and (topic.message_count or bag.recording)
        }
        self._replayed = replayed
        self._earlier = {
            name for name in self._recorded if earlier_layout(bag.topics[name].definition)
        }
        self._losses = [loss for loss in bag.losses if loss.topic in {"", *played, *self._recorded}]
        self._played = frozenset(played)
        self.topics = set(self._recorded)

    def take(self, message: BagMessage) -> None:
        """Take a recorded message that is not played."""
        if message.topic in self._recorded:
            self._recorded[message.topic].add(message.data)

    def result(self) -> dict[str, str]:
        """Return what is to be said of each recorded output topic."""
        return {name: self._phrase(name) for name in self._recorded}

    def differs(self) -> bool:
        """Return whether any output is not what was recorded, where that can be compared."""
        return any(phrase.startswith("different") for phrase in self.result().values())

    def _phrase(self, name: str) -> str:
        if name in self._earlier:
            return "not comparable: its messages had fewer fields when they were recorded"
        recorded, replayed = self._recorded[name], self._replayed[name]
        number = first_difference(recorded, replayed)
        losses = [loss for loss in self._losses if loss.topic in {"", name, *self._played}]
        comparable = min(
            (loss.intact_before.get(name, 0) for loss in losses), default=recorded.messages
        )
        if number is not None and number <= comparable:
            return f"different from message {number} of {recorded.messages} on"
        if number is None and recorded.messages == replayed.messages:
            return f"identical: {recorded.messages} messages"
        if not losses or replayed.messages < comparable:
            return f"different: {recorded.messages} messages recorded, {replayed.messages} replayed"
        if number is None and comparable == recorded.messages:
            return (
                f"identical as far as it was recorded: {recorded.messages} of "
                f"{replayed.messages} messages"
            )
        return _incomparable(comparable, recorded.messages, losses)


def _incomparable(comparable: int, recorded: int, losses: Sequence[Loss]) -> str:
    """Return why the messages after the first ``comparable`` ones say nothing."""
    lacking = ", ".join(sorted({loss.topic or "any topic" for loss in losses}))
    reason = f"messages of {lacking} are missing in the recording"
    if not comparable:
        return f"not comparable: {reason}"
    return f"identical for {comparable} of {recorded} messages, then not comparable: {reason}"
