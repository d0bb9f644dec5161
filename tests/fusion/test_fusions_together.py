"""Protects the fusion of several independent pictures at once: each is as if it was alone."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage, update_together
from tests.fusion.fusion_scene import FOUR, Ships, moments

SILENCE = (30.0, 60.0)
CONFIGURATIONS = (
    TrackFusionConfiguration(),
    TrackFusionConfiguration(travel_time=False),
    TrackFusionConfiguration(alignment_deviation_deg=1.0),
)
SCENES = (
    Ships(FOUR, misalignment=float(np.radians(1.0))),
    Ships(FOUR[:2], silent_sonar=SILENCE, seed=2),
    Ships(FOUR, silent_array=SILENCE, seed=3),
)


def stages() -> list[TrackFusionStage]:
    """Return two fusions of each configuration for each scene."""
    return [TrackFusionStage(one) for _ in SCENES for one in CONFIGURATIONS]


def frames() -> list[tuple[FusionFrame, ...]]:
    """Return the frames of all these fusions, instant by instant."""
    scenes = zip(*(moments(scene, 150.0) for scene in SCENES), strict=True)
    return [tuple(one.frame for one in instant for _ in CONFIGURATIONS) for instant in scenes]


def assert_same(one: FusionUpdate, other: FusionUpdate) -> None:
    """Assert that two updates are the same, bit for bit."""
    for name in ("tracks", "own_tracks", "alignments"):
        first, second = getattr(one, name), getattr(other, name)
        for field in fields(first):
            np.testing.assert_array_equal(getattr(first, field.name), getattr(second, field.name))
    assert one.notices == other.notices


@pytest.mark.slow
def test_fusions_at_once_are_those_of_each_by_itself() -> None:
    together, alone, heard = stages(), stages(), 0
    for number, instant in enumerate(frames()):
        given = list(instant)
        if number % 7 == 3:
            given[-1] = replace(given[-1], stamp=given[-1].stamp + 1)
        updates = update_together(together, given)
        for stage, frame, update in zip(alone, given, updates, strict=True):
            assert_same(update, stage.update(frame))
            heard += sum(len(one.heard) for one in stage._filters.targets)
    assert heard


def test_a_frame_that_is_not_later_changes_none_of_the_fusions() -> None:
    own = stages()
    first, second = frames()[:2]
    update_together(own, first)
    with pytest.raises(InputError, match="not later"):
        update_together(own, [*second[:-1], first[-1]])
    assert len(update_together(own, second)) == len(own)
