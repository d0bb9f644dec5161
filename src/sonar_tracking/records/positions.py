"""Position tracks: what every tracker of positions gives, whatever it tracks with.

Target motion analysis, the active chain, their fusion and the truth of a simulation share one
record, the image of the message ``Tracks``. A producer gives what it knows; a column it leaves out
is filled with unknown (NaN), none (0) or nothing (empty).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.errors import InputError
from sonar_tracking.records.arrays import BoolArray, CodeArray, FloatArray, IdArray, RowArray
from sonar_tracking.records.bearings import established
from sonar_tracking.records.time import UNKNOWN_STAMP

MAP_FRAME = "map"
"""Frame of positions: local east, north."""


class TrackSource(IntEnum):
    """Who made a track, as in the messages."""

    ACTIVE = 0
    TMA = 1
    FUSED = 2
    TRUTH = 3
    STATIC = 4
    """Contacts of something that is fixed, rather than of a target that moves."""
    SMOOTHED = 5
    """As TMA, with what was measured later."""


class TrackHypothesis(IntEnum):
    """Side of the line array a track stands on, as in the messages."""

    SINGLE = 0
    LEFT = 1
    RIGHT = 2


class Column(NamedTuple):
    """How a column is stored.

    Attributes
    ----------
    dtype : str
        Of its values.
    width : tuple of int
        Shape of one row.
    fill : float or None
        Value where it is left out; None = must be given.
    key : str
        Column whose rows it shares.
    """

    dtype: str = "float64"
    width: tuple[int, ...] = ()
    fill: float | None = np.nan
    key: str = "id"


COLUMNS: dict[str, Column] = {
    "id": Column("uint64", fill=None),
    "status": Column("uint8", fill=None),
    "source": Column("uint8", fill=None),
    "state": Column(width=(4,), fill=None),
    "covariance": Column(width=(4, 4)),
    "z": Column(),
    "z_standard_deviation": Column(),
    "existence_probability": Column(),
    "initiated": Column(),
    "updated": Column(),
    "observability": Column(),
    "hypothesis": Column("uint8", fill=0),
    "hypothesis_probability": Column(),
    "bearing_track_id": Column("uint64", fill=0),
    "measurement": Column(width=(2,)),
    "measurement_covariance": Column(width=(2, 2)),
    "line_track": Column("uint32", fill=None, key="line_track"),
    "line_id": Column("uint64", fill=0, key="line_track"),
    "line_frequency": Column(key="line_track"),
    "line_frequency_standard_deviation": Column(key="line_track"),
    "contributor_track": Column("uint32", fill=None, key="contributor_track"),
    "contributor_source": Column("uint8", fill=0, key="contributor_track"),
    "contributor_id": Column("uint64", fill=0, key="contributor_track"),
}
"""The columns of position tracks."""

KEYS = tuple(dict.fromkeys(column.key for column in COLUMNS.values()))
"""Columns whose rows others share."""

DATA_TYPES = {column.dtype: np.dtype(column.dtype) for column in COLUMNS.values()}

EMPTY_COLUMNS: dict[str, NDArray[Any]] = {
    name: np.empty((0, *column.width), column.dtype) for name, column in COLUMNS.items()
}
"""Most pictures have neither lines nor contributors: their columns without rows are shared."""


_NOTHING: NDArray[Any] = np.empty(0)


def _left_out() -> NDArray[Any]:
    return _NOTHING


@dataclass(frozen=True)
class PositionTracks:
    """All position tracks at one instant; row n belongs to track n.

    Attributes
    ----------
    stamp : int
        Instant the states refer to, ns.
    id : ndarray of uint64, shape (n,)
        Never reused within a run; both sides of one ambiguous bearing are two rows, each with an
        identifier of its own.
    status : ndarray of uint8, shape (n,)
        Values of :class:`~sonar_tracking.records.bearings.TrackStatus`.
    source : ndarray of uint8, shape (n,)
        Values of :class:`TrackSource`.
    state : ndarray, shape (n, 4)
        x, y, vx, vy in ``frame_id``, m and m/s; NaN = unknown.
    covariance : ndarray, shape (n, 4, 4)
        Of the state, m^2, m^2/s and m^2/s^2; NaN = unknown.
    z, z_standard_deviation : ndarray, shape (n,)
        Height in ``frame_id``, m, upwards, NaN = unknown; and its standard deviation, m, NaN = it
        is not estimated, but what was assumed.
    existence_probability : ndarray, shape (n,)
        A probability; NaN = not estimated.
    initiated, updated : ndarray, shape (n,)
        Stamp time the track was started, and of its last measurement, s; NaN = unknown.
    observability : ndarray, shape (n,)
        A pure number from 0 to 1; NaN = not applicable.
    hypothesis : ndarray of uint8, shape (n,)
        Values of :class:`TrackHypothesis`.
    hypothesis_probability : ndarray, shape (n,)
        A probability; NaN = not estimated.
    bearing_track_id : ndarray of uint64, shape (n,)
        Bearing track the row was made from; 0 = none.
    measurement : ndarray, shape (n, 2)
        What the last update measured, as one position at the stamp, m; NaN = it measured
        none, or unknown.
    measurement_covariance : ndarray, shape (n, 2, 2)
        Of the measurement, m^2.
    line_track : ndarray of uint32, shape (n_lines,)
        Row of the track the line belongs to.
    line_id : ndarray of uint64, shape (n_lines,)
        Identity of the line.
    line_frequency, line_frequency_standard_deviation : ndarray, shape (n_lines,)
        At rest, Hz; NaN = unknown.
    contributor_track : ndarray of uint32, shape (n_contributors,)
        Row of the track the contributor belongs to.
    contributor_source : ndarray of uint8, shape (n_contributors,)
        Values of :class:`TrackSource`.
    contributor_id : ndarray of uint64, shape (n_contributors,)
        Identifier in the list of the contributor.
    contributor_sensor : tuple of str
        Sensor of each contributor; ``""`` = unknown.
    next_stamp : int
        Watermark, ns.
    frame_id : str
        Frame of the states.

    Raises
    ------
    InputError
        When a column has another shape than its rows ask for, or a line or contributor belongs to
        a row that is not there.

    Examples
    --------
    >>> tracks = PositionTracks(
    ...     stamp=1_000_000_000,
    ...     id=np.array([7], np.uint64),
    ...     status=np.array([TrackStatus.CONFIRMED], np.uint8),
    ...     source=np.array([TrackSource.ACTIVE], np.uint8),
    ...     state=np.array([[100.0, 50.0, 1.0, 0.0]]),
    ... )
    """

    stamp: int
    id: IdArray
    status: CodeArray
    source: CodeArray
    state: FloatArray
    covariance: FloatArray = field(default_factory=_left_out)
    z: FloatArray = field(default_factory=_left_out)
    z_standard_deviation: FloatArray = field(default_factory=_left_out)
    existence_probability: FloatArray = field(default_factory=_left_out)
    initiated: FloatArray = field(default_factory=_left_out)
    updated: FloatArray = field(default_factory=_left_out)
    observability: FloatArray = field(default_factory=_left_out)
    hypothesis: CodeArray = field(default_factory=_left_out)
    hypothesis_probability: FloatArray = field(default_factory=_left_out)
    bearing_track_id: IdArray = field(default_factory=_left_out)
    measurement: FloatArray = field(default_factory=_left_out)
    measurement_covariance: FloatArray = field(default_factory=_left_out)
    line_track: RowArray = field(default_factory=_left_out)
    line_id: IdArray = field(default_factory=_left_out)
    line_frequency: FloatArray = field(default_factory=_left_out)
    line_frequency_standard_deviation: FloatArray = field(default_factory=_left_out)
    contributor_track: RowArray = field(default_factory=_left_out)
    contributor_source: CodeArray = field(default_factory=_left_out)
    contributor_id: IdArray = field(default_factory=_left_out)
    contributor_sensor: tuple[str, ...] = ()
    next_stamp: int = UNKNOWN_STAMP
    frame_id: str = MAP_FRAME

    def __post_init__(self) -> None:
        """Fill the columns that were left out and check the others."""
        stored = vars(self)
        rows = {key: len(stored[key]) for key in KEYS}
        for name, column in COLUMNS.items():
            given, own = stored[name], rows[column.key]
            if given is _NOTHING and own == 0:
                stored[name] = EMPTY_COLUMNS[name]
            else:
                stored[name] = _filled(name, given, own, column)
        if not self.contributor_sensor:
            stored["contributor_sensor"] = ("",) * len(self.contributor_track)
        self._check_owners()

    def __len__(self) -> int:
        """Return the number of tracks."""
        return len(self.id)

    @property
    def established(self) -> BoolArray:
        """Which tracks are confirmed, seen now or coasted; shape (n_tracks,)."""
        return established(self.status)

    def selected(self, keep: BoolArray) -> PositionTracks:
        """Return the rows chosen by a mask, with their lines and contributors.

        Parameters
        ----------
        keep : ndarray of bool, shape (n,)
            True = stays.
        """
        keep = np.asarray(keep, bool)
        if keep.all():
            return self
        row = (np.cumsum(keep) - 1).astype(np.uint32)
        masks = {
            "id": keep,
            "line_track": keep[self.line_track],
            "contributor_track": keep[self.contributor_track],
        }
        chosen = {name: getattr(self, name)[masks[column.key]] for name, column in COLUMNS.items()}
        for owner in ("line_track", "contributor_track"):
            chosen[owner] = row[chosen[owner]]
        sensors = np.array(self.contributor_sensor, object)[masks["contributor_track"]]
        return PositionTracks(
            stamp=self.stamp,
            contributor_sensor=tuple(sensors),
            next_stamp=self.next_stamp,
            frame_id=self.frame_id,
            **chosen,
        )

    def _check_owners(self) -> None:
        if len(self.contributor_sensor) != len(self.contributor_track):
            raise InputError(
                f"PositionTracks.contributor_sensor has {len(self.contributor_sensor)} names, but "
                f"there are {len(self.contributor_track)} contributors; give one name each."
            )
        for owner in ("line_track", "contributor_track"):
            rows = getattr(self, owner)
            if rows.size and int(rows.max()) >= len(self.id):
                raise InputError(
                    f"PositionTracks.{owner} names row {int(rows.max())}, but there are "
                    f"{len(self.id)} tracks; give the row of a track in the same picture."
                )


def no_position_tracks(stamp: int, next_stamp: int = UNKNOWN_STAMP) -> PositionTracks:
    """Return the empty picture.

    Parameters
    ----------
    stamp : int
        Its instant, ns.
    next_stamp : int
        Watermark, ns.
    """
    nothing = np.empty(0)
    return PositionTracks(
        stamp=stamp,
        id=nothing.astype(np.uint64),
        status=nothing.astype(np.uint8),
        source=nothing.astype(np.uint8),
        state=np.empty((0, 4)),
        next_stamp=next_stamp,
    )


def _filled(name: str, values: Any, rows: int, column: Column) -> NDArray[Any]:
    """Return a column with its type and shape, filled where it was left out."""
    if column.fill is not None and len(values) == 0:
        if rows == 0:
            return EMPTY_COLUMNS[name]
        filled = np.empty((rows, *column.width), DATA_TYPES[column.dtype])
        filled.fill(column.fill)
        return filled
    array = np.asarray(values, DATA_TYPES[column.dtype])
    shape = (rows, *column.width)
    if array.shape != shape:
        raise InputError(
            f"PositionTracks.{name} has shape {array.shape}, but {column.key} has {rows} rows "
            f"and {name} needs {shape}."
        )
    return array


@dataclass(frozen=True)
class TruthTracks:
    """True states of the targets that have one, at one instant.

    Attributes
    ----------
    stamp : int
        The instant of the states, ns.
    id : ndarray of uint64, shape (n_tracks,)
        Number of the target in the scenario, from 1; as in the bearing truth.
    position, velocity : ndarray, shape (n_tracks, 2)
        In ``map``, m and m/s.
    next_stamp : int
        Watermark, ns.
    """

    stamp: int
    id: IdArray
    position: FloatArray
    velocity: FloatArray
    next_stamp: int = UNKNOWN_STAMP
