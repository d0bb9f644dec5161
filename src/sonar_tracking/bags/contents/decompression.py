"""Decompression within bounds: no file makes more of itself than is stated here.

A few kilobytes can be made to decompress to any size. Nothing is decompressed past the bound of its
kind; what exceeds it is refused with a sentence.
"""

from __future__ import annotations

import errno
import io
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from sonar_tracking.errors import ConfigurationError

ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
"""First bytes of anything compressed by zstd; a serialised message begins with zero."""

LARGEST_FILE = 8 << 30
LARGEST_CHUNK = 128 << 20
LARGEST_MESSAGE = 128 << 20
"""Most bytes of a file, a chunk of an MCAP file, and a message."""

_LARGEST_RATIO = 200
"""What sensor data never compress by, not even those of a sensor that is switched off."""

_BLOCK = 1 << 20


class DamagedDataError(Exception):
    """Compressed data cannot be decompressed; the text says why."""


class TooLargeError(ConfigurationError):
    """Compressed data exceed their bound."""


def largest_total(compressed_bytes: int) -> int:
    """Return the most bytes that this many may decompress to, taken together."""
    return min(2 * LARGEST_MESSAGE + _LARGEST_RATIO * compressed_bytes, LARGEST_FILE)


def decompressed(data: bytes, compression: str, limit: int, what: str) -> bytes:
    """Return compressed data as they were.

    Parameters
    ----------
    data : bytes
        Compressed, in one frame or several.
    compression : str
        ``"zstd"`` or ``"lz4"``.
    limit : int
        Most bytes the result may have.
    what : str
        What the data are, for errors, e.g. ``"a message in my_bag"``.

    Raises
    ------
    DamagedDataError
        If the data are damaged or cut off.
    TooLargeError
        If the result would be larger than the limit.
    ConfigurationError
        If the library that decompresses them is not installed.
    """
    blocks, size = [], 0
    for block in _blocks(io.BytesIO(data), _decompressor(compression)):
        size += len(block)
        if size > limit:
            raise TooLargeError(
                f"{what} would decompress to more than {_mebibytes(limit)}; "
                "if that is right, record it again without compression."
            )
        blocks.append(block)
    return b"".join(blocks)


@contextmanager
def decompressed_file(path: Path) -> Iterator[tuple[Path, str]]:
    """Decompress a file by zstd into a temporary one, which is deleted afterwards.

    What was opened meanwhile can be read on: the system keeps the data of an open file.

    Parameters
    ----------
    path : Path
        The compressed file.

    Yields
    ------
    tuple of Path and str
        The temporary file, and why it is not whole (empty where it is).

    Raises
    ------
    TooLargeError
        If it would have more than :data:`LARGEST_FILE` bytes.
    ConfigurationError
        If there is no room for it, or the library is not installed.
    """
    with tempfile.TemporaryDirectory(prefix="sonar_tracking-") as folder:
        plain = Path(folder) / path.stem
        try:
            damage = _decompress_file(path, plain)
        except OSError as error:
            if error.errno not in (errno.ENOSPC, errno.EDQUOT):
                raise
            raise ConfigurationError(
                f"{path} is compressed, and {tempfile.gettempdir()} has no room for what is in "
                "it; make room, or set TMPDIR to a folder with more."
            ) from error
        yield plain, damage


def _decompress_file(path: Path, plain: Path) -> str:
    """Write the decompressed file; return why it is not whole."""
    size = 0
    limit = largest_total(path.stat().st_size)
    with path.open("rb") as source, plain.open("wb") as target:
        try:
            for block in _blocks(source, _decompressor("zstd")):
                size += len(block)
                if size > limit:
                    raise TooLargeError(
                        f"{path} would decompress to more than {_mebibytes(limit)}; if "
                        f"that is right, decompress it first: unzstd {path.name}."
                    )
                target.write(block)
        except DamagedDataError as reason:
            return str(reason)
    return ""


def _blocks(source: BinaryIO, new: Callable[[], Any]) -> Iterator[bytes]:
    """Yield what a stream of frames decompresses to, as far as it can be decompressed."""
    decompressor, inside, rest = new(), False, b""
    while data := rest or source.read(_BLOCK):
        inside, rest = True, b""
        block = _decompressed_block(decompressor, data)
        while block:
            yield block
            if decompressor.eof or decompressor.needs_input:
                break
            block = _decompressed_block(decompressor, b"")
        if decompressor.eof:
            rest = decompressor.unused_data or b""
            decompressor, inside = new(), False
    if inside:
        raise DamagedDataError("its compressed data are cut off")


def _decompressed_block(decompressor: Any, data: bytes) -> bytes:
    try:
        block: bytes = decompressor.decompress(data, _BLOCK)
    except Exception as error:
        # zstd and lz4 raise errors of their own, and RuntimeError.
        raise DamagedDataError(f"its compressed data are damaged ({error})") from error
    return block


def _decompressor(compression: str) -> Callable[[], Any]:
    try:
        if compression == "lz4":
            import lz4.frame  # type: ignore[import-untyped]

            return lz4.frame.LZ4FrameDecompressor
        from backports import zstd

        return zstd.ZstdDecompressor
    except ImportError as error:
        raise ConfigurationError(
            f"The bag is compressed with {compression}; "
            f"pip install {'lz4' if compression == 'lz4' else 'backports.zstd'}."
        ) from error


def _mebibytes(size: int) -> str:
    return f"{size >> 20} MiB"
