"""The asperites of a scene as atoms of LAMMPS: its data file.

An atom stands where a bob is at t = 0, and has the mass of its whole asperite.  A lattice spring is
a bond without a length: its force is linear in the distance of two atoms, as that of the spring is,
and differs from it by a constant, which is written beside the atoms.
"""

from dataclasses import dataclass

import numpy as np

from tribo.export.lammps_pairs import Kind
from tribo.kernels.kinematics import nearest_image, versine
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.validation import InputError

# Largest number of types of atoms: one for each mass, species and surface.
MOST_KINDS = 500
# The name of the constant forces in the data file.
CONSTANT_FORCES = "ConstantForces"


@dataclass(frozen=True)
class Atoms:
    """All n atoms, surface after surface, and the m bonds between them."""

    kinds: tuple[Kind, ...]  # those of a surface side by side
    kind_of_each: np.ndarray  # (n,)
    positions: np.ndarray  # (n, 3)
    velocities: np.ndarray
    charges: np.ndarray
    bonds: np.ndarray  # (m, 2) indices of atoms
    stiffness: np.ndarray  # (m,) [force / length]
    constant_forces: np.ndarray  # (n, 2) along x and y

    @property
    def largest_speed(self) -> float:
        """That of any atom [length / time]."""
        return float(np.max(np.linalg.norm(self.velocities, axis=1)))

    def types_of(self, surface: int) -> list[int]:
        """The numbers of a surface's types, from 1."""
        return [i for i, kind in enumerate(self.kinds, 1) if kind.surface == surface]


def atoms_of(scene: Scene) -> Atoms:
    """The asperites of a scene as atoms.  Raises InputError if too many have their own mass."""
    kinds: list[Kind] = []
    parts = []
    periodic = (scene.periodic.x is not None, scene.periodic.z is not None)
    for index, surface in enumerate(scene.surfaces):
        numbers, own = _kinds(surface, index, surface.each["mass"])
        bobs, bars = _start(scene, index)
        initial = surface.initial_of_each
        velocities = np.zeros((surface.count, 3))
        velocities[:, :2] = surface.velocity + np.column_stack([initial["vx"], initial["vy"]])
        ends, strengths = surface.springs.bonds(surface.shape, surface.count, periodic)
        if surface.springs.turned:  # no bond has their force
            ends = ends[:0]
            strengths = strengths[:0]
        constant = _constant_forces(scene, surface, bobs, bars, ends, strengths)
        of_atoms = len(kinds) + numbers, bobs, velocities, surface.each["charge"]
        parts.append((*of_atoms, scene.parts[surface.name].start + ends, strengths, constant))
        kinds += own
    if len(kinds) > MOST_KINDS:
        raise InputError(
            "surface.asperite",
            f"must have at most {MOST_KINDS} different masses m1 + m2 for LAMMPS, which has a type "
            f"of atoms for each, got {len(kinds)}",
        )
    return Atoms(tuple(kinds), *map(np.concatenate, zip(*parts, strict=True)))


def _kinds(surface: Surface, index: int, masses: np.ndarray) -> tuple[np.ndarray, list[Kind]]:
    """The kind of each asperite of a surface, and the kinds."""
    both = list(zip(surface.species_of_each.tolist(), masses.tolist(), strict=True))
    known = {pair: number for number, pair in enumerate(dict.fromkeys(both))}
    return np.array([known[pair] for pair in both]), [Kind(index, *pair) for pair in known]


def _start(scene: Scene, index: int) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) bobs at t = 0, and (n, 2) displacements of the bars from rest [length]."""
    surface = scene.surfaces[index]
    each = surface.each
    bobs = surface.resting_bobs(seed=[scene.seed, index, 0])
    initial = surface.initial_of_each
    swing = surface.initial_swing
    swing = initial["phi"] if swing is None else swing
    turn = surface.facing_sign * np.column_stack([np.sin(swing), versine(swing)])
    bars = np.column_stack([initial["x"], initial["y"]])
    if not surface.drive.holds_bars:
        bars -= each["l2"][:, None] * turn
    bobs[:, :2] += bars + (each["l1"] + each["l2"])[:, None] * turn
    return bobs, bars


def _constant_forces(
    scene: Scene,
    surface: Surface,
    bobs: np.ndarray,
    bars: np.ndarray,
    ends: np.ndarray,
    stiffness: np.ndarray,
) -> np.ndarray:
    """(n, 2) what springs exert beyond bonds without a length, and stages at the start."""
    forces = np.zeros((surface.count, 2))
    if surface.drive.stage is not None:
        forces[:, 0] -= surface.drive.stage.stiffness * bars[:, 0]
    i, j = ends.T
    distance = (bobs[i] - bobs[j])[:, :2]
    distance[:, 0] = nearest_image(distance[:, 0], scene.periodic.x or 0.0)
    rest = stiffness[:, None] * (distance - (bars[i] - bars[j]))
    np.add.at(forces, i, rest)
    np.subtract.at(forces, j, rest)
    cancelled = 1e-14 * np.max(np.abs(rest), initial=0.0)  # of springs on both sides
    return np.where(np.abs(forces) < cancelled, 0.0, forces)


def data_file(scene: Scene, atoms: Atoms, margin: float) -> str:
    """The text of the data file, in a box with a margin where it is not periodic [length]."""
    n = len(atoms.positions)
    strengths = list(dict.fromkeys(atoms.stiffness.tolist()))
    low = atoms.positions.min(axis=0) - margin
    high = atoms.positions.max(axis=0) + margin
    for axis, period in ((0, scene.periodic.x), (2, scene.periodic.z)):
        if period is not None:
            low[axis] = 0.0
            high[axis] = period
    lines = [scene.title.replace("\n", " ") or "asperites as atoms", ""]
    lines += [f"{n} atoms", f"{len(atoms.kinds)} atom types"]
    if strengths:
        lines += [f"{len(atoms.bonds)} bonds", f"{len(strengths)} bond types"]
    lines.append("")
    lines += [
        f"{one!r} {other!r} {axis}lo {axis}hi"
        for axis, one, other in zip("xyz", low.tolist(), high.tolist(), strict=True)
    ]
    lines += ["", "Masses", ""]
    lines += [f"{i} {kind.mass!r}" for i, kind in enumerate(atoms.kinds, 1)]
    surfaces = np.array([kind.surface for kind in atoms.kinds])[atoms.kind_of_each]
    lines += ["", "Atoms # full", ""]
    values = np.column_stack([atoms.charges, atoms.positions]).tolist()
    rows = zip(surfaces + 1, atoms.kind_of_each + 1, values, strict=True)
    lines += [f"{i} {one} {kind} {_words(row)}" for i, (one, kind, row) in enumerate(rows, 1)]
    lines += ["", "Velocities", "", *_numbered(atoms.velocities)]
    if strengths:
        lines += ["", "Bonds", ""]
        types = [strengths.index(value) + 1 for value in atoms.stiffness.tolist()]
        bonds = zip(types, (atoms.bonds + 1).tolist(), strict=True)
        lines += [f"{b} {kind} {i} {j}" for b, (kind, (i, j)) in enumerate(bonds, 1)]
    if np.any(atoms.constant_forces):
        lines += ["", CONSTANT_FORCES, "", *_numbered(atoms.constant_forces)]
    return "\n".join(lines) + "\n"


def _words(row: list[float]) -> str:
    return " ".join(map(repr, row))


def _numbered(rows: np.ndarray) -> list[str]:
    return [f"{i} {_words(row)}" for i, row in enumerate(rows.tolist(), 1)]
