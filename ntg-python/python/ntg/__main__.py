"""The command `ntg`: `python -m ntg solve flight.ntg`."""

from __future__ import annotations

import sys

from ._ntg import command


def main() -> int:
    """Runs the command with the words of the command line; gives its exit status."""
    return command(["ntg", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
