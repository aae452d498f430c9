"""A scene as files of LAMMPS: rigid asperites are atoms, surfaces groups that fixes move.

A. P. Thompson et al., Comput. Phys. Commun. 271 (2022) 108171.
"""

import math
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tribo.export import lammps_motion as motion
from tribo.export.lammps_atoms import CONSTANT_FORCES, Atoms, atoms_of, data_file
from tribo.export.lammps_pairs import pair_lines
from tribo.files import replace_file
from tribo.integrators.step_control import count_of_steps
from tribo.kernels.kinematics import nearest_image
from tribo.layout.contacts import SKIN
from tribo.layout.layout import lay_out
from tribo.loops.resolution import corrugation_frequency, spring_frequency
from tribo.model.scene import Scene
from tribo.plugins.classes import parts
from tribo.validation import InputError, as_path, must_be

# Names of the files: atoms, the commands for their forces, and those for a run, which read both.
DATA = "scene.data"
FORCES = "forces.in"
RUN = "run.in"
# Step that is written, where the scene has none, as a fraction of the shortest time of a motion.
STEP = 0.02
# Largest number of surfaces: LAMMPS has 32 groups, one of which holds all atoms.
MOST_SURFACES = 31


class LammpsFiles(NamedTuple):
    """The files of a scene for LAMMPS.

    Attributes
    ----------
    data, forces, run : Path
        Atoms; interactions; and the input file that includes both and runs.
    omitted : tuple of str
        Effects of the scene that LAMMPS cannot simulate, one sentence each.
    """

    data: Path
    forces: Path
    run: Path
    omitted: tuple[str, ...]


def to_lammps(scene: Scene, directory: str | os.PathLike[str]) -> LammpsFiles:
    """Write a scene as a data file and input files of LAMMPS, in its units "lj".

    Parameters
    ----------
    scene : Scene
    directory : path
        A folder, made if it does not exist; files of the same names are replaced.

    Raises
    ------
    InputError
        If the folder cannot be written, or there are too many surfaces or different masses,
        or bars are one rigid body.
    """
    for surface in scene.surfaces:
        if surface.drive.block:
            problem = "must be false in files of LAMMPS, which would move the bars one by one"
            raise InputError(f"{surface.name}.drive.block", problem)
        if surface.elastic is not None:
            raise InputError(f"{surface.name}.elastic", "cannot be written to files of LAMMPS")
    if (count := len(scene.surfaces)) > MOST_SURFACES:
        raise must_be("surface", f"at most {MOST_SURFACES} for LAMMPS's groups", count)
    atoms = atoms_of(scene)
    # A distance that no pair reaches as long as surfaces keep their velocities.
    extent = float(np.linalg.norm(np.ptp(atoms.positions, axis=0)))
    farthest = 2.0 * (extent + atoms.largest_speed * scene.duration) + 1.0
    cutoffs = (min(each.potential.range(), farthest) for each in scene.interactions)
    reach = max(cutoffs, default=0.0)
    pairs, omitted = pair_lines(scene, atoms.kinds, farthest)
    omitted += motion.omitted_fields(scene)
    for surface in scene.surfaces:
        effects = motion.omitted_effects(scene, surface)
        omitted += [f'surface "{surface.name}": {effect}' for effect in effects]
    folder = as_path(directory)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise must_be("directory", f"a folder ({error.strerror})", str(folder)) from None
    files = LammpsFiles(folder / DATA, folder / FORCES, folder / RUN, tuple(omitted))
    replace_file(files.data, data_file(scene, atoms, max(reach, 1.0)).encode())
    forces = _forces(scene, atoms, pairs, reach)
    run = _run(scene, atoms, files.omitted)
    for path, lines in ((files.forces, forces), (files.run, run)):
        replace_file(path, ("\n".join(lines) + "\n").encode())
    return files


def _forces(scene: Scene, atoms: Atoms, pairs: list[str], reach: float) -> list[str]:
    """The commands that read the atoms and set the forces between them."""
    along_x, along_z = ("m" if p is None else "p" for p in (scene.periodic.x, scene.periodic.z))
    lines = ["# Units of the scene; k_B = 1", "units lj", "atom_style full"]
    lines.append(f"boundary {along_x} m {along_z}")
    skin = SKIN * reach
    read = f"read_data {DATA}"
    if np.any(atoms.constant_forces):
        lines.append("fix constant all property/atom d_constant_x d_constant_y")
        read += f" fix constant NULL {CONSTANT_FORCES}"
    if len(atoms.bonds):
        lines += ["bond_style harmonic", "special_bonds lj/coul 1 1 1"]
        stretched = 1.5 * _longest(scene, atoms)  # as far as bonds may stretch
        lines.append(f"comm_modify cutoff {max(reach + skin, stretched)!r}")
    lines += [f"neighbor {skin!r} bin", "neigh_modify every 1 delay 0 check yes", read]
    if len(atoms.bonds):
        stiffness = dict.fromkeys(atoms.stiffness.tolist())
        lines += [f"bond_coeff {i} {0.5 * k!r} 0" for i, k in enumerate(stiffness, 1)]
    lines += pairs
    for index, group in enumerate(motion.group_names(scene)):
        lines.append(f"group {group} type {' '.join(map(str, atoms.types_of(index)))}")
    return lines


def _longest(scene: Scene, atoms: Atoms) -> float:
    """Length of the longest spring at the start [length]."""
    ends = atoms.positions[atoms.bonds]
    distance = ends[:, 0] - ends[:, 1]
    for axis, period in ((0, scene.periodic.x), (2, scene.periodic.z)):
        distance[:, axis] = nearest_image(distance[:, axis], period or 0.0)
    return float(np.max(np.linalg.norm(distance, axis=1)))


def _run(scene: Scene, atoms: Atoms, omitted: tuple[str, ...]) -> list[str]:
    """The commands that run the scene and write what is found."""
    lines = [f"# Omitted: {text}" for text in omitted]
    lines += [f"include {FORCES}", *motion.motion_lines(scene, atoms), "# Output"]
    series = "step time pe ke"
    for surface, group in zip(scene.surfaces, motion.group_names(scene), strict=True):
        if motion.moves_uniformly(scene, surface):
            lines.append(f"variable {group}_force_x equal fcm({group},x)")
            series += f" v_{group}_force_x"
    interval = scene.duration / (len(scene.times) - 1)
    # Steps divide the time between samples, as in runs, so that frames are at their times.
    every = int(count_of_steps(interval, scene.numerics.step or _step(scene, atoms)))
    return [
        *lines,
        f"thermo_style custom {series}",
        f"thermo {every}",
        f"dump atoms all custom {every} atoms.dump id type x y z vx vy fx fy",
        "dump_modify atoms sort id format float %.15g",
        "# Run",
        f"timestep {interval / every!r}",
        f"run {every * (len(scene.times) - 1)}",
    ]


def _step(scene: Scene, atoms: Atoms) -> float:
    """A step [time] that resolves passes, and oscillations in contact, in fields and on springs."""
    lightest = min(kind.mass for kind in atoms.kinds)
    speed = atoms.largest_speed
    times = [scene.duration / 50.0]
    layout = lay_out(scene)
    for frequency in (spring_frequency(layout), corrugation_frequency(layout)):
        if frequency > 0.0:
            times.append(2.0 * math.pi / frequency)
    for interaction in scene.interactions:
        length = interaction.potential.feature()[0]
        if length > 0.0 and speed > 0.0:
            times.append(length / speed)
        for part in parts(interaction.potential):
            curvature = part.minimum()[2] if hasattr(part, "minimum") else 0.0
            if curvature > 0.0:
                times.append(2.0 * math.pi * math.sqrt(lightest / curvature))
    return STEP * min(times)
