"""What is missing of a recording: topics, times, and how far it can be compared with another."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace

from sonar_tracking.records.time import NANOSECONDS

MISSING_KEY = "sonar_tracking.missing"
"""Key in ``custom_data`` of a repaired bag of what the damaged one lacked."""


@dataclass(frozen=True)
class Loss:
    """Messages that were recorded and cannot be read.

    Attributes
    ----------
    topic : str
        Their topic; empty = any of the bag.
    messages : int
        How many; 0 = unknown.
    first, last : int or None
        They were logged between these times, ns; None = the begin, or the end, of the recording.
    intact_before : mapping of str to int
        By topic, the number of messages that were recorded before the first of them and are whole.
    """

    topic: str = ""
    messages: int = 0
    first: int | None = None
    last: int | None = None
    intact_before: Mapping[str, int] = field(default_factory=dict)

    def after(self, counts: Mapping[str, int]) -> Loss:
        """Return the loss in a file before which others hold messages."""
        names = {*counts, *self.intact_before}
        total = {n: counts.get(n, 0) + self.intact_before.get(n, 0) for n in names}
        return replace(self, intact_before=total)

    def renamed(self, names: Mapping[str, str]) -> Loss:
        """Return the loss with its topics called otherwise, by their names so far."""
        counts = {names.get(name, name): n for name, n in self.intact_before.items()}
        return replace(self, topic=names.get(self.topic, self.topic), intact_before=counts)


def losses_text(losses: Sequence[Loss], begin: int) -> str:
    """Return what is missing in words; ``begin`` is the log time of the first message, ns."""
    by_times: dict[str, list[Loss]] = {}
    for loss in losses:
        by_times.setdefault(_times(loss, begin), []).append(loss)
    return "; ".join(_text(times, together) for times, together in by_times.items())


def _text(times: str, losses: Sequence[Loss]) -> str:
    if len(losses) == 1 and losses[0].messages == 1:
        return f"1 message of {losses[0].topic or 'any topic'} missing{times}"
    counted = (f"{loss.messages or 'some'} of {loss.topic or 'any topic'}" for loss in losses)
    return f"messages missing{times}: {', '.join(dict.fromkeys(counted))}"


def _times(loss: Loss, begin: int) -> str:
    first = None if loss.first is None else f"{(loss.first - begin) / NANOSECONDS:.3f} s"
    last = None if loss.last is None else f"{(loss.last - begin) / NANOSECONDS:.3f} s"
    if first is None:
        return "" if last is None else f" until {last}"
    if last is None:
        return f" from {first} on"
    return f" at {first}" if first == last else f" between {first} and {last}"


def losses_to_json(losses: Sequence[Loss]) -> str:
    """Return the losses as one line of JSON."""
    return json.dumps([asdict(loss) for loss in losses], sort_keys=True)


def losses_from_json(text: str) -> list[Loss]:
    """Return what :func:`losses_to_json` wrote; one loss of anything, if it cannot be read."""
    try:
        return [_loss(values) for values in json.loads(text)]
    except (ValueError, TypeError, AttributeError, LookupError, RecursionError):
        return [Loss()]


def _loss(values: Mapping[str, object]) -> Loss:
    counts = values["intact_before"]
    numbers = [values[name] for name in ("first", "last") if values[name] is not None]
    numbers += [values["messages"], *(counts.values() if isinstance(counts, dict) else [None])]
    if not isinstance(values["topic"], str) or not all(isinstance(n, int) for n in numbers):
        raise ValueError("this is no loss")
    return Loss(**values)  # type: ignore[arg-type]
