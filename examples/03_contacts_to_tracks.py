"""Contacts of an active sonar become tracks: two targets cross among sixty false contacts a ping.

Every contact starts a candidate; its probability of existence says which are targets. After twelve
minutes the targets pass within 200 m, and each keeps its track.
"""

import numpy as np

from sonar_tracking.active import ContactTrackerConfiguration, make_contact_tracker
from sonar_tracking.motion import compass_from_vector, vector_from_compass
from sonar_tracking.records import Contacts, nanoseconds

PING_INTERVAL, SHOWN = 10.0, (5, 30, 60, 110)  # s
RANGE_DEVIATION, AZIMUTH_DEVIATION = 20.0, np.radians(0.5)
FALSE_CONTACTS, MAXIMUM_RANGE = 60, 6000.0
THRESHOLD, TARGET_POWER, DETECTION = 6.0, 57.0, 0.9  # powers over that of the noise
START, VELOCITY = [[-3000, 2400], [-2900, 4500]], vector_from_compass([80.0, 115.0], 5.0)


def ping(number: int, generator: np.random.Generator) -> Contacts:
    """Return what the sonar at the origin detects of one ping."""
    x, y = (START + PING_INTERVAL * number * VELOCITY)[generator.random(2) < DETECTION].T
    n_false, noise = generator.poisson(FALSE_CONTACTS), generator.standard_normal((2, len(x)))
    false_range = MAXIMUM_RANGE * np.sqrt(generator.random(n_false))
    false_azimuth = generator.uniform(-np.pi, np.pi, n_false)
    power = np.append(np.full(len(x), TARGET_POWER), np.ones(n_false))
    return Contacts(
        stamp=nanoseconds(PING_INTERVAL * number),
        range=np.append(np.hypot(x, y) + RANGE_DEVIATION * noise[0], false_range),
        azimuth=np.append(np.arctan2(y, x) + AZIMUTH_DEVIATION * noise[1], false_azimuth),
        amplitude=THRESHOLD + power * generator.exponential(size=len(power)),
        range_standard_deviation=RANGE_DEVIATION,
        azimuth_standard_deviation=AZIMUTH_DEVIATION,
        detection_probability=DETECTION,
        detection_threshold=THRESHOLD,
        signal_to_noise_ratio_linear=TARGET_POWER - 1.0,
        clutter_density=FALSE_CONTACTS / (np.pi * MAXIMUM_RANGE**2),
        maximum_range=MAXIMUM_RANGE,
    )


def main() -> None:
    """Track ping after ping, and print the confirmed tracks of some of them."""
    generator = np.random.default_rng(1)
    tracker = make_contact_tracker(ContactTrackerConfiguration())
    print("ping  contacts  track  x (m)  y (m)  course (deg)  speed (m/s)  existence")
    for number in range(SHOWN[-1] + 1):
        contacts = ping(number, generator)
        tracks = tracker.update(contacts).tracks
        for row in np.flatnonzero(tracks.established) if number in SHOWN else ():
            x, y, *velocity = tracks.state[row]
            course, speed = compass_from_vector(velocity), np.hypot(*velocity)
            start = f"{number:4d}  {len(contacts.range):8d}  {tracks.id[row]:5d}"
            motion = f"{x:5.0f}  {y:5.0f}  {course:12.0f}  {speed:11.1f}"
            print(f"{start}  {motion}  {tracks.existence_probability[row]:9.4f}")


if __name__ == "__main__":
    main()
