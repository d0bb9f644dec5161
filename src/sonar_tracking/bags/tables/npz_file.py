"""Arrays of an npz file, or a sentence that says why there are none."""

from __future__ import annotations

import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.errors import ConfigurationError, shown

_DAMAGED = (
    OSError,
    ValueError,
    EOFError,
    KeyError,
    TypeError,
    SyntaxError,
    MemoryError,
    OverflowError,
    RuntimeError,
    NotImplementedError,
    zipfile.BadZipFile,
    zlib.error,
)
"""What damaged archives, and damaged headers of the arrays in them, raise."""

_BEGINS = (b"PK", b"\x93N")
"""Of an archive, and of a single array."""


def read_npz(path: Path | str) -> dict[str, NDArray[Any]]:
    """Return the arrays of an npz file by name, of any shape and unit.

    Parameters
    ----------
    path : Path or str
        The file; arrays of Python objects are not read.

    Raises
    ------
    ConfigurationError
        If it cannot be read.
    """
    try:
        # Of a damaged archive numpy would leave the file open.
        with Path(path).open("rb") as stream:
            if stream.read(2) not in _BEGINS:
                raise ValueError("it is no npz file; numpy.savez writes one")
            stream.seek(0)
            file = np.load(stream, allow_pickle=False)
            if isinstance(file, np.ndarray):
                raise ValueError("it holds a single array; write it with numpy.savez")
            arrays = {name: file[name] for name in file.files}
            raw = [name for name, array in arrays.items() if not isinstance(array, np.ndarray)]
            if raw:
                raise ValueError(f"{shown(raw[0])} in it is no array; write it with numpy.savez")
            return arrays
    except _DAMAGED as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise ConfigurationError(f"The file {path} cannot be read ({reason}).") from error
