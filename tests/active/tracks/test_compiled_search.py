"""The compiled search for contacts in gates is the one in numpy, bit for bit."""

from __future__ import annotations

import shutil
import sysconfig
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks import pair_search
from sonar_tracking.active.tracks.compiled_search import in_gates
from sonar_tracking.active.tracks.contact_gating import SensorGeometry, predict_gates
from sonar_tracking.active.tracks.pair_search import find_pairs
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.searched_tables import GatedTracks, SearchedContacts
from sonar_tracking.active.tracks.track_bank import TrackBank
from tests.active.track_scene import bank_of, contacts_at

SENSOR = SensorGeometry(np.zeros(2), 80.0, 0.05, 1500.0)

needs_it = pytest.mark.skipif(
    pair_search.COMPILED is None, reason="no compiler was there: in numpy alone"
)


def crowded_scenes(
    generator: np.random.Generator, n_modes: int, delayed: bool
) -> tuple[TrackBank, PlacedContacts, tuple[SceneRows, SceneRows]]:
    """Return tracks and contacts of three scenes: one has none, in one gates are crowded."""
    n_tracks, n_contacts = (40, 3, 30), (200, 0, 150)
    bank = bank_of(generator.uniform(-2000.0, 2000.0, (sum(n_tracks), 2)).tolist(), n_modes)
    root = generator.normal(size=(*bank.mean.shape, 4)) * np.array([60.0, 40.0, 2.0, 3.0])[:, None]
    bank = replace(
        bank,
        mean=bank.mean + generator.normal(0.0, [20.0, 20.0, 5.0, 5.0], bank.mean.shape),
        covariance=root @ np.swapaxes(root, -1, -2),
    )
    positions = generator.uniform(-2000.0, 2000.0, (sum(n_contacts), 2))
    positions[250:] = bank.mean[45, 0, :2] + generator.normal(0.0, 40.0, (100, 2))
    positions[10] = positions[11]
    contacts = contacts_at(positions.tolist())
    root = generator.normal(0.0, 15.0, (len(positions), 2, 2))
    delay = generator.uniform(0.0, 3.0, len(positions)) * delayed
    covariance = root @ np.swapaxes(root, -1, -2) + np.eye(2)
    contacts = replace(contacts, covariance=covariance, delay=delay)
    return bank, contacts, (SceneRows(n_tracks), SceneRows(n_contacts))


@needs_it
@pytest.mark.parametrize("n_modes", [1, 3])
@pytest.mark.parametrize("delayed", [False, True])
@pytest.mark.parametrize("share_of_strict", [0.0, 0.5, 1.0])
def test_compiled_and_in_numpy_find_the_same_pairs(
    n_modes: int, delayed: bool, share_of_strict: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    generator = np.random.default_rng(5)
    bank, contacts, scenes = crowded_scenes(generator, n_modes, delayed)
    amplitudes = generator.exponential(size=len(contacts.distance)) + 1.0
    amplitudes[::17] = np.nan
    thresholds = np.where(generator.random(len(bank)) < share_of_strict, 3.0, 1.5)
    thresholds[::13] = np.nan
    given = (bank, predict_gates(bank, SENSOR), contacts, amplitudes, thresholds, scenes)
    compiled = find_pairs(*given)
    monkeypatch.setattr(pair_search, "COMPILED", None)
    plain = find_pairs(*given)
    assert len(plain.track) > 40
    assert compiled.track.tolist() == plain.track.tolist()
    assert compiled.contact.tolist() == plain.contact.tolist()


@needs_it
@pytest.mark.parametrize("delayed", [False, True])
def test_squared_distances_have_the_same_bits(delayed: bool) -> None:
    assert pair_search.COMPILED is not None
    bank, contacts, (of_tracks, heard) = crowded_scenes(np.random.default_rng(6), 1, delayed)
    unknown = np.full(len(bank), np.nan)
    moments = bank.moments() if delayed else bank.position_moments()
    gates = predict_gates(bank, SENSOR)
    tracks = GatedTracks(*moments, gates, bank.confirmed, unknown, of_tracks)
    searched = SearchedContacts(contacts, np.full(len(contacts.delay), np.nan), heard)
    pairs, squares, _ = in_gates(pair_search.COMPILED, tracks, searched, pair_search.BOX_SIZE)
    assert len(squares) > 40
    plain = pair_search._squared_distances(tracks, contacts, pairs)
    assert squares.tobytes() == plain.tobytes()


@pytest.mark.skipif(
    shutil.which("cc") is None or not Path(sysconfig.get_path("include"), "Python.h").is_file(),
    reason="no compiler is there, or no headers of Python",
)
def test_it_is_compiled_where_a_compiler_is() -> None:
    assert pair_search.COMPILED is not None


@needs_it
@pytest.mark.parametrize("wrong", [(2, 2, 1, 2), (1, 3, 1, 2), (1, 2, 2, 2), (1, 2, 1, 4)])
def test_buffers_of_another_size_are_refused(wrong: tuple[int, int, int, int]) -> None:
    assert pair_search.COMPILED is not None
    one, two = np.zeros(1), np.zeros(2)
    ends = np.array([1]), np.array([2])
    tables = (*ends, np.arange(2), two, two, one, one, one, one, np.zeros(4), np.zeros(4), one)
    buffers = (*tables, np.zeros(4), np.zeros(8), two, two)
    assert pair_search.COMPILED.search(buffers, (1, 2, 1, 2), 16.0, 1e-13, 64)
    with pytest.raises(ValueError, match="shape"):
        pair_search.COMPILED.search(buffers, wrong, 16.0, 1e-13, 64)
