"""What of a bag is replayed, and under which names (no ROS import)."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field, replace
from itertools import chain, repeat

from sonar_tracking.bags.contents.earlier_layouts import earlier_layout
from sonar_tracking.bags.contents.storage_file import BagMessage
from sonar_tracking.bags.contents.topic_names import TopicNames
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_settings import NodeSettings
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.records.time import NANOSECONDS


@dataclass(frozen=True)
class Selection:
    """Names and part, with the meaning they have in ``ros2 bag play``.

    Attributes
    ----------
    names : TopicNames
        Names of the recorded topics in the graph.
    start_offset : float
        Where to begin, s after the first message of the bag.
    duration : float
        How much to replay, s of the recording; infinity = to its end.
    loop : bool
        Begin again at the end, until somebody interrupts it.
    """

    names: TopicNames = field(default_factory=TopicNames)
    start_offset: float = 0.0
    duration: float = math.inf
    loop: bool = False

    @property
    def whole(self) -> bool:
        """Whether every message is replayed, once: the outputs are then those recorded."""
        return not self.loop and self.start_offset == 0.0 and math.isinf(self.duration)

    def check(self, options: RunOptions) -> None:
        """Refuse times that are none, and to record what begins again and again.

        Raises
        ------
        ConfigurationError
            If that is so.
        """
        if not 0.0 <= self.start_offset < math.inf:
            raise ConfigurationError(
                f"--start-offset is {self.start_offset:g}; give seconds after the begin of the "
                "bag, 0 or more."
            )
        if not self.duration > 0.0:
            raise ConfigurationError(
                f"--duration is {self.duration:g}; give seconds of the recording, above 0."
            )
        if self.loop and options.record is not None:
            raise ConfigurationError(
                "--loop begins again and again, and a bag whose time goes back cannot be used: "
                "leave out --record or --loop."
            )

    def of(self, bag: Bag) -> Bag:
        """Return what is selected of a bag.

        Raises
        ------
        ConfigurationError
            If there is nothing, or a name fits no topic.
        """
        named = bag.named(self.names)
        if self.start_offset == 0.0 and math.isinf(self.duration):
            return named
        return named.part(self.start_offset, self.duration)

    def check_loop(self, bag: Bag, settings: NodeSettings) -> None:
        """Refuse a loop so short that nodes take its new begin for messages out of order.

        Raises
        ------
        ConfigurationError
            If that is so.
        """
        if not self.loop:
            return
        times = [message.log_time for message in bag.messages()]
        length = (times[-1] - times[0]) / NANOSECONDS
        needed = max(float(str(values.get("reset_after", 0.0))) for values in settings.values())
        if length <= needed:
            raise ConfigurationError(
                f"--loop: {length:.1f} s are replayed, and nodes take stamps that go back by up to "
                f"{needed:g} s for disorder: replay more, or give --parameters with a smaller "
                "reset_after."
            )

    def messages(self, bag: Bag, topics: Collection[str]) -> Iterable[BagMessage]:
        """Return the messages of what :meth:`of` gave, again and again in a loop.

        They are in the layout that is installed now, whatever it was when they were recorded.
        """
        if not self.loop:
            return _installed_messages(bag, topics)
        return chain.from_iterable(_installed_messages(bag, topics) for _ in repeat(None))


def _installed_messages(bag: Bag, topics: Collection[str]) -> Iterable[BagMessage]:
    # Commands may be given in a replay of a recording that has none.
    recorded = [name for name in topics if name in bag.topics]
    layouts = {name: earlier_layout(bag.topics[name].definition) for name in recorded}
    if not any(layouts.values()):
        return bag.messages(topics)
    return (_translated(message, layouts[message.topic]) for message in bag.messages(topics))


def _translated(message: BagMessage, layout: Callable[[bytes], bytes] | None) -> BagMessage:
    return message if layout is None else replace(message, data=layout(message.data))
