"""`python -m tribo`: the same as the command `tribo`."""

import sys

from tribo.commands.cli import main

if __name__ == "__main__":
    sys.exit(main())
