"""The papers that a result names are those of its method, its potential and its effects."""

import re

import pytest

import tribo
from tribo.integrators.methods import METHODS
from tribo.model.effects import Effect
from tribo.results.citations import ALWAYS, OF_EFFECTS, citations


def scene(potential):
    """Two asperites, the upper one with a reservoir."""
    upper = tribo.Surface("upper", bob=(-1, 1), langevin=tribo.Langevin(0.1))
    return tribo.Scene([upper, tribo.Surface("lower", facing="up")], potential, duration=0.1)


def test_papers_of_a_scene():
    """As text: one line for each."""
    text = citations(scene(tribo.Morse(1.0, 1.0, 1.0)), "verlet", "text")
    for part in ("J. D. Brown", "Verlet", "P. M. Morse, Phys. Rev. 34 (1929) 57", "Ermak"):
        assert part in text
    assert len(text.splitlines()) == len(ALWAYS) + 3


def test_bibtex_has_the_same_numbers():
    """Volume, page and year of every paper that the text names."""
    for name in METHODS:
        text, bibtex = (citations(scene(tribo.Coulomb(1.0)), name, s) for s in ("text", "bibtex"))
        assert bibtex.count("{") == bibtex.count("}")
        keys = re.findall(r"^@\w+\{(.*),$", bibtex, re.MULTILINE)
        assert len(keys) == len(set(keys)) and not any(" " in key for key in keys)
        numbers = re.findall(r" (\d+) \((\d{4})\) (\d+)\b", text)
        assert numbers, name
        assert all(f"{{{number}}}" in bibtex for paper in numbers for number in paper)


def test_effects_exist():
    """Each effect of the table is one, and all methods name a source."""
    assert OF_EFFECTS.keys() <= {str(effect) for effect in Effect}
    assert all(method.source for method in METHODS.values())


def test_another_style_is_refused():
    """By a sentence that names those there are."""
    with pytest.raises(tribo.InputError, match=r"style: .*text.*bibtex"):
        citations(scene(tribo.Coulomb(1.0)), "verlet", "word")
