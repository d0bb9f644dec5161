"""The program ``sonar-tracking``: Ctrl-C is in order from here on, before anything is imported."""

import sys

from sonar_tracking.stop_signals import end_command_at_once, never_end, stop_code


def main() -> int:
    """Run the command; return the exit code."""
    end_command_at_once()
    from sonar_tracking.cli import main as run_command_line

    try:
        code = run_command_line()
    except BaseException:
        # An interruption ends as one, whatever it has become on its way up.
        if not stop_code():
            raise
    finally:
        never_end()
    return stop_code() or code


if __name__ == "__main__":
    sys.exit(main())
