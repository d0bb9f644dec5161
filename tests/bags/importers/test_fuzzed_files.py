"""Damaged files of every format end in a result or a sentence, soon, and lose nothing unsaid.

The same with a thousand of each: ``python -m tests.fuzzing.files``.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzzing.file_formats import FORMATS
from tests.fuzzing.files import fuzz

COUNT, SEED = 15, 7


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS)
def test_a_damaged_file_is_refused_or_its_losses_are_told(tmp_path: Path, name: str) -> None:
    if name in ("wav", "flac", "w64", "rf64", "aiff", "caf", "array.yaml"):
        pytest.importorskip("soundfile")
    found, first = fuzz(name, COUNT, SEED, tmp_path)
    assert not found, first
