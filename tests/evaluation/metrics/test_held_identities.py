"""Who has which target, on a case small enough to count by hand."""

import numpy as np
import pytest

from sonar_tracking.evaluation.metrics.held_identities import HeldIdentities, held_identities
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource

CUTOFF = 10.0


def tracks_at(places: dict[int, tuple[float, float]]) -> PositionTracks:
    n = len(places)
    return PositionTracks(
        stamp=1,
        id=np.array(list(places), np.uint64),
        status=np.full(n, TrackStatus.CONFIRMED, np.uint8),
        source=np.full(n, TrackSource.ACTIVE, np.uint8),
        state=np.array([(x, 0.0, speed, 0.0) for x, speed in places.values()]).reshape(n, 4),
    )


@pytest.fixture
def held() -> HeldIdentities:
    """Return two targets, 100 m apart, the second of which comes at the second of four periods."""
    truth = np.zeros((4, 2, 4))
    truth[:, 1, 0] = 100.0
    truth[0, 1] = np.nan
    pictures = [
        tracks_at({}),
        tracks_at({5: (1.0, 0.5), 6: (99.0, 2.0)}),
        tracks_at({5: (3.0, 0.5), 7: (108.0, 3.0), 8: (500.0, 0.0)}),
        tracks_at({5: (2.0, 0.5), 7: (111.0, 3.0)}),
    ]
    return held_identities(truth, pictures, CUTOFF)


def test_targets_are_held_by_what_is_within_the_cutoff(held: HeldIdentities) -> None:
    assert held.identity.tolist() == [[-1, -1], [5, 6], [5, 7], [5, -1]]
    np.testing.assert_equal(held.speed[2], [0.5, 3.0])
    assert held.present.sum() == 7 and held.confirmed == {5, 6, 7, 8}


def test_shares_count_the_life_of_each_target(held: HeldIdentities) -> None:
    assert held.share_held_from(0) == pytest.approx(5 / 7)
    assert held.share_held_from(1) == pytest.approx(4 / 5)
    assert held.continuities() == pytest.approx([3 / 4, 1 / 3])


def test_without_tracks_nothing_is_held() -> None:
    held = held_identities(np.zeros((2, 1, 4)), [tracks_at({})] * 2, CUTOFF)
    assert held.share_held_from(0) == 0.0 and held.continuities() == pytest.approx([0.0])
