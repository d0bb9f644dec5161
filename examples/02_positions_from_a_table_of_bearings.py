"""Target motion analysis: range, course and speed of a target from a table of its bearings.

Bearings alone tell no range while own ship keeps its course: the deviation of the range stays that
of the prior, and the observability says so. The turn after ten minutes makes the motion observable.
"""

import numpy as np

from sonar_tracking.motion import azimuth_from_compass, compass_from_vector, vector_from_compass
from sonar_tracking.records import nanoseconds
from sonar_tracking.tma import TargetObservation, TargetSolver

INTERVAL, DURATION, TURN = 10.0, 1500.0, 600.0  # s
DEVIATION_DEG = 0.3
TARGET_VELOCITY = vector_from_compass(200.0, 4.0)


def table_of_bearings() -> np.ndarray:
    """Return time, own place and velocity, compass bearing in deg, and the true range."""
    generator = np.random.default_rng(3)
    own, target, rows = np.zeros(2), np.array([4000.0, 7000.0]), []
    for time in np.arange(0.0, DURATION + 1.0, INTERVAL):
        velocity = vector_from_compass(60.0 if time < TURN else 330.0, 5.0)
        bearing = compass_from_vector(target - own) + DEVIATION_DEG * generator.standard_normal()
        rows.append([time, *own, *velocity, bearing, np.hypot(*(target - own))])
        own, target = own + INTERVAL * velocity, target + INTERVAL * TARGET_VELOCITY
    return np.array(rows)


def main() -> None:
    """Feed the table to a solver, line by line."""
    print("time   range (true)  deviation   course    speed   observability")
    solver = TargetSolver()
    for time, x, y, vx, vy, bearing_deg, true_range in table_of_bearings().tolist():
        observation = TargetObservation(
            stamp=nanoseconds(time),
            sensor_id="array",
            position=(x, y),
            velocity=(vx, vy),
            azimuths=(float(azimuth_from_compass(bearing_deg)),),
            azimuth_variance=np.radians(DEVIATION_DEG) ** 2,
        )
        (solution,) = solver.update(observation)
        if time % 300.0 == 0.0:
            distance, deviation = solution.range_from((x, y))
            course, speed = compass_from_vector(solution.mean[2:]), np.hypot(*solution.mean[2:])
            print(
                f"{time:4.0f} s {distance:6.0f} m ({true_range:4.0f}) {deviation:6.0f} m"
                f"   {course:4.0f} deg {speed:5.1f} m/s   {solution.observability:.2f}"
            )
    print("true course 200 deg, speed 4.0 m/s; own ship turned after 600 s")


if __name__ == "__main__":
    main()
