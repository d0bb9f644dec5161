"""Kinematics: legs and turns join smoothly, and the emission time solves the delay equation."""

import numpy as np
import pytest

from sonar_tracking.motion import (
    Trajectory,
    Turn,
    azimuth_from_compass,
    compass_from_azimuth,
    compass_from_vector,
    emission_times,
    vector_from_compass,
    wrap_angle,
)


@pytest.mark.parametrize(
    ("compass_deg", "azimuth_deg"), [(0.0, 90.0), (90.0, 0.0), (180.0, -90.0), (270.0, -180.0)]
)
def test_compass_is_clockwise_from_north(compass_deg: float, azimuth_deg: float) -> None:
    difference = wrap_angle(azimuth_from_compass(compass_deg) - np.radians(azimuth_deg))
    assert difference == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("compass_deg", [0.0, 45.0, 90.0, 200.0, 359.0])
def test_compass_and_azimuth_are_inverse(compass_deg: float) -> None:
    assert compass_from_azimuth(azimuth_from_compass(compass_deg)) == pytest.approx(compass_deg)


def test_straight_leg_extends_backwards_in_time() -> None:
    state = Trajectory((10.0, 20.0), np.pi / 2, 4.0).state([-5.0, 0.0, 2.5])
    np.testing.assert_allclose(state.position, [[10, 0], [10, 20], [10, 30]], atol=1e-12)
    np.testing.assert_allclose(state.velocity, [[0, 4]] * 3, atol=1e-12)


def test_many_times_on_one_leg_have_the_states_of_each_by_itself() -> None:
    trajectory = Trajectory((5.0, -7.0), 0.3, 6.0, [Turn(3.0, 2.0, 0.2), Turn(40.0, 0.5, 0.05)])
    for times in ([-2.0, 0.0, 2.9], [[20.0, 30.0], [25.0, 39.9]], [2.9, 3.1], [3.1, 4.0], []):
        together = trajectory.state(times)
        for place, time in np.ndenumerate(times):
            alone = trajectory.state(time)
            for name in ("position", "velocity", "azimuth", "turn_rate"):
                np.testing.assert_array_equal(getattr(together, name)[place], getattr(alone, name))


def test_quarter_turn_follows_its_circle() -> None:
    """10 m/s and 0.1 rad/s make a circle of radius 100 m: east to north ends at (100, 100)."""
    trajectory = Trajectory((0.0, 0.0), 0.0, 10.0, [Turn(0.0, np.pi / 2, 0.1)])
    end = np.pi / 2 / 0.1
    state = trajectory.state([end, end + 10.0])
    np.testing.assert_allclose(state.position, [[100, 100], [100, 200]], atol=1e-9)
    np.testing.assert_allclose(state.turn_rate, [0.0, 0.0])


def test_turn_takes_the_shorter_way() -> None:
    trajectory = Trajectory((0.0, 0.0), np.radians(170.0), 1.0, [Turn(1.0, np.radians(-170), 0.01)])
    assert trajectory.state(2.0).turn_rate == pytest.approx(0.01)
    assert trajectory.state(1e4).azimuth == pytest.approx(np.radians(190.0))


def test_velocity_is_the_derivative_of_position_everywhere() -> None:
    turns = [Turn(3.0, 2.0, 0.2), Turn(5.0, -1.0, 0.4), Turn(40.0, 0.5, 0.05)]
    trajectory = Trajectory((5.0, -7.0), 0.3, 6.0, turns)
    times = np.linspace(-2.0, 60.0, 1001)
    step = 1e-4
    before, after = trajectory.state(times - step), trajectory.state(times + step)
    slope = (after.position - before.position) / (2 * step)
    # Across the begin or end of a turn the difference quotient is off by rate * step at most.
    np.testing.assert_allclose(slope, trajectory.state(times).velocity, atol=6.0 * 0.4 * step)


def test_emission_time_matches_the_closed_form_of_constant_velocity() -> None:
    position, speed, azimuth, sound_speed = np.array([800.0, -300.0]), 20.0, 2.1, 1500.0
    velocity = speed * np.array([np.cos(azimuth), np.sin(azimuth)])
    times = np.linspace(-10.0, 100.0, 57)
    receivers = np.stack([3.0 * times, 50.0 - 2.0 * times], axis=-1)
    # |D - v tau|^2 = c^2 tau^2 with D = p + v t - p_receiver(t): a quadratic in tau.
    offset = position + velocity * times[:, None] - receivers
    a = sound_speed**2 - speed**2
    b = offset @ velocity
    tau = (-b + np.sqrt(b**2 + a * np.sum(offset**2, axis=-1))) / a
    result = emission_times(
        Trajectory(tuple(position), azimuth, speed), receivers, times, sound_speed
    )
    np.testing.assert_allclose(result, times - tau, rtol=0, atol=1e-12)


def test_emission_time_solves_the_equation_through_turns() -> None:
    target = Trajectory((2000.0, 0.0), 0.0, 40.0, [Turn(5.0, 3.0, 0.3), Turn(30.0, 0.0, 0.2)])
    times = np.linspace(0.0, 60.0, 400)
    receivers = np.zeros((400, 2))
    emitted = emission_times(target, receivers, times, 340.0)
    distance = np.linalg.norm(target.state(emitted).position, axis=-1)
    np.testing.assert_allclose(340.0 * (times - emitted), distance, atol=1e-6)


def test_emission_times_of_a_receiver_close_by_start_from_those_of_its_neighbour() -> None:
    """Elements up to 30 m apart, a fast target in a turn at close range: still to rounding."""
    target = Trajectory((300.0, 0.0), 0.0, 40.0, [Turn(5.0, 3.0, 0.3)])
    times = np.linspace(0.0, 60.0, 400)
    receivers = np.zeros((400, 2))
    origin = emission_times(target, receivers, times, 1500.0)
    near = emission_times(target, receivers + 21.0, times, 1500.0, near=origin)
    exact = emission_times(target, receivers + 21.0, times, 1500.0)
    np.testing.assert_allclose(near, exact, rtol=0, atol=1e-13)


def test_a_course_and_its_velocity_belong_together() -> None:
    velocity = vector_from_compass([0.0, 90.0, 225.0], [2.0, 3.0, 1.0])
    root = np.sqrt(0.5)
    np.testing.assert_allclose(velocity, [[0.0, 2.0], [3.0, 0.0], [-root, -root]], atol=1e-12)
    np.testing.assert_allclose(compass_from_vector(velocity), [0.0, 90.0, 225.0], atol=1e-12)
