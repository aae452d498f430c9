"""The files of coefficients."""

import json
from pathlib import Path

import numpy as np


def path_of(name: str) -> Path:
    """The file with the coefficients of a method."""
    return Path(__file__).parent / "coefficients" / f"{name}.json"


def stages(*rows: list[float]) -> np.ndarray:
    """A matrix of weights (stages, stages) from its rows, which end at their last weight."""
    a = np.zeros((len(rows), len(rows)))
    for i, row in enumerate(rows):
        a[i, : len(row)] = row
    return a


def read(name: str) -> dict[str, np.ndarray]:
    """The coefficients of a method by name; lists of lists are (stages, stages)."""
    table = json.loads(path_of(name).read_text(encoding="utf-8"))
    return {
        key: stages(*each) if isinstance(each[0], list) else np.array(each)
        for key, each in table.items()
    }
