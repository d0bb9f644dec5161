"""Recordings whose bytes are flipped, cut, inserted and removed, and what is still read of them.

``python -m tests.bags.storage.bag_fuzzing BAG --cases 1000`` does so with a recorded bag.
"""

from __future__ import annotations

import argparse
import random
import shutil
import statistics
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError

Message = tuple[str, int, bytes]
Damage = Callable[[bytes, random.Random], bytes]


@dataclass(frozen=True)
class Outcome:
    """What was read of a damaged bag.

    Attributes
    ----------
    kept : float
        Share of the messages that are as they were recorded.
    different : int
        Messages that were never recorded like this.
    said : str
        What is said of the damage; empty = nothing.
    refused : bool
        Whether the bag was not opened.
    seconds : float
        How long it took.
    """

    kept: float
    different: int
    said: str
    refused: bool
    seconds: float


def flip(data: bytes, generator: random.Random) -> bytes:
    """Return the data with one byte changed."""
    damaged = bytearray(data)
    damaged[generator.randrange(len(data))] ^= generator.randrange(1, 256)
    return bytes(damaged)


def cut(data: bytes, generator: random.Random) -> bytes:
    """Return the data up to any byte."""
    return data[: generator.randrange(len(data))]


def insert(data: bytes, generator: random.Random) -> bytes:
    """Return the data with a few bytes more."""
    place = generator.randrange(len(data))
    return data[:place] + generator.randbytes(generator.randrange(1, 20)) + data[place:]


def remove(data: bytes, generator: random.Random) -> bytes:
    """Return the data with a few bytes less."""
    place = generator.randrange(len(data))
    return data[:place] + data[place + generator.randrange(1, 20) :]


def overwrite(data: bytes, generator: random.Random) -> bytes:
    """Return the data with a run of bytes overwritten, as a bad block of a disk does."""
    place, length = generator.randrange(len(data)), generator.choice((64, 512, 4096))
    filler = generator.choice((bytes(length), generator.randbytes(length)))
    return data[:place] + filler + data[place + length :]


DAMAGES: tuple[Damage, ...] = (flip, cut, insert, remove, overwrite)


def messages_of(bag: Path) -> Counter[Message]:
    """Return all messages that are read of a bag, with how often."""
    return Counter((m.topic, m.log_time, m.data) for m in read_bag(bag).messages())


def outcome(bag: Path, recorded: Counter[Message]) -> Outcome:
    """Read a damaged bag and compare its messages with those recorded."""
    start = time.monotonic()
    try:
        opened = read_bag(bag)
        read = Counter((m.topic, m.log_time, m.data) for m in opened.messages())
    except ConfigurationError as error:
        return Outcome(0.0, 0, str(error), True, time.monotonic() - start)
    seconds = time.monotonic() - start
    kept = (read & recorded).total() / max(recorded.total(), 1)
    different = (read - recorded).total()
    return Outcome(kept, different, opened.recovery or "", False, seconds)


def fuzzed(
    bag: Path, damages: Sequence[Damage], cases: int, seed: int, folder: Path
) -> list[tuple[str, Outcome]]:
    """Damage copies of a bag, one file of it at a time, in proportion to their sizes.

    Parameters
    ----------
    bag : Path
        The bag, whole: a directory.
    damages : sequence of callable
        Taken in turn.
    cases, seed : int
        How many copies, and of which random numbers.
    folder : Path
        Where the copies go.

    Returns
    -------
    list of tuple
        Of each case, what was done in words, and what came of it.
    """
    recorded = messages_of(bag)
    generator = random.Random(seed)
    files = sorted(bag.iterdir())
    sizes = [file.stat().st_size for file in files]
    copy = folder / "damaged" / bag.name
    shutil.copytree(bag, copy)
    results = []
    for number in range(cases):
        damage = damages[number % len(damages)]
        (file,) = generator.choices(files, sizes)
        (copy / file.name).write_bytes(damage(file.read_bytes(), generator))
        case = f"{damage.__name__} in {file.name}, case {number} of seed {seed}"
        results.append((case, outcome(copy, recorded)))
        shutil.copyfile(file, copy / file.name)
    shutil.rmtree(folder / "damaged")
    return results


def table(results: Sequence[tuple[str, Outcome]]) -> str:
    """Return the figures of many cases in words."""
    kept = [result.kept for _, result in results]
    return (
        f"{len(results)} cases: kept {statistics.median(kept):.4f} (median), {min(kept):.4f} "
        f"(worst); {sum(result.different for _, result in results)} messages differ; "
        f"{sum(result.refused for _, result in results)} refused; "
        f"{sum(not result.said for _, result in results)} without a word; "
        f"slowest {max(result.seconds for _, result in results):.2f} s"
    )


def main() -> None:
    """Damage a recorded bag and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bag", type=Path)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    names = {damage.__name__: damage for damage in DAMAGES}
    parser.add_argument("--damages", nargs="+", choices=names, default=["flip"])
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        damages = [names[name] for name in given.damages]
        results = fuzzed(given.bag, damages, given.cases, given.seed, Path(folder))
    print(table(results))
    for case, result in sorted(results, key=lambda entry: entry[1].kept)[:5]:
        print(f"  {result.kept:.4f} {case}: {result.said[:300]}")


if __name__ == "__main__":
    main()
