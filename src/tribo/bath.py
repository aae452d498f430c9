"""stand-in"""
from __future__ import annotations
from dataclasses import dataclass
from typing import Any
import numpy as np
from tribo.checks import NOT_NEGATIVE, POSITIVE, inside, known_keys, number

@dataclass(frozen=True, eq=False)
class Bath:
    masses: np.ndarray
    frequencies: np.ndarray
    inertias: np.ndarray
    torsional_frequencies: np.ndarray
    temperature: float = 0.0
    spectrum: Any = None
    def __bool__(self): return self.masses.size + self.inertias.size > 0

def as_bath(value):
    if isinstance(value, Bath): return value
    value = value or {}
    o = value.get("oscillators", []); t = value.get("torsional", [])
    return Bath(np.array([i["mass"] for i in o], float), np.array([i["frequency"] for i in o], float), np.array([i["inertia"] for i in t], float), np.array([i["frequency"] for i in t], float), value.get("temperature", 0.0))

def as_table(bath): return {"oscillators": [{"mass": float(m), "frequency": float(f)} for m, f in zip(bath.masses, bath.frequencies)]}

def thermal_start(bath, rng, count):
    z = np.zeros((count, bath.masses.size)); return z, z.copy(), z.copy(), z.copy()

def thermal_torsional_start(bath, rng, count):
    z = np.zeros((count, bath.inertias.size)); return z, z.copy()
