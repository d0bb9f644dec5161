"""Lines over time: nothing is shifted, mixed between beams or hidden by thinning."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.display.line_record import MOST_LINES, draw_line_record, line_histories
from sonar_tracking.display.lofar_gram import (
    MOST_BEAMS,
    MOST_COLUMNS,
    MOST_ROWS,
    BeamGram,
    GramRows,
    draw_lofar_gram,
)
from sonar_tracking.records.lines import FrequencyLines, LofarRows

EPOCH = 1_767_225_600
SECOND = 1_000_000_000


def lines(second: int, ids: list[int], frequency: float = 300.0) -> FrequencyLines:
    n = len(ids)
    return FrequencyLines(
        stamp=(EPOCH + second) * SECOND,
        track_id=np.full(n, 4, np.uint64),
        arrival_angle=np.zeros(n),
        arrival_angle_variance=np.ones(n),
        line_id=np.array(ids, np.uint64),
        frequency=np.full(n, frequency),
        standard_deviation=np.full(n, 0.05),
        signal_to_noise_ratio=np.ones(n),
        integration_time=np.ones(n),
    )


def rows(second: int, beams: list[int], n_bins: int = 50, loud: int = 7) -> LofarRows:
    level = np.zeros((len(beams), n_bins), np.float32)
    level[:, loud] = 10.0 * np.array(beams)
    return LofarRows(
        stamp=(EPOCH + second) * SECOND,
        track_id=np.array(beams, np.uint64),
        first_frequency=100.0,
        bin_width=0.5,
        level_db=level,
        frame_id="own_ship/array",
    )


def beam_grams(entries: list[LofarRows], start: int) -> tuple[BeamGram, ...]:
    collected = GramRows()
    for entry in entries:
        collected.add(entry)
    return collected.grams(start)


def test_each_beam_has_its_rows_and_times() -> None:
    one, two = beam_grams([rows(0, [1, 2]), rows(1, [2]), rows(2, [2, 1])], EPOCH * SECOND)
    assert (one.track_id, two.track_id) == (1, 2)
    assert one.times.tolist() == [0.0, 2.0] and two.times.tolist() == [0.0, 1.0, 2.0]
    assert one.frequencies[7] == pytest.approx(103.5)
    np.testing.assert_allclose(one.levels_db[:, 7], 10.0, atol=1e-4)
    assert two.levels_db[1, 7] == pytest.approx(20.0, abs=1e-4)


def test_of_too_many_rows_neighbours_are_integrated() -> None:
    count = 2 * MOST_ROWS + 100
    (gram,) = beam_grams([rows(n, [n % 2 + 1]) for n in range(0, 2 * count, 2)], EPOCH * SECOND)
    assert MOST_ROWS // 2 <= len(gram.times) <= MOST_ROWS
    np.testing.assert_allclose(gram.levels_db[:, 7], 10.0, atol=1e-3)
    assert (np.diff(gram.times) > 0.0).all()
    mixed = GramRows()
    for n in range(MOST_ROWS + 1):
        entry = rows(n, [1])
        entry.level_db[:, 7] = 20.0 if n % 2 else -90.0
        mixed.add(entry)
    (gram,) = mixed.grams(EPOCH * SECOND)
    # The mean power of 100 and nothing is 50, 17 dB, and the first pair lies half a second in.
    assert gram.levels_db[0, 7] == pytest.approx(16.99, abs=0.01)
    assert gram.times[0] == pytest.approx(0.5)


def test_beams_without_end_are_not_kept_without_end() -> None:
    collected = GramRows()
    for beam in range(1, 10 * MOST_BEAMS):
        collected.add(rows(beam, [beam]))
    assert len(collected._rows) <= MOST_BEAMS + 1


def test_a_line_one_bin_wide_survives_the_thinning() -> None:
    n_bins, loud = 5 * MOST_COLUMNS, 4001
    (gram,) = beam_grams([rows(0, [1], n_bins, loud)], 0)
    assert len(gram.frequencies) <= MOST_COLUMNS
    strongest = int(np.argmax(gram.levels_db[0]))
    assert gram.levels_db[0, strongest] == pytest.approx(10.0, abs=1e-4)
    assert gram.frequencies[strongest] == pytest.approx(100.0 + 0.5 * loud, abs=2.0)


def test_the_lines_heard_most_are_kept() -> None:
    lists = [lines(second, [99, 7] if second < 3 else [7]) for second in range(5)]
    lists.append(lines(5, list(range(1000, 1000 + MOST_LINES))))
    histories = line_histories(lists, EPOCH * SECOND)
    assert len(histories) == MOST_LINES and {7, 99} <= set(histories)
    assert histories[7].tolist() == [[float(second), 300.0, 0.05] for second in range(5)]
    assert line_histories([lines(0, [1], np.nan)], 0) == {}


@pytest.mark.slow
@pytest.mark.parametrize("n_rows", [1, 5])
def test_pictures_are_drawn(tmp_path: Path, n_rows: int) -> None:
    lists = [lines(second, [7, 8]) for second in range(n_rows)]
    grams = beam_grams([rows(3 * (n // 3), [4]) for n in range(n_rows)], EPOCH * SECOND)
    draw_lofar_gram(grams, lists, EPOCH * SECOND, tmp_path / "gram.png", "a")
    draw_line_record(line_histories(lists, EPOCH * SECOND), tmp_path / "lines.png", "b")
    for name in ("gram.png", "lines.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
