"""Protects which contacts a track looks at: those in its gate, and where a hard turn leads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.particle_tracks import ParticleTracks
from sonar_tracking.active.ping_gating import PlacedPing, gate_ping
from sonar_tracking.active.tracks.acceleration_levels import AGILE, AccelerationLevels
from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.motion_modes import MotionModes
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.track_bank import TrackBank
from tests.active.track_scene import bank_of, contacts_at

LEVELS = AccelerationLevels(8.0)
FAST = np.full((LEVELS.n_modes, 2), 20.0)
STRAIGHT = np.array([1e-6, 1.0 - 4e-6, 1e-6, 1e-6, 1e-6])
"""Mode probabilities of a track that has never turned."""


def ships(*places: list[float]) -> TrackBank:
    """Return confirmed tracks that have never turned, as predicted over ten seconds."""
    bank = bank_of(list(places), n_modes=LEVELS.n_modes)
    return replace(
        bank,
        covariance=bank.covariance + LEVELS.noise(FAST, 10.0),
        mode_probability=np.tile(STRAIGHT, (len(bank), 1)),
    )


def paired(
    bank: TrackBank, places: list[list[float]], modes: MotionModel = LEVELS
) -> list[tuple[int, int]]:
    """Return the pairs of tracks and contacts at places."""
    configuration = ContactTrackerConfiguration()
    model = DetectionModel(0.9, 10.0, False, 0.0, np.nan, np.nan, np.nan, 1e-8, 10_000.0)
    ping = PlacedPing(
        stamp=1,
        next_stamp=2,
        placed=contacts_at(places),
        amplitudes=np.full(len(places), np.nan),
        contact_rows=SceneRows((len(places),)),
        models=[model],
        sensors=[SensorGeometry(np.zeros(2), 10.0, 0.002, 0.0)],
        reaches=[10_000.0],
    )
    particles = ParticleTracks(configuration, used=False)
    tracks = SceneRows((len(bank),))
    pairs = gate_ping(bank, tracks, ping, configuration, [particles], modes).pairs
    assert np.all(np.diff(pairs.track) >= 0)
    return list(zip(pairs.track.tolist(), pairs.contact.tolist(), strict=True))


def test_a_hard_turn_is_not_out_of_the_gate_for_being_improbable() -> None:
    """0.3 g over ten seconds leads 147 m aside; that of straight motion ends at 123 m."""
    bank = ships([3000.0, 0.0])
    assert paired(bank, [[3000.0, 0.0], [3000.0, 147.0], [3000.0, 600.0]]) == [(0, 0), (0, 1)]


def test_published_motion_keeps_to_the_gate_of_the_mixture() -> None:
    modes = MotionModes(3, 0.0015, initial_speed_deviation=1.5)
    bank = bank_of([[3000.0, 0.0]], n_modes=3)
    assert paired(bank, [[3000.0, 0.0], [3000.0, 147.0]], modes) == [(0, 0)]


def test_a_contact_in_the_gate_of_another_track_is_that_ones() -> None:
    bank = ships([3000.0, 0.0], [3000.0, 180.0])
    assert paired(bank, [[3000.0, 147.0]]) == [(1, 0)]
    assert paired(bank, [[3000.0, 0.0], [3000.0, -135.0]]) == [(0, 0), (0, 1), (1, 1)]


@pytest.mark.parametrize("confirmed", [True, False])
def test_candidates_look_into_their_gates_only(confirmed: bool) -> None:
    bank = replace(ships([3000.0, 0.0]), confirmed=np.array([confirmed]))
    assert paired(bank, [[3000.0, 147.0]]) == ([(0, 0)] if confirmed else [])


def test_the_hardest_mode_is_the_agile_one() -> None:
    assert LEVELS.widest_mode == AGILE == np.argmax(LEVELS.noise(FAST, 10.0)[:, 2, 2])


def test_a_track_at_the_sensor_does_not_explain_whatever_points_at_it() -> None:
    """Clutter of a cell has no density there: each contact of a short range points at it."""
    model = DetectionModel(0.9, 10.0, False, 0.0, 9.2, 1e-4, 2.0, np.nan, 10_000.0)
    bank = ships([0.5, 0.0], [3000.0, 0.0])
    ping = PlacedPing(
        stamp=1,
        next_stamp=2,
        placed=contacts_at([[30.0, 0.0], [3010.0, 0.0]]),
        amplitudes=np.full(2, np.nan),
        contact_rows=SceneRows((2,)),
        models=[model],
        sensors=[SensorGeometry(np.zeros(2), 10.0, 0.002, 0.0)],
        reaches=[10_000.0],
    )
    configuration = ContactTrackerConfiguration()
    particles = ParticleTracks(configuration, used=False)
    gating = gate_ping(bank, SceneRows((2,)), ping, configuration, [particles], LEVELS)
    density = gating.of_ping(ping).evidence.clutter_density
    # At the track, no nearer than a metre; at the contact where that is the nearer one.
    assert density == pytest.approx([1e-4 / 2.0, 1e-4 / (2.0 * 3000.0)], rel=0.01)
