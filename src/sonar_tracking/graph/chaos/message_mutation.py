"""Changes good messages into malformed ones, field by field."""

from __future__ import annotations

import array
import copy
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

REALS = (
    *(math.nan, math.inf, -math.inf, 0.0, -0.0, 1.0, -1.0, 1e-300, 5e-324, 1e-9, 1e4, -1e4),
    *(1e6, 1e9, 1e12, 1e30, 1e150, 1e200, -1e200, 1e300, 1.7e308, math.pi, 2 * math.pi, -7.0),
)
TEXTS = (
    "",
    "nobody",
    "map",
    "x" * 10_000,
    "\x1b[31mfailed\x1b[0m",
    "\n\n",
    "é\u202e",
    "own_ship/a",
)
SECOND = 1_000_000_000
TIMES = (
    *(-1, 1, SECOND // 100, SECOND // 10, SECOND, 9 * SECOND, -9 * SECOND, 100 * SECOND),
    *(10**6 * SECOND, 10**9 * SECOND, -(10**9) * SECOND),
)
LATEST = 2_147_483_647


def mutated(message: Any, generator: np.random.Generator) -> Any:
    """Return a copy of a message in which one to three things are not as they should be."""
    if generator.random() < 0.02:
        return type(message)()
    changed = copy.deepcopy(message)
    for _ in range(int(generator.integers(1, 4))):
        owner, name = _pick(changed, generator)
        _change(owner, name, generator)
    return changed


def _pick(message: Any, generator: np.random.Generator) -> tuple[Any, str]:
    places = list(_places(message))
    return places[int(generator.integers(len(places)))]


def _places(message: Any) -> Iterator[tuple[Any, str]]:
    """Return every field, down to the numbers, with the message that holds it."""
    for name in message.get_fields_and_field_types():
        value = getattr(message, name)
        if hasattr(value, "nanosec") or not hasattr(value, "get_fields_and_field_types"):
            yield message, name
        else:
            yield from _places(value)


def _change(owner: Any, name: str, generator: np.random.Generator) -> None:
    value = getattr(owner, name)
    if hasattr(value, "nanosec"):
        _change_time(value, generator)
    elif isinstance(value, bool):
        setattr(owner, name, not value)
    elif isinstance(value, float):
        setattr(owner, name, _real(generator, value))
    elif isinstance(value, str):
        setattr(owner, name, TEXTS[int(generator.integers(len(TEXTS)))])
    elif isinstance(value, int):
        setattr(owner, name, _integer(owner, name, generator))
    elif isinstance(value, np.ndarray):
        value[int(generator.integers(value.size))] = _real(generator, 1.0)
    elif isinstance(value, array.array):
        setattr(owner, name, _column(value, generator))
    elif isinstance(value, list | bytes):
        setattr(owner, name, value * int(generator.integers(0, 3)))


def _change_time(value: Any, generator: np.random.Generator) -> None:
    choice = int(generator.integers(len(TIMES) + 3))
    stamp = value.sec * SECOND + value.nanosec
    if choice < len(TIMES):
        stamp += TIMES[choice]
    else:
        stamp = (0, SECOND, LATEST * SECOND)[choice - len(TIMES)]
    stamp = min(max(stamp, -LATEST * SECOND), LATEST * SECOND)
    value.sec, value.nanosec = stamp // SECOND, stamp % SECOND


def _real(generator: np.random.Generator, value: float) -> float:
    if generator.random() < 0.3:
        return value * float(generator.choice([-1.0, 1e-6, 1e-3, 0.5, 2.0, 1e3, 1e6, 1e12]))
    return REALS[int(generator.integers(len(REALS)))]


def _integer(owner: Any, name: str, generator: np.random.Generator) -> int:
    kind = owner.get_fields_and_field_types()[name]
    bits = int(kind.removeprefix("u").removeprefix("int"))
    lowest = 0 if kind.startswith("u") else -(2 ** (bits - 1))
    highest = 2**bits - 1 if kind.startswith("u") else 2 ** (bits - 1) - 1
    value = getattr(owner, name)
    choices = [lowest, highest, 0, 1, 2, 3, 7, 255, value + 1, value - 1, 2 * value, 2**31 - 1]
    return min(max(int(generator.choice(np.array(choices, object))), lowest), highest)


def _column(value: array.array[Any], generator: np.random.Generator) -> array.array[Any]:
    kind = int(generator.integers(7))
    if kind == 0 or not value:
        return array.array(value.typecode, [1] * int(generator.integers(0, 4)))
    if kind == 1:
        return value[:-1]
    if kind == 2:
        return value + value[: int(generator.integers(1, len(value) + 1))]
    if kind == 3:
        return array.array(value.typecode)
    if kind == 4:
        return value * 2
    numbers = [_entry(value.typecode, generator, value[0]) for _ in range(1 + 2 * (kind == 6))]
    changed = array.array(value.typecode, value)
    for number in numbers:
        changed[int(generator.integers(len(changed)))] = number
    if kind == 6 and generator.random() < 0.3:
        changed = array.array(value.typecode, [numbers[0]] * len(changed))
    return changed


def _entry(code: str, generator: np.random.Generator, value: Any) -> Any:
    if code in "df":
        number = _real(generator, value)
        return number if code == "d" or not abs(number) > 3e38 else math.inf
    size = array.array(code).itemsize
    highest = 2 ** (8 * size) - 1 if code.isupper() else 2 ** (8 * size - 1) - 1
    return int(generator.choice(np.array([0, 1, 2, 3, highest, 200 % (highest + 1)], object)))
