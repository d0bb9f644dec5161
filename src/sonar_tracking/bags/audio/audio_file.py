"""A recorded audio file as every importer sees it, whatever its container."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from pathlib import Path

from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class BroadcastOrigin:
    """What the ``bext`` chunk of a file says of its begin.

    Attributes
    ----------
    instant : int
        Of the first sample, ns since 1970, taken as UTC.
    doubt : str
        A sentence if its two statements of the time contradict each other, else empty.
    """

    instant: int
    doubt: str = ""


@dataclass(frozen=True)
class AudioDescription:
    """What an audio file is.

    Attributes
    ----------
    path : Path
        The file.
    kind : str
        Container and kind of samples, in words.
    sample_rate : int
        Samples per second and channel.
    n_channels, n_samples : int
        Channels, and samples per channel that are there.
    may_be_not_a_number : bool
        Samples may be NaN: floating-point numbers, or what could not be decoded.
    notes : tuple of str
        Sentences: what the file says of itself that is not so, and what was made of it.
    origin : BroadcastOrigin, optional
        From the ``bext`` chunk.
    """

    path: Path
    kind: str
    sample_rate: int
    n_channels: int
    n_samples: int
    may_be_not_a_number: bool = False
    notes: tuple[str, ...] = field(default=())
    origin: BroadcastOrigin | None = None


class AudioFile(ABC):
    """An audio file that was opened; its samples are read piece by piece.

    Parameters
    ----------
    description : AudioDescription
        What it is.
    """

    def __init__(self, description: AudioDescription) -> None:
        self.description = description
        self.path = description.path
        self.sample_rate = description.sample_rate
        self.n_channels = description.n_channels
        self.n_samples = description.n_samples

    @property
    def seconds(self) -> float:
        """Length of what is there, s."""
        return self.n_samples / self.sample_rate

    @abstractmethod
    def samples(self, start: int, stop: int) -> FloatArray:
        """Return samples ``start`` to ``stop``, shape (n, n_channels), linear, full scale 1."""


_SHOWN_APART = 0.1
"""Difference of two lengths that tenths show, s."""


def length_note(path: Path, announced: float | None, held: float) -> str:
    """Return the sentence for a file that is not as long as it says, lengths in s.

    ``announced`` is None if the file does not say its length.
    """
    if announced is None:
        return (
            f"{path} does not say how long it is, as after a recorder that was not stopped in "
            f"order; the {held:.1f} s up to its end are used."
        )
    digits = 1 if abs(announced - held) >= _SHOWN_APART else 6
    told = f"it announces {announced:.{digits}f} s and holds {held:.{digits}f} s"
    if held < announced:
        return f"{path} is cut off: {told}; copy it again if the rest is wanted."
    return (
        f"{path} holds more than announced: {told}, as after a crash or beyond 4 GB; all of it is "
        "used."
    )
