"""Track lists wait for the truth around them, so that a run is scored while it goes on."""

from __future__ import annotations

from abc import abstractmethod
from collections import deque
from collections.abc import Sequence
from typing import Any, Generic, Protocol, TypeVar

from sonar_tracking.evaluation.metrics.score_statistics import Periods
from sonar_tracking.evaluation.metrics.truth_samples import Sample, TruthSamples

KEPT_TRUTH = 1000
"""Samples of truth that wait for track lists of their time."""

AnyTracks = TypeVar("AnyTracks", bound=Sample)


class Truth(Protocol):
    """Truth of a run that tells what is true at an instant."""

    samples: TruthSamples[Any]

    def add(self, sample: Any) -> None:
        """Take one more sample, the next in time."""

    def at(self, stamp: int) -> Any:
        """Return what is true at an instant, ns; None = not known."""


class OnlineScore(Generic[AnyTracks]):
    """Scores each track list as soon as the truth at its stamp is known, and keeps neither.

    A subclass overrides :meth:`count`.

    Parameters
    ----------
    truth : Truth
        What is known of it so far.
    """

    def __init__(self, truth: Truth) -> None:
        self.truth = truth
        self.periods = Periods()
        self._waiting: deque[AnyTracks] = deque()
        self._counted = 0

    @property
    def is_known(self) -> bool:
        """Whether there were both lists and truth."""
        return len(self.periods) > 0 and len(self.truth.samples) > 0

    @abstractmethod
    def count(self, tracks: AnyTracks, truth: Any) -> None:
        """Count one list, against what is true at its stamp."""

    def add_truth(self, sample: Any) -> None:
        """Take one more sample of the truth, the next in time."""
        self.truth.add(sample)
        self._count_known()
        self.truth.samples.forget_before(self._counted, KEPT_TRUTH)

    def add_tracks(self, tracks: AnyTracks) -> None:
        """Take one more list, the next in time."""
        self.periods.add(tracks.stamp)
        self._waiting.append(tracks)
        self._count_known()

    def add_all(self, tracks: Sequence[AnyTracks]) -> None:
        """Take all lists of a run, against the truth that is known."""
        for entry in sorted(tracks, key=lambda entry: entry.stamp):
            self.periods.add(entry.stamp)
            self._waiting.append(entry)
        self.finish()

    def finish(self) -> None:
        """Count what still waits: there is no more truth."""
        while self._waiting:
            self._count_next()

    def _count_known(self) -> None:
        while self._waiting and self.truth.samples.reach(self._waiting[0].stamp):
            self._count_next()

    def _count_next(self) -> None:
        tracks = self._waiting.popleft()
        self._counted = tracks.stamp
        truth = self.truth.at(tracks.stamp)
        if truth is not None:
            self.count(tracks, truth)
