"""Print what the package requires, for pip: its dependencies and those of extras.

    python .ci/requirements.py EXTRAS

EXTRAS are separated by commas.  An extra that names another extra of the package is replaced by
what that one requires.
"""

import re
import sys
import tomllib
from pathlib import Path

SETTINGS = Path(__file__).parents[1] / "pyproject.toml"
PROJECT = tomllib.loads(SETTINGS.read_text(encoding="utf-8"))["project"]


def requirements(extras: str) -> list[str]:
    """The dependencies of the package and of its extras, which are separated by commas."""
    found = list(PROJECT["dependencies"])
    for name in extras.split(","):
        if name:
            found += _of_extra(name)
    return found


def _of_extra(name: str) -> list[str]:
    found = []
    for line in PROJECT["optional-dependencies"][name]:
        other = re.fullmatch(r"tribo\[([\w-]+)\]", line)
        found += _of_extra(other[1]) if other else [line]
    return found


if __name__ == "__main__":
    print(*requirements(sys.argv[1]), sep="\n")
