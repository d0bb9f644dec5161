"""Element time series in, lines of each target out: nothing invented, nothing given away."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.configuration import from_mapping
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.passive.lines.line_tracker_stage import (
    LineTrackerConfiguration,
    LineTrackerStage,
    LineUpdate,
)
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS
from sonar_tracking.simulation.signals.sample_propagation import plane_wave_emission_times
from tests.passive.sample_scene import (
    EPOCH,
    POSITIONS,
    RATE,
    SOUND_SPEED,
    Tone,
    bearings,
    blocks,
    element_samples,
)

TARGET = Tone(301.3, 20.0, 3.0)
"""About 16 dB over the noise of a beam."""


def run(
    stream: list[ArraySamples],
    tracks: BearingTracks | None,
    stage: LineTrackerStage | None = None,
) -> list[LineUpdate]:
    stage = stage or LineTrackerStage()
    pictures = [] if tracks is None else [tracks]
    updates: list[LineUpdate] = []
    for block in stream:
        updates.extend(stage.update(block, pictures))
        pictures = []
    return updates


def listen(
    tones: Sequence[Tone], angles_deg: Sequence[float], seconds: float = 12.0, **values: object
) -> list[LineUpdate]:
    stage = LineTrackerStage(LineTrackerConfiguration(**values))  # type: ignore[arg-type]
    return run(blocks(element_samples(tones, seconds)), bearings(angles_deg), stage)


def owners(update: LineUpdate) -> list[tuple[int, float]]:
    lines = update.lines
    return [
        (int(track), round(float(frequency)))
        for track, frequency in zip(lines.track_id, lines.frequency, strict=True)
    ]


def test_lines_are_found_with_their_frequency_angle_and_level() -> None:
    updates = listen([TARGET, Tone(220.6, 20.0, 10.0)], [20.0], seconds=40.0)
    errors = []
    for update in updates[2:-1]:
        lines = update.lines
        by_frequency = np.argsort(lines.frequency)
        assert len(by_frequency) == 2
        errors.append(
            (lines.frequency[by_frequency] - [220.6, 301.3])
            / lines.standard_deviation[by_frequency]
        )
        np.testing.assert_allclose(lines.arrival_angle, np.radians(20.0))
        np.testing.assert_allclose(lines.integration_time, 2.0)
        assert update.rows is not None
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(1.0, abs=0.25)
    # 2 s frames: 2/3 T over the level in 1 Hz, and 16 elements average the noise.
    levels = [np.sort(update.lines.signal_to_noise_ratio) for update in updates[2:-1]]
    expected = 10.0 ** np.array([0.3, 1.0]) * 2.0 / 1.5 * 16.0
    np.testing.assert_allclose(np.mean(levels, axis=0), expected, rtol=0.15)


def test_one_list_a_frame_in_its_middle_and_the_end_is_passed_on() -> None:
    updates = listen([TARGET], [20.0])
    stamps = [update.lines.stamp for update in updates]
    assert stamps == [EPOCH + second * NANOSECONDS for second in range(1, 13)]
    assert [update.lines.next_stamp for update in updates] == [*stamps[1:], END_OF_DATA]
    assert updates[-1].rows is None and len(updates[-1].lines.frequency) == 0


@pytest.mark.slow
def test_noise_exceeds_the_threshold_as_often_as_stated_in_every_beam() -> None:
    """The whole way from samples to rows: 3 beams, 121 frames, 780 bins, 283,000 trials."""
    probability = 1e-3
    stage = LineTrackerStage(LineTrackerConfiguration(false_alarm_probability=probability))
    updates = run(blocks(element_samples([], 122.0, seed=8)), bearings([-50.0, 0.0, 40.0]), stage)
    analysis = stage.analysis
    assert analysis is not None
    threshold_db = 10.0 * np.log10(analysis.normaliser.threshold[analysis.inside])
    rows = [update.rows.level_db for update in updates if update.rows is not None]
    share = np.mean(np.stack(rows) > threshold_db)
    assert share / probability == pytest.approx(1.0, abs=0.05 + 3.0 * np.sqrt(2.0 / 283.0))


@pytest.mark.slow
def test_noise_makes_hardly_a_line() -> None:
    updates = run(blocks(element_samples([], 122.0, seed=8)), bearings([-50.0, 0.0, 40.0]))
    assert sum(len(update.lines.frequency) for update in updates) == 0


def test_a_line_in_the_sidelobes_of_another_beam_stays_with_its_target() -> None:
    """35 dB over the noise of its beam: every other beam hears it over the threshold too."""
    updates = listen([Tone(301.3, 20.0, 22.0)], [-40.0, 20.0, 55.0])
    assert all(owners(update) == [(2, 301)] for update in updates[2:-1])


def test_a_line_without_a_track_stays_unassociated() -> None:
    """A strong source without a track is heard in the sidelobes and flanks of tracked beams."""
    for angle in (70.0, 26.5):  # the second 6 dB down in the beam on 20 deg
        updates = listen([Tone(301.3, angle, 22.0)], [-40.0, 20.0])
        assert all(owners(update) == [] for update in updates)


def test_in_beams_that_overlap_the_stronger_gets_the_line_and_keeps_it() -> None:
    """5 deg apart, a beam is 6 deg wide there: both hear it, the order of the tracks is no rule."""
    for angles, owner in (([20.0, 25.0], 1), ([25.0, 20.0], 2)):
        updates = listen([Tone(301.3, 20.5, 10.0)], angles)
        assert all(owners(update) == [(owner, 301)] for update in updates[2:-1])


def test_a_line_changes_its_owner_when_the_other_is_clearly_louder() -> None:
    """The target moves from one beam to the next; the line's name stays."""
    samples = np.concatenate(
        [element_samples([Tone(301.3, angle, 10.0)], 10.0) for angle in (0.0, 30.0)]
    )
    updates = run(blocks(samples), bearings([0.0, 30.0]))
    assert owners(updates[5]) == [(1, 301)] and owners(updates[-2]) == [(2, 301)]
    assert {int(name) for update in updates for name in update.lines.line_id} == {1}


def test_a_line_keeps_its_owner_while_the_other_is_hardly_louder() -> None:
    """Between beams on 20 and 25 deg: 23.3 deg is nearer to the second, by less than 3 dB."""
    samples = np.concatenate(
        [element_samples([Tone(301.3, angle, 15.0)], 10.0) for angle in (20.5, 23.3, 26.5)]
    )
    updates = run(blocks(samples), bearings([20.0, 25.0]))
    assert [owners(updates[index]) for index in (7, 17, 27)] == [[(1, 301)], [(1, 301)], [(2, 301)]]
    alone = run(blocks(samples[10_000:20_000]), bearings([20.0, 25.0]))
    assert owners(alone[-3]) == [(2, 301)]


def test_lines_of_own_ship_are_left_out_and_do_no_harm() -> None:
    tones = [Tone(150.4, 20.0, 40.0), Tone(220.6, 20.0, 10.0)]
    assert owners(listen(tones, [20.0])[-2]) == [(1, 150), (1, 221)]
    masked = listen(tones, [20.0], own_ship_frequencies=(150.0,), own_ship_tolerance=0.5)
    assert owners(masked[-2]) == [(1, 221)]


def test_the_beam_follows_the_bearing_between_pictures() -> None:
    """The newest picture at or before the middle of a frame, moved on with its rate."""
    stage = LineTrackerStage()
    pictures = [bearings([10.0], EPOCH, [2.0]), bearings([40.0], EPOCH + 5 * NANOSECONDS, [-1.0])]
    angles = []
    for block in blocks(element_samples([Tone(30.0, 20.0, 20.0)], 9.0)):  # heard in any beam
        angles += [update.lines.arrival_angle for update in stage.update(block, pictures)]
        pictures = []
    assert np.degrees(np.concatenate(angles)) == pytest.approx([16.0, 18.0, 40.0, 39.0, 38.0, 37.0])


def test_the_variance_of_a_beam_is_predicted_with_the_bearing() -> None:
    """2 s after its picture: P11 + 2 t P12 + t^2 P22."""
    stage = LineTrackerStage()
    covariance = np.array([[[4e-6, 1e-6], [1e-6, 9e-6]]])
    stream = blocks(element_samples([TARGET], 5.0))
    updates = run(stream, replace(bearings([20.0]), covariance=covariance), stage)
    heard = next(each.lines for each in updates if len(each.lines.frequency))
    step = (heard.stamp - EPOCH) / NANOSECONDS
    expected = 4e-6 + 2.0 * step * 1e-6 + step**2 * 9e-6
    np.testing.assert_allclose(heard.arrival_angle_variance, expected)


@pytest.mark.parametrize(("angles_deg", "owner"), [((50.0, 130.0), 2), ((130.0, 50.0), 1)])
def test_an_array_that_is_no_line_tells_ahead_from_astern(
    angles_deg: tuple[float, float], owner: int
) -> None:
    """A circle of elements, a tone from 130 degrees: its mirror image at 50 hears nothing."""
    around = 2.0 * np.pi * np.arange(16) / 16
    circle = 4.0 * np.stack([np.cos(around), np.sin(around), np.zeros(16)], axis=1)
    times = np.arange(round(8.0 * RATE)) / RATE
    emitted = plane_wave_emission_times(np.array(np.radians(130.0)), SOUND_SPEED, circle, times)
    data = element_samples([], 8.0) + 10.0 * np.cos(2.0 * np.pi * 240.3 * emitted)
    stream = [replace(each, element_positions=circle) for each in blocks(data)]
    updates = run(stream, bearings(angles_deg))
    assert all(owners(update) == [(owner, 240)] for update in updates[2:-1])


def test_without_bearings_there_are_no_lines() -> None:
    stream = blocks(element_samples([TARGET], 12.0))
    tentative = bearings([20.0], status=TrackStatus.TENTATIVE)
    later = bearings([20.0], EPOCH + 100 * NANOSECONDS)
    for picture in (None, bearings([]), tentative, later):
        updates = run(stream, picture)
        assert [owners(update) for update in updates] == [[]] * 12


def test_lost_and_unusable_blocks_cost_their_frames_and_no_more() -> None:
    stream = blocks(element_samples([TARGET], 16.0))
    stage = LineTrackerStage()
    pictures: list[BearingTracks] = [bearings([20.0])]
    updates: list[LineUpdate] = []
    for index, block in enumerate(stream):
        if index == 30:
            data = block.data.copy()
            data[5, 3] = np.nan
            with pytest.raises(InputError, match="Element 3 of sample 5"):
                stage.update(replace(block, data=data))
            continue
        updates.extend(stage.update(block, pictures))
        pictures = []
    heard = [len(update.lines.frequency) for update in updates]
    assert heard == [0, 0, 1, 1, 1, 1, 0, 0] + [1] * 7 + [0]
    assert {int(name) for update in updates for name in update.lines.line_id} == {1}


def test_the_size_of_the_blocks_does_not_change_a_bit() -> None:
    data = element_samples([TARGET], 12.0)
    expected = run(blocks(data), bearings([20.0]))
    for updates in (run(blocks(data, 999), bearings([20.0])), run(blocks(data), bearings([20.0]))):
        for update, other in zip(updates, expected, strict=True):
            np.testing.assert_array_equal(update.lines.frequency, other.lines.frequency)


def test_after_a_reset_names_go_on() -> None:
    stage = LineTrackerStage(LineTrackerConfiguration(first_id=5))
    stream = blocks(element_samples([TARGET], 12.0))
    first = run(stream, bearings([20.0]), stage)
    stage.reset()
    second = run(stream, bearings([20.0]), stage)
    assert first[5].lines.line_id.tolist() == [5]
    assert second[5].lines.line_id[0] > 5


@pytest.mark.parametrize("gain", [0.0, 1e-3, 300.0])
def test_a_bad_element_is_named_once_and_costs_no_line(gain: float) -> None:
    """Element 5 fails after 10 s and comes back after 20 s; 50 dB of noise would hide the line."""
    data = element_samples([TARGET], 30.0)
    data[10_000:20_000, 5] = gain * element_samples([], 10.0, seed=3)[:, 0]
    updates = run(blocks(data), bearings([20.0]))
    assert all(owners(update) == [(1, 301)] for update in updates[2:-1])
    notices = [notice.text for update in updates for notice in update.notices]
    assert len(notices) == 1 and "Element 5 is silent, or far louder" in notices[0]


def test_when_most_elements_are_bad_all_are_used() -> None:
    data = element_samples([TARGET], 12.0)
    data[:, :5] *= 1e-4
    data[:, 11:] *= 1e4
    updates = run(blocks(data), bearings([20.0]))
    assert not any(update.notices for update in updates)
    assert updates[5].rows is not None and np.isfinite(updates[5].rows.level_db).all()


def test_an_array_that_aliases_at_high_frequencies_is_told() -> None:
    stream = [
        replace(each, element_positions=2.0 * POSITIONS) for each in blocks(np.ones((9000, 16)))
    ]
    notices = [notice for update in run(stream, None) for notice in update.notices]
    assert len(notices) == 1 and "half a wavelength" in notices[0].text


def test_parameters_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(ConfigurationError, match="confirmation_frames"):
        LineTrackerStage(LineTrackerConfiguration(confirmation_hits=6, confirmation_frames=5))
    LineTrackerStage(LineTrackerConfiguration(confirmation_hits=5, confirmation_frames=5))
    with pytest.raises(ConfigurationError, match="maximum_frequency"):
        LineTrackerStage(LineTrackerConfiguration(minimum_frequency=50.0, maximum_frequency=20.0))


@pytest.mark.parametrize("length", [0.5, 5.0])
def test_frames_last_one_to_four_seconds(length: float) -> None:
    with pytest.raises(ConfigurationError, match="frame_length"):
        from_mapping(LineTrackerConfiguration, {"frame_length": length}, "here")


@pytest.mark.slow
@pytest.mark.parametrize("level_db", [3.0, 10.0, 25.0])
@pytest.mark.parametrize("drift", [0.0, 0.05])
def test_claimed_deviations_hold_through_the_whole_stage(level_db: float, drift: float) -> None:
    """From 16 to 38 dB over the noise of the beam, drifting as in a turn of own ship."""
    seconds = 150.0
    times = np.arange(round(seconds * RATE)) / RATE
    data = element_samples([], seconds, seed=4)
    emitted = times[:, None] + POSITIONS[:, 0] * np.sin(np.radians(20.0)) / SOUND_SPEED
    phase = 2.0 * np.pi * (300.2 * emitted + 0.5 * drift * emitted**2)
    data += np.sqrt(2.0 * 10.0 ** (level_db / 10.0)) * np.cos(phase)
    squares: list[float] = []
    for update in run(blocks(data), bearings([20.0]))[3:-1]:
        middle = (update.lines.stamp - EPOCH) / NANOSECONDS
        error = update.lines.frequency - (300.2 + drift * middle)
        squares.extend((error / update.lines.standard_deviation) ** 2)
    assert len(squares) > 140
    # Frames overlap by half: about 100 independent errors, whose mean square scatters by 0.14.
    assert np.mean(squares) == pytest.approx(1.0, abs=0.35)
