"""Tables of several scenes: parts that are joined again are the table they are parts of."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from sonar_tracking.active.tracks.scene_rows import SceneRows, joined_tables
from tests.active.track_scene import contacts_at

TABLE = contacts_at([[float(place), 10.0] for place in range(1, 7)])
ROWS = SceneRows((2, 0, 4))


def test_all_parts_in_their_order_are_the_table_itself() -> None:
    parts = ROWS.parts(TABLE)
    assert [len(part.distance) for part in parts] == [2, 0, 4]
    assert joined_tables(parts) is TABLE


def test_other_tables_are_joined_anew() -> None:
    parts = ROWS.parts(TABLE)
    nearer = replace(parts[2], distance=np.zeros(4))
    for others in (parts[::-1], parts[:2], [*parts, parts[0]], [*parts[:2], nearer]):
        found = joined_tables(others)
        assert found is not TABLE
        for field in fields(found):
            expected = np.concatenate([getattr(other, field.name) for other in others])
            assert np.array_equal(getattr(found, field.name), expected)
    assert joined_tables([nearer]) is nearer
