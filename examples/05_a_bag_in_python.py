"""Read a bag in Python, without ROS: what is in it, and its contacts tracked once more.

Takes the path of a bag (a rosbag2 directory, .mcap or .db3). Without one it first makes a small bag
of its own, from a table of the contacts of a ship that passes at 5 m/s.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

from sonar_tracking.active import ContactTrackerConfiguration, make_contact_tracker
from sonar_tracking.bags import ContactSensor, import_contacts, read_bag, records_of


def small_bag(folder: Path) -> Path:
    """Write a table of contacts and bring it into a bag."""
    generator, lines = np.random.default_rng(1), ["time_s,range_m,azimuth_deg,amplitude"]
    for time in np.arange(0.0, 300.0, 10.0):
        places = [(2000.0, -750.0 + 5.0 * time), *generator.uniform(-3000.0, 3000.0, (20, 2))]
        for number, (x, y) in enumerate(places):
            amplitude = 6.0 + (20.0 if number == 0 else 1.0) * generator.exponential()
            azimuth_deg = np.degrees(np.arctan2(y, x)) + generator.normal(0.0, 0.5)
            distance = np.hypot(x, y) + generator.normal(0.0, 15.0)
            lines.append(f"{time},{distance:.1f},{azimuth_deg:.2f},{amplitude:.2f}")
    table, bag = folder / "contacts.csv", folder / "bag"
    table.write_text("\n".join(lines))
    print(
        import_contacts(table, bag, ContactSensor(range_deviation=15.0, bearing_deviation_deg=0.5))
    )
    return bag


def show(path: Path) -> None:
    """Print the topics of a bag, and track its contacts."""
    bag = read_bag(path)
    print(bag.recovery or "The bag is whole.")
    for topic in bag.topics.values():
        print(f"{topic.name:24} {topic.message_count:6d} {topic.role:7} {topic.type_name}")
    tracker = make_contact_tracker(ContactTrackerConfiguration())
    for contacts in records_of(bag, "/active/contacts"):
        tracks = tracker.update(contacts).tracks
    for row in np.flatnonzero(tracks.established):
        x, y, *velocity = tracks.state[row]
        speed = np.hypot(*velocity)
        print(f"track {tracks.id[row]}: {x:.0f} m east, {y:.0f} m north, {speed:.1f} m/s")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        show(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as directory:
            show(small_bag(Path(directory)))
