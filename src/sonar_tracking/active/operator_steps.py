"""What an operator does to the tracks of a scene, between two pings: start, end, merge.

A track that is ended is reported once more, as terminated. Where its target goes on to return
echoes, their contacts start candidates again, under new identifiers.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.active.contacts.contact_positions import IDENTITY, PlacedContacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.scene_memory import SceneMemory
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.track_bank import TrackBank, new_target_modes
from sonar_tracking.active.tracks.track_management import (
    ListedTracks,
    list_tracks,
    start_candidates,
)
from sonar_tracking.errors import InputError

PLACE_DEVIATION = 100.0
"""Of the place that an operator points at, m."""

FARTHEST = 1e7
"""Coordinate of such a place at most, m."""


def start_track(
    scene: SceneMemory,
    configuration: ContactTrackerConfiguration,
    modes: MotionModel,
    position: tuple[float, float],
) -> None:
    """Start a confirmed track of unknown velocity.

    Parameters
    ----------
    scene : SceneMemory
        Changed.
    configuration : ContactTrackerConfiguration
        Says what is confirmed.
    modes : MotionModel
        Of new targets.
    position : tuple of float
        x and y in ``map``, m.

    Raises
    ------
    InputError
        If no ping has come yet, or that is no place; nothing has changed then.
    """
    if scene.last is None:
        raise InputError("no ping has come yet; repeat it when there was one.")
    if not all(np.isfinite(value) and abs(value) <= FARTHEST for value in position):
        raise InputError(
            f"the place is x = {position[0]:g} m, y = {position[1]:g} m; give coordinates in map, "
            f"of at most {FARTHEST:g} m."
        )
    place = PlacedContacts(
        position=np.array([position], np.float64),
        covariance=PLACE_DEVIATION**2 * IDENTITY[None],
        distance=np.zeros(1),
        delay=np.zeros(1),
    )
    begun = start_candidates(
        place,
        np.array([configuration.confirmation_probability]),
        scene.last.stamp,
        scene.next_id,
        modes,
        new_target_modes(scene.bank, modes),
        scene.new_detection,
    )
    # Listed from the next ping on, if only as ended.
    scene.shown = np.append(scene.shown, scene.next_id)
    scene.next_id += 1
    confirmed = replace(begun, confirmed=np.ones(1, dtype=bool))
    scene.keep(scene.bank.append(confirmed), scene.last)


def end_track(scene: SceneMemory, modes: MotionModel, number: int) -> None:
    """End a track.

    Parameters
    ----------
    scene : SceneMemory
        Changed.
    modes : MotionModel
        Tells which of its modes is that of what is fixed.
    number : int
        Identifier.

    Raises
    ------
    InputError
        If there is no such track.
    """
    row = _row_of(scene, number)
    if number in scene.shown:
        nothing = np.zeros(1)
        last = ListedTracks(
            scene.bank.select(np.array([row])), nothing > 0.0, nothing == 0.0, nothing
        )
        scene.ended.append(list_tracks(last, np.array([0], np.intp), modes.static_mode))
    scene.shown = scene.shown[scene.shown != number]
    scene.keep(scene.bank.select(np.delete(np.arange(len(scene.bank)), row)), scene.last)


def merge_tracks(scene: SceneMemory, modes: MotionModel, number: int, other: int) -> None:
    """Let two tracks be one: the more certain state goes on under the first name.

    Parameters
    ----------
    scene : SceneMemory
        Changed.
    modes : MotionModel
        Tells which of its modes is that of what is fixed.
    number, other : int
        Identifiers; the second one ends.

    Raises
    ------
    InputError
        If there is no such track; nothing has changed then.
    """
    first, second = _row_of(scene, number), _row_of(scene, other)
    _, covariance = scene.bank.position_moments()
    variance = covariance[:, 0, 0] + covariance[:, 1, 1]
    bank = scene.bank
    # Particles keep the state of the name they are of.
    if variance[second] < variance[first] and not scene.particles.used:
        bank = _with_state_of(bank, first, second)
    confirmed = bank.confirmed.copy()
    confirmed[first] |= confirmed[second]
    scene.keep(replace(bank, confirmed=confirmed), scene.last)
    end_track(scene, modes, other)


def _row_of(scene: SceneMemory, number: int) -> int:
    (rows,) = np.nonzero(scene.bank.id == number)
    if not rows.size:
        shown = ", ".join(map(str, scene.shown.tolist())) or "none"
        raise InputError(f"there is no track {number}; there are {shown}.")
    return int(rows[0])


def _with_state_of(bank: TrackBank, row: int, better: int) -> TrackBank:
    """Return tracks of which one has the state of another, and its own name and age."""
    source = np.arange(len(bank))
    source[row] = better
    initiated = bank.initiated.copy()
    initiated[row] = min(initiated[row], initiated[better])
    return replace(bank.select(source), id=bank.id, initiated=initiated)
