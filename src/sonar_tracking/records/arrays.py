"""Arrays by the kind of their entries, as annotations name them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
"""Real numbers."""

ComplexArray = NDArray[np.complex128]
"""Complex numbers."""

BoolArray = NDArray[np.bool_]
"""Yes or no an entry."""

IntArray = NDArray[np.int64]
"""Whole numbers: counts, stamps, identifiers of tracks in memory."""

IndexArray = NDArray[np.intp]
"""Positions in another array."""

IdArray = NDArray[np.uint64]
"""Identifiers, as in the messages; 0 = none."""

CodeArray = NDArray[np.uint8]
"""Codes of a small set, such as the status of a track, as in the messages."""

RowArray = NDArray[np.uint32]
"""Rows of another list of the same message, as in the messages."""
