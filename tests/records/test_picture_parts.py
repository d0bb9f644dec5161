"""Parts of a picture: the rows of each, in columns like those of the whole."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from sonar_tracking.records.picture_parts import picture_parts
from sonar_tracking.records.positions import PositionTracks


def test_parts_are_what_pictures_of_their_rows_would_be() -> None:
    generator = np.random.default_rng(1)
    tracks = PositionTracks(
        stamp=5,
        id=np.arange(6).astype(np.uint64),
        status=np.ones(6, np.uint8),
        source=np.zeros(6, np.uint8),
        state=generator.normal(size=(6, 4)),
        covariance=generator.normal(size=(6, 4, 4)),
        next_stamp=7,
    )
    parts = picture_parts(tracks, [2, 0, 4])
    for part, begin, end in zip(parts, (0, 2, 2), (2, 2, 6), strict=True):
        rows = np.arange(6)
        expected = tracks.selected((rows >= begin) & (rows < end))
        for field in fields(PositionTracks):
            own, other = getattr(part, field.name), getattr(expected, field.name)
            np.testing.assert_array_equal(own, other, err_msg=field.name)
            if isinstance(own, np.ndarray):
                assert (own.dtype, own.shape) == (other.dtype, other.shape), field.name
