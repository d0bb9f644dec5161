#!/usr/bin/env python3
"""The orchestration: starts every node, waits, watches, shows the tracks, stops all.

The same as ``sonar-tracking run``; try ``--help``.
"""

import sys

try:
    from sonar_tracking.__main__ import main
except ImportError as error:
    if error.name != "sonar_tracking":
        raise
    sys.exit(f"{error}: start ./scripts/run.sh instead, which makes what is needed.")

if __name__ == "__main__":
    sys.argv.insert(1, "run")
    sys.exit(main())
