"""Active sonar: detection thresholds, and tracks of several targets from contacts in clutter.

Positions are metres in the frame ``map`` (x east, y north), azimuths radians anticlockwise from
+x, amplitudes linear powers with noise mean 1. Decibels appear only in names that end in ``_db``.
"""
