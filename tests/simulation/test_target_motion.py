"""Bearings of moving targets: exact rates, propagation delay, sides of the array."""

import numpy as np
import pytest

from sonar_tracking.motion import Trajectory, Turn
from sonar_tracking.simulation.scenarios.bearing_motion import (
    ArctangentMotion,
    LinearMotion,
    SinusoidalMotion,
    TableMotion,
    TargetMotion,
)
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import Receiver, TurnConfiguration


def receiver(
    sound_speed: float = 1500.0,
    ambiguous: bool = True,
    mounting_yaw: float = 0.0,
    trajectory: Trajectory | None = None,
) -> Receiver:
    """Return an array along x (east) at rest in the origin unless told otherwise."""
    trajectory = trajectory or Trajectory((0.0, 0.0), 0.0, 0.0)
    return Receiver(trajectory, mounting_yaw, sound_speed, ambiguous)


MOVING = Trajectory((10.0, -20.0), 0.4, 6.0, [Turn(3.0, 2.0, 0.1)])

MOTIONS: list[TargetMotion] = [
    ArctangentMotion(rate_deg=-2.5, crossing_time=4.0, offset_deg=5.0),
    LinearMotion(offset_deg=-10.0, rate_deg=1.5, reference_time=2.0),
    SinusoidalMotion(offset_deg=10.0, amplitude_deg=40.0, period=30.0, phase_deg=50.0),
    TableMotion(times=(-100.0, 0.013, 100.0), bearings_deg=(-10.0, 5.0, 40.0)),
    KinematicMotion(position=(300.0, 400.0), course_deg=200.0, speed=15.0),
    KinematicMotion(
        position=(-300.0, -400.0),
        course_deg=20.0,
        speed=15.0,
        turns=(TurnConfiguration(time=2.0, course_deg=300.0, rate_deg=5.0),),
    ),
]


@pytest.mark.parametrize("motion", MOTIONS)
def test_rate_is_the_derivative_of_the_angle(motion: TargetMotion) -> None:
    world = receiver(trajectory=MOVING, mounting_yaw=0.3, sound_speed=340.0)
    times, step = np.linspace(0.1, 9.9, 50), 1e-4
    before, _ = motion.arrival(times - step, world)
    after, _ = motion.arrival(times + step, world)
    _, rate = motion.arrival(times, world)
    np.testing.assert_allclose((after - before) / (2.0 * step), rate, atol=2e-6)


@pytest.mark.parametrize(
    ("position", "angle_deg"),
    [
        ((0.0, 500.0), 0.0),  # abeam to the left
        ((0.0, -500.0), 0.0),  # abeam to the right: the same cone
        ((500.0, 0.0), 90.0),  # beyond the last element
        ((-500.0, 0.0), -90.0),
        ((500.0, 500.0), 45.0),
        ((500.0, -500.0), 45.0),
    ],
)
def test_arrival_angle_of_a_line_array(position: tuple[float, float], angle_deg: float) -> None:
    angle, _ = KinematicMotion(position=position).arrival(np.array([0.0]), receiver())
    assert np.degrees(angle[0]) == pytest.approx(angle_deg, abs=1e-9)


def test_other_arrays_tell_the_sides_apart() -> None:
    times = np.array([0.0])
    angle, _ = KinematicMotion(position=(500.0, -500.0)).arrival(times, receiver(ambiguous=False))
    assert np.degrees(angle[0]) == pytest.approx(135.0)


def test_mounting_turns_the_axis() -> None:
    """Heading north with the axis 90 deg to port of the bow: the axis points west."""
    world = receiver(trajectory=Trajectory((0, 0), np.pi / 2, 0.0), mounting_yaw=np.pi / 2)
    angle, _ = KinematicMotion(position=(-500.0, 0.0)).arrival(np.array([0.0]), world)
    assert np.degrees(angle[0]) == pytest.approx(90.0, abs=1e-9)


def test_bearing_is_that_of_the_place_of_emission() -> None:
    """Heard at t = 0 abeam at 1500 m: the sound left one second ago, the target is 20 m on."""
    motion = KinematicMotion(position=(20.0, 1500.0), course_deg=90.0, speed=20.0)
    angle, rate = motion.arrival(np.array([0.0]), receiver())
    assert angle[0] == pytest.approx(0.0, abs=1e-12)
    assert rate[0] == pytest.approx(20.0 / 1500.0)


def test_table_holds_its_ends() -> None:
    motion = TableMotion(times=(0.0, 10.0), bearings_deg=(-10.0, 30.0))
    angle, rate = motion.arrival(np.array([-5.0, 5.0, 15.0]), receiver())
    np.testing.assert_allclose(np.degrees(angle), [-10.0, 10.0, 30.0])
    np.testing.assert_allclose(np.degrees(rate), [0.0, 4.0, 0.0])
