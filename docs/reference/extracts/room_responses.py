"""Make the measured responses that the study room-array reads, from the data set rs-mnmf.

python room_responses.py rs-mnmf/data/sources responses.npz
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat, wavfile

SOURCES = (1, 2, 3, 4, 5, 8, 9)
SECONDS = 0.3
SPACING = 0.03


def extract(folder: Path) -> dict[str, Any]:
    """Return the first 0.3 s of the responses from seven sources to the 32 elements."""
    recordings = [wavfile.read(folder / f"rir_source_{source}.wav") for source in SOURCES]
    rate = recordings[0][0]
    location = loadmat(folder / "source_location.mat")["sourceLocation"]
    n_elements = recordings[0][1].shape[1]
    return {
        "rir": np.stack([samples[: round(SECONDS * rate)].T for _, samples in recordings]),
        "rir_scale": 2.0**-15,
        "fs_hz": rate,
        "source_id": np.array(SOURCES),
        "source_xz_m": location[np.array(SOURCES) - 1],
        "mic_xz_m": np.stack([np.zeros(n_elements), SPACING * np.arange(n_elements)], axis=1),
    }


if __name__ == "__main__":
    np.savez_compressed(sys.argv[2], **extract(Path(sys.argv[1])))
