"""Recordings made from the measured responses of a 32-element line array in a room.

Independent narrowband noise of each source is convolved with the responses measured from its
loudspeaker to eight neighbouring elements. The eight elements slide along the array, one element
a dwell, so that a source at rest moves in bearing. What a simulation lacks is in the data: gain
and phase errors of real elements, reflections, curved wavefronts; and the true bearings are known
from the surveyed positions.

The axis of the array is +z of the survey. A source ahead of the centre of the sub-array (at
greater z) has a positive arrival angle: the elements with greater z are nearer to it and lead.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from sonar_tracking.bags.tables.npz_file import read_npz
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import FloatArray

SUB_ARRAY_ELEMENTS = 8
DWELL = 2.0
"""Time at each position of the sub-array, s."""
LEAD_IN = 2.0
"""Additional time at the first one, in which tracks are started, s."""
SOUND_SPEED = 343.0
SIGNAL_TO_NOISE_DB = 20.0
"""Mean power of each source over the noise of an element, in the band of the snapshots."""

_AT_ONCE = 8192
"""Samples of all elements that stay near the processor while they are rounded."""
_SOURCE_BANDWIDTH = 300.0
_TRUTH_PERIOD = 0.1
_FULL_SCALE = 0.5
STUDIED_SOURCES = frozenset((1, 2, 3, 4, 5, 8, 9))
"""Numbers of the sources that the study puts together."""

_KEYS = ("rir", "rir_scale", "fs_hz", "source_id", "source_xz_m", "mic_xz_m")


@dataclass(frozen=True)
class RoomResponses:
    """Measured responses and surveyed positions.

    Attributes
    ----------
    responses : ndarray, shape (n_sources, n_elements, n_samples)
        Impulse responses, linear amplitude.
    sample_rate : int
        Hz.
    source_ids : tuple of int
        Numbers of the sources.
    source_positions : ndarray, shape (n_sources, 2)
        Distance from the array's line and place along it, m.
    element_places : ndarray, shape (n_elements,)
        Along the array, m.
    """

    responses: FloatArray
    sample_rate: int
    source_ids: tuple[int, ...]
    source_positions: FloatArray
    element_places: FloatArray

    @property
    def n_sub_arrays(self) -> int:
        """Positions of the sub-array."""
        return len(self.element_places) - SUB_ARRAY_ELEMENTS + 1

    @property
    def duration(self) -> float:
        """Length of a recording, s."""
        return LEAD_IN + DWELL * self.n_sub_arrays

    def sub_array_at(self, time: float) -> int:
        """Return the position of the sub-array at a time of the recording, s."""
        return min(max(int((time - LEAD_IN) // DWELL), 0), self.n_sub_arrays - 1)

    def arrival_angle(self, source: int, sub_array: int) -> float:
        """Return the surveyed arrival angle of a source at a sub-array, rad."""
        distance, place = self.source_positions[self.source_ids.index(source)]
        elements = self.element_places[sub_array : sub_array + SUB_ARRAY_ELEMENTS]
        return float(np.arctan2(place - elements.mean(), distance))


def read_room_responses(path: Path | str) -> RoomResponses:
    """Read the measured responses.

    Parameters
    ----------
    path : Path or str
        The ``.npz`` file.

    Raises
    ------
    ConfigurationError
        If it cannot be read or holds something else.
    """
    data = read_npz(path)
    missing = [key for key in _KEYS if key not in data]
    if missing:
        raise ConfigurationError(
            f"{path} holds no {', '.join(missing)}; give a file of measured responses, with "
            f"{', '.join(_KEYS)}: the page room-array of the documentation tells their shapes."
        )
    try:
        room = RoomResponses(
            responses=data["rir"] * float(data["rir_scale"]),
            sample_rate=int(data["fs_hz"]),
            source_ids=tuple(int(number) for number in data["source_id"]),
            source_positions=np.asarray(data["source_xz_m"], dtype=np.float64),
            element_places=np.asarray(data["mic_xz_m"], dtype=np.float64)[:, 1],
        )
    except (ValueError, TypeError, IndexError) as error:
        raise ConfigurationError(f"The room responses {path} cannot be used ({error}).") from error
    _check(room, path)
    return room


def _check(room: RoomResponses, path: Path | str) -> None:
    n_sources, n_elements = len(room.source_ids), len(room.element_places)
    shape = room.responses.shape
    if len(shape) != 3 or shape[:2] != (n_sources, n_elements):
        raise ConfigurationError(
            f"{path} has rir of shape {shape}, but {n_sources} entries of source_id and "
            f"{n_elements} of mic_xz_m; it must be sources x elements x samples."
        )
    if room.source_positions.shape != (n_sources, 2) or n_elements < SUB_ARRAY_ELEMENTS:
        raise ConfigurationError(
            f"{path} needs source_xz_m of shape ({n_sources}, 2), and at least "
            f"{SUB_ARRAY_ELEMENTS} elements."
        )


def check_sources(room: RoomResponses, path: Path | str) -> None:
    """Refuse responses that lack a source which the study puts together.

    Raises
    ------
    ConfigurationError
        With the sources there are and those that are missing.
    """
    absent = sorted(STUDIED_SOURCES - set(room.source_ids))
    if absent:
        raise ConfigurationError(
            f"{path} has the sources {', '.join(map(str, room.source_ids))} and lacks "
            f"{', '.join(map(str, absent))}: number the near ones 1 to 3, those beyond the near "
            "field 4, 5, 8 and 9 in source_id."
        )


def child_seed(seed: np.random.SeedSequence, *key: int) -> np.random.SeedSequence:
    """Return a seed that depends on the key alone, not on what was drawn or spawned before."""
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, *key))


def source_noise(
    n_samples: int, frequency: float, sample_rate: int, generator: np.random.Generator
) -> FloatArray:
    """Return the noise that a source sends.

    Parameters
    ----------
    n_samples : int
        How long.
    frequency : float
        Centre of its band, Hz.
    sample_rate : int
        Hz.
    generator : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    ndarray, shape (n_samples,)
        Linear amplitude.
    """
    from scipy.signal import firwin, oaconvolve  # takes longer to load than any study

    edges = [frequency - _SOURCE_BANDWIDTH / 2, frequency + _SOURCE_BANDWIDTH / 2]
    band = firwin(1025, edges, pass_zero=False, fs=sample_rate)
    return np.asarray(oaconvolve(generator.normal(size=n_samples), band, "same"))


def received_signal(
    room: RoomResponses, source: int, frequency: float, generator: np.random.Generator
) -> NDArray[np.float32]:
    """Return what the sliding sub-array receives of one source, mean power 1.

    Parameters
    ----------
    room : RoomResponses
        Measured responses.
    source : int
        Number of the source.
    frequency : float
        Centre of its noise, Hz.
    generator : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    ndarray, shape (n_samples, SUB_ARRAY_ELEMENTS)
        Samples at the rate of the responses, linear amplitude.
    """
    from scipy.signal import oaconvolve  # likewise

    responses = room.responses[room.source_ids.index(source)]
    history = responses.shape[1] - 1
    n_samples = round(room.duration * room.sample_rate)
    noise = source_noise(n_samples + history, frequency, room.sample_rate, generator)
    received = np.empty((n_samples, SUB_ARRAY_ELEMENTS), np.float32)
    for sub_array in range(room.n_sub_arrays):
        start, stop = (round(t * room.sample_rate) for t in _dwell(sub_array))
        elements = responses[sub_array : sub_array + SUB_ARRAY_ELEMENTS]
        heard = oaconvolve(noise[None, start : stop + history], elements, "valid", axes=1)
        received[start:stop] = heard.T
    received /= np.sqrt(np.mean(received**2))
    return received


def write_recording(
    room: RoomResponses,
    sources: tuple[int, ...],
    signals: list[NDArray[np.float32]],
    snapshot_bandwidth: float,
    generator: np.random.Generator,
    directory: Path,
) -> tuple[Path, Path, Path]:
    """Write a multichannel WAV file of some sources, its geometry and its true bearings.

    Parameters
    ----------
    room : RoomResponses
        Measured responses.
    sources : tuple of int
        Numbers of the sources.
    signals : list of ndarray, shape (n_samples, SUB_ARRAY_ELEMENTS)
        What is received of each, linear amplitude.
    snapshot_bandwidth : float
        Band in which the noise is SIGNAL_TO_NOISE_DB below each source, Hz.
    generator : numpy.random.Generator
        Of the noise.
    directory : Path
        Where to write.

    Returns
    -------
    tuple of Path
        WAV file, geometry file, truth file.
    """
    from scipy.io import wavfile

    # The source has its power in its own band, white noise spreads over half the sample rate.
    in_band = min(snapshot_bandwidth / _SOURCE_BANDWIDTH, 1.0)
    noise_power = in_band * 10 ** (-SIGNAL_TO_NOISE_DB / 10)
    noise_power *= room.sample_rate / 2 / snapshot_bandwidth
    mixed = generator.normal(scale=np.sqrt(noise_power), size=signals[0].shape)
    for signal in signals:
        mixed += signal
    scale = _FULL_SCALE / max(mixed.max(), -mixed.min())
    wav, geometry, truth = (directory / name for name in ("array.wav", "array.yaml", "truth.csv"))
    samples = np.empty(mixed.shape, np.int16)
    for begin in range(0, len(mixed), _AT_ONCE):
        part = mixed[begin : begin + _AT_ONCE]
        part *= scale
        part *= 32767
        samples[begin : begin + _AT_ONCE] = np.rint(part, out=part)
    wavfile.write(wav, room.sample_rate, samples)
    geometry.write_text(_geometry_text(room))
    truth.write_text(_truth_text(room, sources))
    return wav, geometry, truth


def _geometry_text(room: RoomResponses) -> str:
    return yaml.safe_dump(
        {
            "sensor_id": "room_array",
            "n_elements": SUB_ARRAY_ELEMENTS,
            "spacing": round(float(np.diff(room.element_places).mean()), 9),
            "sound_speed": SOUND_SPEED,
            "channels": list(range(1, SUB_ARRAY_ELEMENTS + 1)),
        }
    )


def _truth_text(room: RoomResponses, sources: tuple[int, ...]) -> str:
    lines = ["time_s,target,arrival_angle_deg"]
    for time in np.arange(0.0, room.duration, _TRUTH_PERIOD):
        sub_array = room.sub_array_at(time + _TRUTH_PERIOD / 2)
        for source in sources:
            angle = np.degrees(room.arrival_angle(source, sub_array))
            lines.append(f"{time:.1f},source {source},{angle:.4f}")
    return "\n".join(lines) + "\n"


def end_of_dwell(sub_array: int) -> float:
    """Return the time at which the sub-array leaves a position, s."""
    return _dwell(sub_array)[1]


def _dwell(sub_array: int) -> tuple[float, float]:
    """Return begin and end of the time at a position of the sub-array, s."""
    begin = LEAD_IN + DWELL * sub_array
    return (0.0 if sub_array == 0 else begin), begin + DWELL
