"""The `tribo` command."""

import signal
import sys

from tribo import _tribo


def main() -> int:
    """Runs the `tribo` command with the arguments of this process and gives its exit code."""
    # The command knows what to do with Ctrl-C; Python's handler would keep it waiting.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _tribo.command(["tribo", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
