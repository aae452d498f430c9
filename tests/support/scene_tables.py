"""Scenes from the tables of scene files, read as files are."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

import tribo


def scene_from(table: dict[str, Any], folder: Path | None = None) -> tribo.Scene:
    """The scene that a table describes; `folder` is that of its plug-ins."""
    text = tomli_w.dumps(_plain(table))
    if folder is not None:
        return _loaded(text, folder)
    with tempfile.TemporaryDirectory() as own:
        return _loaded(text, Path(own))


def _loaded(text: str, folder: Path) -> tribo.Scene:
    path = folder / "scene of a table.toml"
    path.write_text(text, encoding="utf-8")
    return tribo.load_scene(path)


def _plain(value: Any) -> Any:
    """The same without arrays and numbers of numpy, which TOML does not know."""
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
