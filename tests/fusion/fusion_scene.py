"""Ships that a sonar and a line array of own ship follow: what both lists would tell of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.filtering.kalman import KalmanState, predict, update
from sonar_tracking.fusion.fusion_records import FusionFrame
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS

EPOCH = 1_767_225_600 * NANOSECONDS
PING, FRAME = 10.0, 2.0
RANGE_DEVIATION = 30.0
AZIMUTH_DEVIATION = float(np.radians(1.0))
BEARING_DEVIATION = float(np.radians(0.5))
ECHOES, POSITIONS, ARRAY = "active/tracks", "passive/tracks", "array"


@dataclass(frozen=True)
class Ships:
    """A scene.

    Attributes
    ----------
    states : ndarray, shape (n, 4)
        x, y, vx, vy at the beginning, m and m/s.
    misalignment : float
        By how much the array is turned anticlockwise from what its data tell, rad.
    acceleration : float
        Density of the white acceleration of the ships, m^2/s^3.
    silent_sonar, silent_array : tuple of two float
        From when until when either is not heard of, s.
    seed : int
        Of the noise.
    """

    states: FloatArray
    misalignment: float = 0.0
    acceleration: float = 1e-5
    silent_sonar: tuple[float, float] = (np.inf, np.inf)
    silent_array: tuple[float, float] = (np.inf, np.inf)
    seed: int = 1


@dataclass
class Moment:
    """One frame of the stage, and the truth."""

    time: float
    frame: FusionFrame
    truth: FloatArray
    own_ship: KinematicState = field(repr=False)


def moments(scene: Ships, duration: float) -> Iterator[Moment]:
    """Yield what the lists tell, every :data:`FRAME` seconds."""
    generator = np.random.default_rng(scene.seed)
    truth = scene.states.copy()
    filters: list[KalmanState] | None = None
    step = np.kron(transition_matrix(FRAME), np.eye(2))
    noise = np.kron(process_noise_matrix(scene.acceleration, FRAME), np.eye(2))
    root = np.linalg.cholesky(noise)
    for index in range(int(duration / FRAME)):
        time = index * FRAME
        if index:
            shocks = generator.standard_normal(truth.shape)
            truth = truth @ step.T + shocks @ root.T
        own_ship = own_ship_at(time)
        active: dict[str, PositionTracks] = {}
        bearings: tuple[BearingTracks, ...] = ()
        if time % PING == 0.0:
            filters, tracks = _ping(scene, filters, truth, own_ship, time, generator)
            if not _within(time, scene.silent_sonar):
                active = {ECHOES: tracks}
        heard = _bearings(scene, truth, own_ship, time, generator)
        if not _within(time, scene.silent_array):
            bearings = (heard,)
        frame = FusionFrame(stamp_of(time), active, bearings, own_ship=own_ship)
        yield Moment(time, frame, truth, own_ship)


def stamp_of(time: float) -> int:
    """Return the stamp of a time of the scene, ns."""
    return EPOCH + round(time * NANOSECONDS)


def own_ship_at(time: float) -> KinematicState:
    """Return own ship, which goes north, east from 200 s on, and north-west from 400 s on."""
    legs = ((0.0, 0.5 * np.pi), (200.0, 0.0), (400.0, 0.75 * np.pi))
    position, azimuth = np.zeros(2), 0.0
    for number, (begin, azimuth) in enumerate(legs):
        end = legs[number + 1][0] if number + 1 < len(legs) else np.inf
        spent = min(time, end) - begin
        position = position + 5.0 * spent * np.array([np.cos(azimuth), np.sin(azimuth)])
        if time < end:
            break
    velocity = 5.0 * np.array([np.cos(azimuth), np.sin(azimuth)])
    return KinematicState(position, velocity, np.array(azimuth), np.array(0.0))


def _within(time: float, span: tuple[float, float]) -> bool:
    return span[0] <= time < span[1]


def _ping(
    scene: Ships,
    filters: list[KalmanState] | None,
    truth: FloatArray,
    own_ship: KinematicState,
    time: float,
    generator: np.random.Generator,
) -> tuple[list[KalmanState], PositionTracks]:
    """Return the filters of a tracker of echoes after a ping, and its list."""
    step = np.asarray(np.kron(transition_matrix(PING), np.eye(2)))
    density = max(scene.acceleration, 1e-5)
    noise = np.asarray(np.kron(process_noise_matrix(density, PING), np.eye(2)))
    measured, covariance, after = [], [], []
    for number, ship in enumerate(truth):
        offset = ship[:2] - own_ship.position
        distance = np.hypot(*offset) + RANGE_DEVIATION * generator.standard_normal()
        azimuth = np.arctan2(offset[1], offset[0])
        azimuth += AZIMUTH_DEVIATION * generator.standard_normal()
        along = np.array([np.cos(azimuth), np.sin(azimuth)])
        across = np.array([-along[1], along[0]])
        measured.append(own_ship.position + distance * along)
        covariance.append(
            RANGE_DEVIATION**2 * np.outer(along, along)
            + (distance * AZIMUTH_DEVIATION) ** 2 * np.outer(across, across)
        )
        if filters is None:
            spread = np.zeros((4, 4))
            spread[:2, :2], spread[2:, 2:] = covariance[-1], 25.0 * np.eye(2)
            after.append(KalmanState(np.concatenate([measured[-1], np.zeros(2)]), spread))
        else:
            predicted = predict(filters[number], step, noise)
            after.append(update(predicted, measured[-1], np.eye(2, 4), covariance[-1]).state)
    count = len(truth)
    tracks = PositionTracks(
        stamp=stamp_of(time),
        id=np.arange(1, count + 1, dtype=np.uint64) + np.uint64(100),
        status=np.full(count, TrackStatus.CONFIRMED, np.uint8),
        source=np.full(count, TrackSource.ACTIVE, np.uint8),
        state=np.array([one.mean for one in after]),
        covariance=np.array([one.covariance for one in after]),
        existence_probability=np.full(count, 0.99),
        initiated=np.full(count, EPOCH / NANOSECONDS),
        updated=np.full(count, stamp_of(time) / NANOSECONDS),
        measurement=np.array(measured),
        measurement_covariance=np.array(covariance),
        next_stamp=stamp_of(time + PING),
    )
    return after, tracks


def _bearings(
    scene: Ships,
    truth: FloatArray,
    own_ship: KinematicState,
    time: float,
    generator: np.random.Generator,
) -> BearingTracks:
    """Return what the array tells, whose axis points forward."""
    axis = float(own_ship.azimuth) + scene.misalignment
    offset = truth[:, :2] - own_ship.position
    azimuth = np.arctan2(offset[:, 1], offset[:, 0])
    angle = np.arcsin(np.cos(azimuth - axis))
    deviation = BEARING_DEVIATION / np.maximum(np.cos(angle), 0.2)
    measured = angle + deviation * generator.standard_normal(len(truth))
    half = 0.5 * float(own_ship.azimuth)
    sensor = Sensor(
        sensor_id=ARRAY,
        position=(*own_ship.position, 0.0),
        orientation=(0.0, 0.0, np.sin(half), np.cos(half)),
        velocity=(*own_ship.velocity, 0.0),
    )
    count = len(truth)
    unknown = np.full(count, np.nan)
    return BearingTracks(
        stamp=stamp_of(time),
        id=np.arange(1, count + 1, dtype=np.uint64) + np.uint64(200),
        status=np.full(count, TrackStatus.CONFIRMED, np.uint8),
        arrival_angle=measured,
        arrival_angle_rate=np.zeros(count),
        covariance=np.tile(np.diag([BEARING_DEVIATION**2, 1e-6]), (count, 1, 1)),
        measurement=measured,
        measurement_variance=deviation**2,
        innovation=unknown,
        signal_to_noise_ratio=unknown,
        existence_probability=np.full(count, 0.99),
        ambiguous=np.ones(count, bool),
        sensor=sensor,
        angle_kind=AngleKind.CONE,
        next_stamp=stamp_of(time + FRAME),
    )


def with_bearing_tracks(frame: FusionFrame, order: list[int]) -> FusionFrame:
    """Return a frame in which the bearing tracks have taken each other's sources."""
    (bearings,) = frame.bearings
    columns = ("arrival_angle", "measurement", "measurement_variance")
    changed = {name: getattr(bearings, name)[order] for name in columns}
    return replace(frame, bearings=(replace(bearings, **changed),))


FOUR = np.array(
    [
        [-4000.0, 3000.0, 6.0, 1.0],
        [1000.0, 5000.0, -2.0, -5.0],
        [3000.0, -2500.0, -1.0, 6.0],
        [3500.0, 4500.0, -3.0, -1.0],
    ]
)
"""Ships around own ship."""
