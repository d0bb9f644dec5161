"""The program ``sonar-tracking``: Ctrl-C is in order from here on, before anything is imported."""

import sys

from sonar_tracking.stop_signals import end_at_once, never_end


def main() -> int:
    """Run the command; return the exit code."""
    end_at_once()
    from sonar_tracking.cli import main as run_command_line

    try:
        return run_command_line()
    finally:
        never_end()


if __name__ == "__main__":
    sys.exit(main())
