"""Print the lowest versions that pyproject.toml allows, as constraints for pip.

    python .ci/lowest.py EXTRAS

EXTRAS are separated by commas.
"""

import re
import sys
import tomllib
from pathlib import Path

SETTINGS = Path(__file__).parents[1] / "pyproject.toml"
PROJECT = tomllib.loads(SETTINGS.read_text(encoding="utf-8"))["project"]


def lowest(requirements: list[str]) -> list[str]:
    """The lower bounds of requirements, exact."""
    found = [re.match(r"([\w.-]+)(?:\[.*\])?>=([\w.]+)", line) for line in requirements]
    return [f"{match[1]}=={match[2]}" for match in found if match]


extras = [name for name in sys.argv[1].split(",") if name]
optional = PROJECT["optional-dependencies"]
print(*lowest(PROJECT["dependencies"] + [r for name in extras for r in optional[name]]), sep="\n")
