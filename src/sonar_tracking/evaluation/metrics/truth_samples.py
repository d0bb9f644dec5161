"""Truth sampled at instants of its own, and the samples around the instant of a track list."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import Any, Generic, Protocol, TypeVar


class Sample(Protocol):
    """True state of all targets at one instant."""

    @property
    def stamp(self) -> int:
        """Instant, ns."""

    @property
    def id(self) -> Any:
        """Identifiers of the targets."""


AnySample = TypeVar("AnySample", bound=Sample)


class TruthSamples(Generic[AnySample]):
    """Truth of a run in order of time.

    Parameters
    ----------
    samples : sequence
        Of two with the same stamp the later one counts.
    """

    def __init__(self, samples: Sequence[AnySample]) -> None:
        by_stamp = {sample.stamp: sample for sample in samples}
        self._stamps = sorted(by_stamp)
        self._samples = [by_stamp[stamp] for stamp in self._stamps]

    def first_seen(self) -> dict[int, int]:
        """Return the stamp (ns) of the first appearance of each target."""
        seen: dict[int, int] = {}
        for sample in self._samples:
            for identifier in sample.id:
                seen.setdefault(int(identifier), sample.stamp)
        return seen

    def around(self, stamp: int) -> tuple[AnySample, AnySample | None] | None:
        """Return the last sample at or before an instant and the one after it.

        There is none after it if the instant is that of a sample, or lies beyond the last one by
        no more than the last two are apart; farther away truth does not reach: None.
        """
        index = bisect_right(self._stamps, stamp) - 1
        if index < 0:
            return None
        before = self._samples[index]
        if before.stamp == stamp:
            return before, None
        if index + 1 < len(self._samples):
            return before, self._samples[index + 1]
        reach = before.stamp - self._samples[index - 1].stamp
        return (before, None) if stamp - before.stamp <= reach else None
