"""The command `tribo` in this process: the function that pyproject.toml declares for it."""

import tomllib
from importlib import import_module
from pathlib import Path
from typing import Any

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def _declared() -> Any:
    """What an installed command `tribo` calls."""
    project = tomllib.loads(PROJECT.read_text("utf-8"))["project"]
    module, name = project["scripts"]["tribo"].split(":")
    return getattr(import_module(module), name)


main = _declared()
