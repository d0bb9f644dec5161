"""Target motion analysis: bearings and frequency lines become positions and velocities.

Azimuths are radians anticlockwise from +x (east) of the frame ``map``. The kinematic state is
``[x, y, vx, vy]``, absolute in ``map``; behind it stands one source frequency a line. Leading
dimensions ``...`` are a batch of independent runs; a node has none.
"""
