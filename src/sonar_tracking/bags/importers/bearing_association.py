"""Which bearings of a sensor are of one source, where the file does not say: joint integrated PDA.

A track is a bearing and its rate, of nearly constant rate, and the probability p that it exists.
Looks come when they come: a camera's at a steady rate, a click detector's one at a time. A source
is therefore heard at a rate r, learnt for each track, and in a look after the interval T with

    P_D = 1 - exp(-r T).

For all tracks t and bearings j of a look, with the density l_tj of the innovation and the density
lambda of false bearings, learnt too, the joint events are weighed by 1 - p P_D P_G for a track
without and p P_D l_tj / lambda for a track with a bearing. With the sum beta_t of the probabilities
of its bearings,

    p <- beta_t + (1 - beta_t) p (1 - P_D P_G) / (1 - p P_D P_G).

The file is known to its end: a track that proves to exist has its bearings from the first on.

References
----------
D. Musicki, R. Evans, "Joint integrated probabilistic data association: JIPDA", IEEE Trans. AES
40(3), 2004.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.active.association.jpda import associate_jointly
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IntArray

GATE = 4.0
"""Standard deviations of the innovation; P_G is taken as one."""

FIRST_EXISTENCE = 0.05
CONFIRMED, ENDED = 0.95, 0.01
FEWEST_BEARINGS = 4
"""Of a track that is kept."""

RATE_DEVIATION = np.radians(0.5)
"""Of the bearing rate of a new track, rad/s."""

RATE_NOISE = np.radians(0.02) ** 2
"""Spectral density of the bearing acceleration, rad^2/s^3: ships that pass at some hundred m."""

LONGEST_SILENCE = 60.0
"""s."""

VAGUEST = np.radians(10.0)
"""Standard deviation of a bearing beyond which a track says nothing, rad."""

FIRST_DETECTION, DETECTION_WEIGHT = 0.3, 2.0
"""P_D of a new track in a usual look, and how many looks that counts."""

SAME_DISTANCE, SAME_LOOKS = 1.0, 5
"""Two tracks closer than this (squared, in their deviations) for so many looks are one."""

FORGETTING = 0.95
"""Share of the density of false bearings that is kept from look to look."""

FEWEST_FALSE = 0.02
"""False bearings in a look at least."""

BINS = 36
"""Of the circle, to see where a sensor looks."""


@dataclass
class _Track:
    mean: FloatArray
    covariance: FloatArray
    stamp: int
    hits: float
    time: float
    existence: float = FIRST_EXISTENCE
    confirmed: bool = False
    bearings: list[int] = field(default_factory=list)
    near: dict[int, int] = field(default_factory=dict)

    def predict(self, interval: float) -> None:
        transition = transition_matrix(interval)
        self.mean = transition @ self.mean
        noise = process_noise_matrix(RATE_NOISE, interval)
        self.covariance = transition @ self.covariance @ transition.T + noise


def associate_bearings(stamp: IntArray, angle: FloatArray, deviation: FloatArray) -> IntArray:
    """Return the track of each bearing of one sensor.

    Parameters
    ----------
    stamp : ndarray of int, shape (n,)
        Ascending, ns; bearings of one stamp are one look, in which a source is heard once at most.
    angle : ndarray, shape (n,)
        rad.
    deviation : ndarray, shape (n,)
        Standard deviations, rad.

    Returns
    -------
    ndarray of int, shape (n,)
        Numbers from 1 in the order of the first bearing; 0 = of no track.
    """
    looks = np.split(np.arange(len(stamp)), np.flatnonzero(np.diff(stamp)) + 1)
    tracker = _Tracker(stamp, angle, deviation, looks)
    for rows in looks:
        tracker.look(rows)
    kept = [track for track in (*tracker.ended, *tracker.tracks) if track.confirmed]
    number = np.zeros(len(stamp), dtype=np.int64)
    for index, track in enumerate(sorted(kept, key=lambda track: track.bearings[0]), start=1):
        number[track.bearings] = index
    return number


class _Tracker:
    """The tracks of one sensor."""

    def __init__(
        self, stamp: IntArray, angle: FloatArray, deviation: FloatArray, looks: list[IntArray]
    ) -> None:
        self._stamp, self._angle, self._deviation = stamp, angle, deviation
        self.tracks: list[_Track] = []
        self.ended: list[_Track] = []
        instants = stamp[[rows[0] for rows in looks]]
        self._usual = 1e-9 * float(np.median(np.diff(instants))) if len(looks) > 1 else 1.0
        bins = np.floor((angle / (2.0 * np.pi) % 1.0) * BINS).astype(int)
        self._field = 2.0 * np.pi * len(np.unique(bins)) / BINS
        self._false = max(0.5 * len(stamp) / len(looks), FEWEST_FALSE)

    def look(self, rows: IntArray) -> None:
        """Take in the bearings of one instant."""
        stamp = int(self._stamp[rows[0]])
        detection = np.array([self._detection(track, stamp) for track in self.tracks])
        innovation, spread = self._predicted(rows, stamp)
        density = np.exp(-0.5 * innovation**2 / spread) / np.sqrt(2.0 * np.pi * spread)
        density[innovation**2 > GATE**2 * spread] = 0.0
        existence = np.array([track.existence for track in self.tracks])
        claimed = existence * detection
        ratios = claimed[:, None] * density * self._field / self._false
        beta = np.zeros((len(self.tracks), len(rows)))
        if self.tracks:
            # Events are weighed relative to those in which no track has a bearing.
            beta = associate_jointly(ratios / (1.0 - claimed)[:, None], 1.0)
        for index, track in enumerate(self.tracks):
            self._update(track, rows, beta[index], innovation[index], spread[index])
            own = float(beta[index].sum())
            missed = existence[index] * (1.0 - detection[index]) / (1.0 - claimed[index])
            track.existence = min(own + (1.0 - own) * missed, 1.0 - 1e-9)
        taken = beta.sum(axis=0)
        self._false = max(
            FORGETTING * self._false + (1.0 - FORGETTING) * float(np.sum(1.0 - taken)), FEWEST_FALSE
        )
        self._clean(stamp)
        for row in rows[taken < 0.5]:
            self._begin(int(row))

    def _detection(self, track: _Track, stamp: int) -> float:
        rate = track.hits / track.time
        return float(np.clip(1.0 - np.exp(-rate * 1e-9 * (stamp - track.stamp)), 0.01, 0.98))

    def _predicted(self, rows: IntArray, stamp: int) -> tuple[FloatArray, FloatArray]:
        """Predict all tracks; return innovations and variances, shape (n_tracks, n_bearings)."""
        for track in self.tracks:
            interval = 1e-9 * (stamp - track.stamp)
            track.predict(interval)
            track.time += interval
            track.stamp = stamp
        means = np.array([track.mean[0] for track in self.tracks])
        variances = np.array([track.covariance[0, 0] for track in self.tracks])
        innovation = wrap_angle(self._angle[rows][None, :] - means[:, None])
        return innovation, variances[:, None] + self._deviation[rows][None, :] ** 2

    def _update(
        self,
        track: _Track,
        rows: IntArray,
        beta: FloatArray,
        innovation: FloatArray,
        spread: FloatArray,
    ) -> None:
        """Mix the states after each bearing, and after none, by their probabilities."""
        own = float(beta.sum())
        track.hits += own
        if own < 1e-6:
            return
        gains = track.covariance[:, :1] / spread[None, :]
        shifts = np.concatenate([np.zeros((2, 1)), gains * innovation[None, :]], axis=1)
        weights = np.concatenate([[1.0 - own], beta])
        mean = shifts @ weights
        reduced = np.einsum("j,j,ij,kj->ik", beta, spread, gains, gains)
        scatter = (shifts * weights) @ shifts.T - np.outer(mean, mean)
        track.mean = track.mean + mean
        track.covariance = track.covariance - reduced + scatter
        best = int(np.argmax(beta))
        if beta[best] > 0.5:
            track.bearings.append(int(rows[best]))

    def _begin(self, row: int) -> None:
        covariance = np.diag([self._deviation[row] ** 2, RATE_DEVIATION**2])
        rate = -np.log(1.0 - FIRST_DETECTION) / self._usual
        time = DETECTION_WEIGHT * self._usual
        stamp = int(self._stamp[row])
        state = np.array([self._angle[row], 0.0])
        track = _Track(state, covariance, stamp, rate * time, time, bearings=[row])
        self.tracks.append(track)

    def _clean(self, stamp: int) -> None:
        """Confirm and end tracks; of two that are one, the older stays."""
        doubles = self._doubles()
        kept: list[_Track] = []
        for track in self.tracks:
            enough = len(track.bearings) >= FEWEST_BEARINGS
            track.confirmed |= enough and track.existence > CONFIRMED
            silence = 1e-9 * (stamp - int(self._stamp[track.bearings[-1]]))
            vague = float(track.covariance[0, 0]) > VAGUEST**2
            over = track.existence < ENDED or silence > LONGEST_SILENCE or vague
            if id(track) in doubles:
                continue
            (self.ended if over else kept).append(track)
        self.tracks = kept

    def _doubles(self) -> set[int]:
        doubles: set[int] = set()
        for index, older in enumerate(self.tracks):
            for newer in self.tracks[index + 1 :]:
                apart = newer.mean - older.mean
                apart[0] = wrap_angle(apart[0])
                both = older.covariance + newer.covariance
                close = apart @ np.linalg.solve(both, apart) < SAME_DISTANCE
                looks = older.near.get(id(newer), 0) + 1 if close else 0
                older.near[id(newer)] = looks
                if looks >= SAME_LOOKS:
                    doubles.add(id(newer))
        return doubles
