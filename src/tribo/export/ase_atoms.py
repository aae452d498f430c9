"""A run as a list of ASE's Atoms, for its tools and for programs that read its formats.

A. H. Larsen et al., J. Phys.: Condens. Matter 29 (2017) 273002.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np
from ase import Atoms
from ase.calculators.singlepoint import SinglePointCalculator
from ase.data import atomic_numbers

from tribo.analysis.contact_probe import ContactProbe
from tribo.model.surface import Surface
from tribo.results.run_result import RunResult, of_all
from tribo.validation import must_be, one_of

# The element of bars, and of bobs whose species is no element: ASE's placeholder.
PLACEHOLDER = "X"
# The points of an asperite, each of which is an atom, and its mass.
POINTS = {"bob": "m1", "bar": "m2"}


def to_ase(result: RunResult, symbols: Mapping[str, str] | None = None) -> list[Atoms]:
    """The Atoms of each sample; see :meth:`tribo.Result.to_ase`."""
    surfaces = result.scene.surfaces
    elements = _elements(surfaces, dict(symbols or {}))
    motions = [_motion(result, point) for point in POINTS]
    positions, velocities = np.split(np.concatenate(motions, axis=1), 2, axis=2)
    forces, charges = _contact_forces(result, motions[0][:, :, :2])
    values = [s.each for s in surfaces]
    tags = np.concatenate([np.full(s.count, k) for k, s in enumerate(surfaces)])
    masses = np.concatenate([value[mass] for mass in POINTS.values() for value in values])
    angles = {name: of_all(result, name) for name in ("theta", "phi")}
    cell = (result.scene.periodic.x or 0.0, 0.0, result.scene.periodic.z or 0.0)
    images = []
    for k, t in enumerate(result.t):
        atoms = Atoms(
            elements,
            positions=positions[k],
            velocities=velocities[k],
            masses=masses,
            charges=np.concatenate([charges, np.zeros(len(tags))]),
            tags=np.tile(tags, 2),
            cell=cell,
            pbc=np.array(cell) > 0.0,
            info={"time": float(t)} | {name: float(v[k]) for name, v in result.system.items()},
        )
        atoms.set_array("is_bar", np.repeat([False, True], len(tags)))
        for name, value in angles.items():
            atoms.set_array(name, np.tile(value[k], 2))
        energy = float(result.system["contact_energy"][k])
        atoms.calc = SinglePointCalculator(atoms, energy=energy, forces=forces[k])
        images.append(atoms)
    return images


def _elements(surfaces: tuple[Surface, ...], symbols: dict[str, str]) -> list[str]:
    """The elements of all bobs, and the placeholder of all bars."""
    for name, symbol in symbols.items():
        one_of("symbols", name, [surface.name for surface in surfaces])
        if symbol not in atomic_numbers:
            raise must_be(f"symbols[{name!r}]", "the symbol of an element", symbol)
    bobs = [
        symbols.get(surface.name, str(species))
        for surface in surfaces
        for species in surface.species_of_each
    ]
    known = [bob if bob in atomic_numbers else PLACEHOLDER for bob in bobs]
    return [*known, *[PLACEHOLDER] * len(bobs)]


def _motion(result: RunResult, point: str) -> np.ndarray:
    """(times, n, 6) positions and velocities of a point of each asperite.

    A point of a pendulum turns about its centre of mass: v = v_cm + omega x (r - r_cm).
    """
    all_of = partial(of_all, result)
    x = all_of(f"x_{point}")
    y = all_of(f"y_{point}")
    omega = all_of("omega")
    z = np.concatenate([surface.resting_bobs()[:, 2] for surface in result.scene.surfaces])
    vx = all_of("vx_cm") - omega * (y - all_of("y_cm"))
    vy = all_of("vy_cm") + omega * (x - all_of("x_cm"))
    zero = np.zeros_like(x)
    return np.stack([x, y, zero + z, vx, vy, zero], axis=2)


def _contact_forces(result: RunResult, bobs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(times, 2 n, 3) contact forces on bobs, and zero on bars; charges of the bobs (n,)."""
    forces = np.zeros((len(bobs), 2 * bobs.shape[1], 3))
    probe = ContactProbe(result.scene)
    if result.scene.interactions:
        _, forces[:, : bobs.shape[1], :2] = probe(probe.positions(bobs))
    return forces, np.array(probe.charges)
