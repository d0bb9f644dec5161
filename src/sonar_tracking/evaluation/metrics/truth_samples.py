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

    def __init__(self, samples: Sequence[AnySample] = ()) -> None:
        by_stamp = {sample.stamp: sample for sample in samples}
        self._stamps: list[int] = []
        self._samples: list[AnySample] = []
        self._seen: dict[int, int] = {}
        for stamp in sorted(by_stamp):
            self.add(by_stamp[stamp])

    def add(self, sample: AnySample) -> None:
        """Take one more sample, the next in time."""
        if self._stamps and sample.stamp <= self._stamps[-1]:
            if sample.stamp < self._stamps[-1]:
                return
            self._samples[-1] = sample
        else:
            self._stamps.append(sample.stamp)
            self._samples.append(sample)
        for identifier in sample.id:
            self._seen.setdefault(int(identifier), sample.stamp)

    def __len__(self) -> int:
        return len(self._stamps)

    def reach(self, stamp: int) -> bool:
        """Return whether no later sample can change what is true at an instant, ns."""
        return bool(self._stamps) and self._stamps[-1] >= stamp

    def forget_before(self, stamp: int, most: int) -> None:
        """Drop what nobody asks for after an instant, ns, and all but so many of the latest."""
        unneeded = min(bisect_right(self._stamps, stamp) - 1, len(self._stamps) - 2)
        unneeded = max(unneeded, len(self._stamps) - most, 0)
        del self._stamps[:unneeded], self._samples[:unneeded]

    def first_seen(self) -> dict[int, int]:
        """Return the stamp (ns) of the first appearance of each target."""
        return dict(self._seen)

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
