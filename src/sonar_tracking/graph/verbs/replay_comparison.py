"""Whether a replay has published what the recorded run had published."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.bags.storage.storage_file import BagMessage
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
        self._cut_off = bag.recovery is not None
        self.topics = set(self._recorded)

    def take(self, message: BagMessage) -> None:
        """Take a recorded message that is not played."""
        if message.topic in self._recorded:
            self._recorded[message.topic].add(message.data)

    def result(self) -> dict[str, str]:
        """Return what is to be said of each recorded output topic."""
        return {name: self._phrase(name) for name in self._recorded}

    def differs(self) -> bool:
        """Return whether any output is not what was recorded."""
        return any(not phrase.startswith("identical") for phrase in self.result().values())

    def _phrase(self, name: str) -> str:
        recorded, replayed = self._recorded[name], self._replayed[name]
        number = first_difference(recorded, replayed)
        if number is not None:
            return f"different from message {number} of {recorded.messages} on"
        if recorded.messages == replayed.messages:
            return f"identical: {recorded.messages} messages"
        if self._cut_off and recorded.messages < replayed.messages:
            return (
                f"identical as far as it was recorded: {recorded.messages} of "
                f"{replayed.messages} messages"
            )
        return f"different: {recorded.messages} messages recorded, {replayed.messages} replayed"
