#!/usr/bin/env python3
"""The orchestration: starts every node, waits, watches, shows the tracks, stops all.

The same as ``sonar-tracking run``; try ``--help``.
"""

import sys

from sonar_tracking.cli import main

if __name__ == "__main__":
    sys.argv.insert(1, "run")
    sys.exit(main())
