"""Interactions of a scene as pair styles of LAMMPS.

Potentials for which LAMMPS has a style of the same form take that; others are written as formulas,
which LAMMPS differentiates.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from tribo.export.lepton import energy_text
from tribo.model.interaction import Interaction
from tribo.model.scene import Scene
from tribo.plugins.classes import parts
from tribo.plugins.sources import is_own
from tribo.potentials.charges import Coulomb
from tribo.potentials.cutoff import Shifted, Truncated
from tribo.potentials.derivative import NoFormulaError
from tribo.potentials.exponentials import BornMayer, Buckingham, Morse
from tribo.potentials.inverse_powers import LennardJones, Mie, WeeksChandlerAndersen
from tribo.potentials.potential import Potential
from tribo.potentials.soft_cores import Gaussian

# The style with the same form, and its coefficients but for the cutoff.
STYLES: dict[type, tuple[str, Callable[[Any], tuple[float, ...]]]] = {
    LennardJones: ("lj/cut", lambda p: (p.epsilon, p.sigma)),
    WeeksChandlerAndersen: ("lj/cut", lambda p: (p.epsilon, p.sigma)),
    Mie: ("mie/cut", lambda p: (p.epsilon, p.sigma, p.n, p.m)),
    Morse: ("morse", lambda p: (p.D, p.alpha, p.r0)),
    Buckingham: ("buck", lambda p: (p.A, p.rho, p.C)),
    BornMayer: ("buck", lambda p: (p.A, p.rho, 0.0)),
    Gaussian: ("gauss", lambda p: (-p.height, 0.5 / p.width**2)),
}


class Kind(NamedTuple):
    """What the atoms of one type have in common."""

    surface: int
    species: str
    mass: float


class Pair(NamedTuple):
    """A potential as LAMMPS has it."""

    style: str
    coefficients: str  # but for the cutoff
    cutoff: float  # distance from which it is zero [length]
    shifted: bool = False  # a constant makes the energy zero at the cutoff


def pair_lines(scene: Scene, kinds: Sequence[Kind], farthest: float) -> tuple[list[str], list[str]]:
    """The commands of all interactions, and what is omitted.

    `farthest` is a distance of no pair, the cutoff of potentials without one [length].
    """
    strength = _strength([interaction.potential for interaction in scene.interactions])
    pairs: dict[tuple[int, int], Pair] = {}
    omitted = []
    for index, interaction in enumerate(scene.interactions):
        try:
            pair = _pair(interaction, farthest, strength)
        except NoFormulaError:
            name = type(interaction.potential).__name__
            omitted.append(f"interaction[{index}]: {name} is no formula of the distance")
            continue
        pairs |= dict.fromkeys(_types(scene, interaction, kinds), pair)
    return _commands(pairs, len(kinds), strength), omitted


def _strength(potentials: Sequence[Any]) -> float:
    """The strength of Coulomb that ``dielectric`` stands for; 0 where that would change others.

    It scales the charges of all pair styles, so that it must be that of every charged potential.
    """
    strengths = set()
    for potential in potentials:
        inner = potential.potential if type(potential) is Truncated else potential
        if type(inner) is Coulomb:
            strengths.add(inner.strength)
        elif any(_may_couple(type(part)) for part in parts(potential)):
            return 0.0
    return strengths.pop() if len(strengths) == 1 else 0.0


def _may_couple(kind: Any) -> bool:
    """Whether the charges of bobs may scale potentials of a class."""
    return kind.coupling is not Potential.coupling or not is_own(kind)


def _pair(interaction: Interaction, farthest: float, strength: float) -> Pair:
    """A potential as LAMMPS has it; `strength` is that which ``dielectric`` stands for."""
    potential = interaction.potential
    if interaction.calculator is not None:
        raise NoFormulaError
    cutoff = min(potential.range(), farthest)
    cut = type(potential) in (Truncated, Shifted)
    inner = potential.potential if cut else potential
    if type(inner) in STYLES and not (cut and type(inner) is WeeksChandlerAndersen):
        style, coefficients = STYLES[type(inner)]
        numbers = " ".join(repr(float(value)) for value in coefficients(inner))
        return Pair(style, numbers, cutoff, type(potential) in (Shifted, WeeksChandlerAndersen))
    plain = type(inner) is Coulomb and type(potential) is not Shifted
    if plain and inner.strength == strength != 0.0:
        return Pair("coul/cut", "", cutoff)
    text = energy_text(potential)
    return Pair("lepton/coul" if "qi" in text or "qj" in text else "lepton", f'"{text}"', cutoff)


def _types(scene: Scene, interaction: Interaction, kinds: Sequence[Kind]) -> list[tuple[int, int]]:
    """The pairs of types between which an interaction acts, the lower one first."""
    pairs = {frozenset(pair) for pair in scene.pairs(interaction)}
    wanted = None if interaction.species is None else set(interaction.species)
    found = []
    for j, two in enumerate(kinds, 1):
        for i, one in enumerate(kinds[:j], 1):
            acts = frozenset((one.surface, two.surface)) in pairs
            if acts and wanted in (None, {one.species, two.species}):
                found.append((i, j))
    return found


def _commands(pairs: dict[tuple[int, int], Pair], count: int, strength: float) -> list[str]:
    """The commands for pairs of types; those without an interaction get none."""
    if not pairs:
        return ["pair_style zero 1.0", "pair_coeff * *"]
    variants = sorted({(pair.style, pair.shifted) for pair in pairs.values()})
    names = {}
    styles = ""
    for style, shifted in variants:
        both = [v for v in variants if v[0] == style]
        number = f" {both.index((style, shifted)) + 1}" if len(both) == 2 else ""
        names[style, shifted] = style + number
        own = (p.cutoff for p in pairs.values() if (p.style, p.shifted) == (style, shifted))
        styles += f" {style} {max(own)!r}"
    lines = [f"pair_style hybrid{styles}"]
    if any(pair.style == "coul/cut" for pair in pairs.values()):
        comment = "  # the strength of Coulomb is 1 / dielectric"
        lines.insert(0, f"dielectric {1.0 / strength!r}{comment}")
    for j in range(1, count + 1):
        for i in range(1, j + 1):
            words = ["none"]
            if (pair := pairs.get((i, j))) is not None:
                words = [names[pair.style, pair.shifted], pair.coefficients, repr(pair.cutoff)]
            lines.append(" ".join(filter(None, [f"pair_coeff {i} {j}", *words])))
    lines += [f"pair_modify pair {names[v]} shift yes" for v in variants if v[1]]
    return lines
