"""When is which subspace wanted: stamps of blocks and sample times -> snapshot indices.

Snapshots are counted by a global index: that of the first block is its stamp divided by the sample
period, rounded; a contiguous block continues the count; after a gap the count jumps by what is
missing. Sample time k is the stamp k T; its window is the subspaces that end at the snapshots
``e - h L, ..., e, ..., e + h L`` with h = (P - 1) / 2 and e the multiple of L nearest to the
snapshot nearest to k T (the earlier one at a tie). For L = 1 this is the window
``k Ns - (P-1)/2 ... k Ns + (P-1)/2`` of Ryu, Park, Choi (2003), eq. 7. The sample covariance of a
sample time ends a fixed number of snapshots after the one nearest to k T.

All of it is integer arithmetic on nanoseconds, so that periods that are not a whole number of
nanoseconds neither drift nor depend on where a recording starts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from sonar_tracking.records.time import NANOSECONDS

_FINEST_DENOMINATOR = 1_000_000_000
_TIE_TOLERANCE = 1000
"""A tie is one within such a part of a period."""


def period_in_nanoseconds(period: float) -> Fraction:
    """Return a period in s as an exact number of ns, e.g. 0.1 s as 10^8 and not 10^8 + 5.6e-9."""
    return Fraction(period).limit_denominator(_FINEST_DENOMINATOR) * NANOSECONDS


def nearest_integer(value: Fraction) -> int:
    """Return the nearest integer, the smaller one at a tie."""
    return nearest_ratio(value.numerator, value.denominator)


def nearest_ratio(numerator: int, denominator: int) -> int:
    """Return the integer nearest to a ratio, the smaller one at a tie; the denominator positive.

    Fractions would find common divisors in it first, ten times for each block.
    """
    return -((denominator - 2 * numerator) // (2 * denominator))


@dataclass(frozen=True)
class BlockTiming:
    """Where a block of snapshots lies in time and in the global count.

    Attributes
    ----------
    stamp : int
        Instant of the first snapshot, ns.
    first_index : int
        Global index of the first snapshot.
    n_snapshots : int
        Snapshots in the block.
    sample_period : Fraction
        ns.
    """

    stamp: int
    first_index: int
    n_snapshots: int
    sample_period: Fraction

    @property
    def last_index(self) -> int:
        """Global index of the last snapshot."""
        return self.first_index + self.n_snapshots - 1

    @property
    def end_stamp(self) -> int:
        """Instant at which the next block is due, ns."""
        period = self.sample_period
        return self.stamp + nearest_ratio(self.n_snapshots * period.numerator, period.denominator)

    def nearest_index(self, stamp: int) -> int:
        """Return the global index of the snapshot nearest to an instant, the earlier at a tie.

        Stamps are rounded to ns, so that a tie is only known to within a small part of a period.
        """
        length, parts = self.sample_period.numerator, self.sample_period.denominator
        offset = _TIE_TOLERANCE * (stamp - self.stamp) * parts - length
        return self.first_index + nearest_ratio(offset, _TIE_TOLERANCE * length)

    def time_offset(self, index: float, stamp: int) -> float:
        """Return the instant of a snapshot relative to ``stamp``, s."""
        length, parts = self.sample_period.numerator, self.sample_period.denominator
        whole, part = index.as_integer_ratio()
        offset = (self.stamp - stamp) * parts * part + (whole - self.first_index * part) * length
        return offset / (parts * part * NANOSECONDS)

    def following(self, stamp: int, n_snapshots: int) -> tuple[BlockTiming, int]:
        """Return the timing of the next block and the number of snapshots missing before it.

        The number is negative when the block begins before the end of this one. Less than half a
        sample period of difference is jitter of the stamps.
        """
        period = self.sample_period
        late = (stamp - self.end_stamp) * period.denominator
        missing = nearest_ratio(late, period.numerator)
        first = self.last_index + 1 + missing
        return BlockTiming(stamp, first, n_snapshots, self.sample_period), missing


def first_timing(stamp: int, n_snapshots: int, sample_period: float) -> BlockTiming:
    """Return the timing of the first block of a run."""
    period = period_in_nanoseconds(sample_period)
    return BlockTiming(stamp, nearest_integer(stamp / period), n_snapshots, period)


@dataclass(frozen=True)
class Window:
    """The subspaces wanted for one sample time.

    Attributes
    ----------
    number : int
        k.
    stamp : int
        The sample time k T, ns.
    first, last : int
        Global indices of the snapshots after which the first and last subspace are taken.
    step : int
        Snapshots between subspaces.
    covariance_end : int
        Global index of the last snapshot of the sample covariance.
    """

    number: int
    stamp: int
    first: int
    last: int
    step: int
    covariance_end: int

    @property
    def complete(self) -> int:
        """Global index of the snapshot after which the estimate can be made."""
        return max(self.last, self.covariance_end)

    @property
    def indices(self) -> range:
        """Global indices of the snapshots after which subspaces are taken."""
        return range(self.first, self.last + 1, self.step)


@dataclass(frozen=True)
class SampleSchedule:
    """Sample times and their windows.

    Attributes
    ----------
    period : Fraction
        T, ns.
    n_subspaces : int
        P, odd.
    step : int
        L, snapshots between subspaces.
    lookahead : int
        Snapshots of the sample covariance after the one nearest to the sample time.
    """

    period: Fraction
    n_subspaces: int
    step: int
    lookahead: int = 0

    @property
    def reach(self) -> int:
        """Most snapshots between the one nearest to a sample time and a subspace of its window."""
        return (self.n_subspaces - 1) // 2 * self.step + self.step

    def stamp(self, number: int) -> int:
        """Return sample time ``number``, ns."""
        return nearest_ratio(number * self.period.numerator, self.period.denominator)

    def window(self, number: int, timing: BlockTiming) -> Window:
        """Return the window of sample time ``number`` in the count of ``timing``."""
        stamp = self.stamp(number)
        nearest = timing.nearest_index(stamp)
        centre = nearest_ratio(nearest, self.step) * self.step
        half = (self.n_subspaces - 1) // 2 * self.step
        end = nearest + self.lookahead
        return Window(number, stamp, centre - half, centre + half, self.step, end)

    def first_complete(self, timing: BlockTiming) -> int:
        """Return the number of the first sample time in or after a block with a whole window.

        A subspace of the first snapshot alone says nothing and does not count.
        """
        number = math.ceil((timing.stamp - timing.sample_period / 2) / self.period)
        while self.window(number, timing).first <= timing.first_index:
            number += 1
        return number

    def first_unfinished(self, timing: BlockTiming) -> int:
        """Return the number of the first sample time whose estimate needs a block."""
        begin = timing.stamp - max(self.reach, self.lookahead) * timing.sample_period
        number = math.floor(begin / self.period) - 1
        while self.window(number, timing).complete < timing.first_index:
            number += 1
        return number
