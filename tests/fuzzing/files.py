"""Damages files of every format that is imported: ``python -m tests.fuzzing.files [FORMAT ...]``.

``inspect`` and the import of each damaged file must end within ten seconds of processor time, with
a result or a sentence; and where there is less in the result than in the file, something is said.
What is found is printed with the seed and number that repeat it; the exit code is 1 then.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path
from types import FrameType

import numpy as np

from sonar_tracking.bags.importers.file_inspection import inspect_file
from sonar_tracking.errors import ConfigurationError
from tests.fuzzing.file_formats import FORMATS, Format, made

LONGEST = 10.0
"""That a file may take, s of processor time."""

_HANGS = 120
"""After so many seconds of the wall clock a file is given up."""

_MOST_MEMORY = 4 << 30
"""Bytes."""


class HangError(Exception):
    """A file is read for too long."""


def damaged(data: bytes, generator: np.random.Generator) -> bytes:
    """Return a file with bytes changed, cut out, doubled, zeroed, added, or its end missing.

    Half of the changes are in its first 200 bytes, where headings and headers are.
    """
    changed = bytearray(data)
    for _ in range(generator.integers(1, 5)):
        reach = min(len(changed), 200) if generator.random() < 0.5 else len(changed)
        place, length = int(generator.integers(0, reach)), int(generator.integers(1, 40))
        match generator.integers(0, 8):
            case 0 | 1:
                changed[place] = int(generator.integers(0, 256))
            case 2:
                changed[place] ^= 1 << int(generator.integers(0, 8))
            case 3:
                del changed[place : place + length]
            case 4:
                changed[place:place] = changed[place : place + length]
            case 5:
                changed[place : place + length] = bytes(len(changed[place : place + length]))
            case 6:
                changed[place:place] = generator.bytes(length)
            case _:
                changed = changed[: max(place, 1)]
        changed = changed or bytearray(b"\n")
    return bytes(changed)


def outcome(form: Format, path: Path, folder: Path) -> str:
    """Return what is wrong with how a damaged file is taken; empty = nothing.

    Parameters
    ----------
    form : Format
        Its format.
    path : Path
        The file.
    folder : Path
        For what its import makes; emptied afterwards.
    """
    begin = time.process_time()
    found = ""
    signal.alarm(_HANGS)
    try:
        found = _silent_loss(form, path, folder)
    except HangError:
        found = "hangs"
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        found = f"{type(error).__name__} in {Path(place.filename).name}:{place.lineno}: {error}"
    finally:
        signal.alarm(0)
        shutil.rmtree(folder / "bag", ignore_errors=True)
    taken = time.process_time() - begin
    return found or (f"takes {taken:.0f} s" if taken > LONGEST else "")


def _silent_loss(form: Format, path: Path, folder: Path) -> str:
    """Return whether less than the file holds is imported without a word; empty = no."""
    try:
        inspect_file(path)
    except ConfigurationError as error:
        if not str(error).strip():
            return "inspect says nothing"
    try:
        count, said = form.take(path, folder)
    except ConfigurationError as error:
        form.refused.append(str(error))
        return "" if str(error).strip() else "the import says nothing"
    held = form.holds(path.read_bytes())
    return f"{count} of {held} are taken, and nothing is said" if count < held and not said else ""


def fuzz(name: str, count: int, seed: int, folder: Path) -> tuple[Counter[str], dict[str, int]]:
    """Damage a file of a format many times; return what was found, and the number of the first.

    Parameters
    ----------
    name : str
        Of the format.
    count, seed : int
        How many, and the root of all randomness.
    folder : Path
        For the files.
    """
    form = FORMATS[name]
    original = made(name, folder)
    found: Counter[str] = Counter()
    first: dict[str, int] = {}
    path = folder / form.file
    path.parent.mkdir(exist_ok=True)
    for number in range(count):
        path.write_bytes(damaged(original, np.random.default_rng([seed, number])))
        wrong = outcome(form, path, folder)
        if wrong:
            kind = wrong if wrong[0].isalpha() else wrong.lstrip("0123456789")
            found[kind] += 1
            first.setdefault(kind, number)
    return found, first


def _hang(number: int, frame: FrameType | None) -> None:
    raise HangError


def main() -> int:
    """Run the fuzzer and print what was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzzing.files", description=__doc__)
    parser.add_argument("formats", nargs="*", metavar="FORMAT", help=", ".join(FORMATS))
    parser.add_argument("--count", type=int, default=1000, help="damaged files of each format")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    signal.signal(signal.SIGALRM, _hang)
    resource.setrlimit(resource.RLIMIT_AS, (_MOST_MEMORY, _MOST_MEMORY))
    is_wrong = False
    for name in given.formats or FORMATS:
        begin = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            found, first = fuzz(name, given.count, given.seed, Path(folder))
        is_wrong |= bool(found)
        summary = {
            "format": name,
            "seed": given.seed,
            "damaged": given.count,
            "refused": len(FORMATS[name].refused),
            "found": {f"{kind} (first: {first[kind]})": n for kind, n in found.most_common()},
            "cpu_s": round(time.process_time() - begin, 1),
            "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
        }
        print(json.dumps(summary), flush=True)
    return int(is_wrong)


if __name__ == "__main__":
    sys.exit(main())
