"""Passive and active sonar tracking as a ROS 2 node graph.

Conventions, stated once for the whole package:

- SI units and radians inside; names that end in ``_deg`` are for people.
- Arrival angle: from array broadside, radians, positive towards increasing element x.
- Azimuth: radians anticlockwise from +x (east) of the frame ``map`` (ENU).
- Compass bearing or course: degrees clockwise from north, only where a person reads or types.
- Stamps are integer nanoseconds since the epoch of the data; intervals are float seconds.
"""

__version__ = "0.1.0"
