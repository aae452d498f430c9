"""What holds and moves the surfaces of a scene, as fixes of LAMMPS."""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from tribo.export.lammps_atoms import Atoms
from tribo.model.drive import Stage
from tribo.model.fields import Corrugation
from tribo.model.number import changes, constant
from tribo.model.scene import Scene
from tribo.model.schedule import Schedule
from tribo.model.surface import Surface


def group_names(scene: Scene) -> list[str]:
    """The group of each surface: its name, if LAMMPS takes those of all surfaces."""
    names = [surface.name for surface in scene.surfaces]
    if all(name.isascii() and name.isidentifier() and name != "all" for name in names):
        return names
    return [f"surface{k}" for k in range(1, len(names) + 1)]


def motion_lines(scene: Scene, atoms: Atoms) -> Iterator[str]:
    """Lines that move each surface: forces that its drive cancels, adds or shares, and noise."""
    if scene.fields:
        yield "compute unwrapped all property/atom xu"
    for index, (surface, group) in enumerate(zip(scene.surfaces, group_names(scene), strict=True)):
        yield f'# Surface "{surface.name}"'
        if moves_uniformly(scene, surface):
            vx, vy = surface.velocity
            yield f"fix {group}_motion {group} move linear {vx!r} {vy!r} 0"
            continue
        yield f"fix {group}_motion {group} nve"
        if axes := _cancelled_axes(surface):
            zeros = " ".join("0" if axis in axes else "NULL" for axis in "xy")
            yield f"fix {group}_cancelled {group} setforce {zeros} NULL"
        if surface.drive.moves_as_one:
            yield f"fix {group}_shared {group} aveforce 0 NULL NULL"
        yield from _drive(surface, group)
        mine = np.isin(atoms.kind_of_each + 1, atoms.types_of(index))
        if np.any(atoms.constant_forces[mine]):  # of springs and stages
            yield from _added(group, "constant", "atom", ["d_constant_x", "d_constant_y"])
        yield from _reservoir(surface, group, atoms, index, scene.seed)
        yield from _fields(scene, surface, group)
        yield f"fix {group}_plane {group} setforce NULL NULL 0"


def moves_uniformly(scene: Scene, surface: Surface) -> bool:
    """Whether nothing changes the velocity of the surface's atoms."""
    return not (scene.slides_along_x(surface) or scene.slides_along_y(surface))


def omitted_effects(scene: Scene, surface: Surface) -> Iterator[str]:
    """Effects of a surface that the files leave out, each as the end of a sentence."""
    drive = surface.drive
    name = f'drive = "{drive.kind}"' if drive.kind else "the user's own drive"
    present = {
        "pendulums: bobs are fixed to their bars": not surface.asperite.is_rigid,
        "bars that turn": surface.bars == "free",
        "the user's own forces on the ends of bars": surface.plugin_at_ends is not None,
        name: not drive.has_fixes,
        "the unequal masses of a rigid body, whose forces are shared equally": (
            drive.moves_as_one and bool(np.ptp(surface.each["mass"]) > 0.0)
        ),
        "the springs of a rigid body, whose forces on single bars are shared too": (
            drive.moves_as_one and bool(surface.springs)
        ),
        "contact within a rigid body, whose forces on single bars are shared too": (
            drive.moves_as_one and scene.has_contact_within(surface)
        ),
        "oscillators of the bath": surface.bath.masses.size > 0 or surface.bath.inertias.size > 0,
        "the reservoir on the swing": surface.reservoir("swing") is not None,
        "reservoirs that differ between asperites": not all(
            each.is_uniform for each in surface.reservoirs
        ),
        "the temperature of the start": bool(surface.initial.temperature),
        "springs with turned rest vectors": bool(surface.springs and surface.springs.turned),
    }
    yield from (text for text, here in present.items() if here)
    axes = " and ".join(_cancelled_axes(surface))
    if axes and not moves_uniformly(scene, surface):
        if scene.has_contact_within(surface):
            yield f"contact within the surface along {axes}, cancelled with other contact"
        if surface.springs and not surface.springs.turned and "x" in axes:
            yield f"lattice springs along {axes}, cancelled with contact"


def omitted_fields(scene: Scene) -> list[str]:
    """The external fields that the files leave out."""
    return [
        f"field[{i}]: {type(item.potential).__name__}"
        for i, item in enumerate(scene.fields)
        if type(item.potential) not in FORCES
    ]


def _cancelled_axes(surface: Surface) -> list[str]:
    """The axes along which the drive cancels contact."""
    drive = surface.drive
    cancels = {"x": drive.cancels_x, "y": drive.cancels_y and drive.load is None}
    return [axis for axis, is_cancelled in cancels.items() if is_cancelled]


def _drive(surface: Surface, group: str) -> Iterator[str]:
    """The forces of the drive, beyond those that it cancels."""
    drive = surface.drive
    forces = ["0", "0"]
    if drive.stage is not None:
        stiffness, speed, _ = drive.stage
        if drive.stage.follows_schedule:
            forces[0] = f"{stiffness!r}*({_displacement(drive.stage)})"
        else:
            forces[0] = f"{stiffness * constant(speed)!r}*time"
        yield f"fix {group}_spring {group} spring/self {stiffness!r} x"
    if drive.ramp is not None:
        pairs = zip(drive.ramp.force, drive.ramp.rate, strict=True)
        forces = [
            _formula(force) if changes(force) else f"{force!r}+{rate!r}*time"
            for force, rate in pairs
        ]
    if changes(drive.load):
        forces[1] = _formula(drive.load.times(-surface.facing_sign))
    elif drive.load is not None:
        forces[1] = repr(-constant(drive.load) * surface.facing_sign)
    yield from _added(group, "drive", "equal", forces)


def _displacement(stage: Stage) -> str:
    """How far a stage is from its rest, as a formula."""
    if stage.position is not None:
        return _formula(stage.position)
    assert changes(stage.speed)
    return _formula(stage.speed, integral=True)


def _formula(schedule: Schedule, integral: bool = False) -> str:
    """The value of a schedule, or its integral from 0 on, as a formula of the time."""
    ends = [-math.inf, *(kink for kink in schedule.kinks if kink > 0.0), math.inf]
    terms = []
    for begin, end in itertools.pairwise(ends):
        inside = max(0.5 * (max(begin, 0.0) + end), 0.0) if end < math.inf else max(begin, 0.0)
        piece = schedule.integral_piece(inside) if integral else schedule.piece(inside)
        u = f"(time-({piece.since!r}))"
        term = f"({piece.c0!r})+({piece.c1!r})*{u}+({piece.c2!r})*{u}*{u}"
        if piece.amplitude != 0.0:
            turn = f"({piece.frequency!r})*{u}+({piece.phase!r})"
            term += f"+({piece.amplitude!r})*sin({turn})"
        begun = f"(time>={begin!r})*" if begin > 0.0 else ""
        ended = f"(time<{end!r})*" if end < math.inf else ""
        terms.append(f"{begun}{ended}({term})")
    return "+".join(terms)


def _added(group: str, name: str, style: str, forces: Sequence[str]) -> Iterator[str]:
    """Commands that add a force to each atom of a group, from formulas of x and y."""
    if any(force != "0" for force in forces):
        for axis, force in zip("xy", forces, strict=True):
            yield f'variable {group}_{name}_{axis} {style} "{force}"'
        yield f"fix {group}_{name} {group} addforce v_{group}_{name}_x v_{group}_{name}_y 0"


def _reservoir(surface: Surface, group: str, atoms: Atoms, index: int, seed: int) -> Iterator[str]:
    """Friction and noise at the bars; LAMMPS has the ratio of mass and friction."""
    reservoir = surface.reservoir("bar")
    if reservoir is None or not reservoir.is_uniform:
        return
    gamma = reservoir.strongest
    temperature = reservoir.warmest
    types = atoms.types_of(index)
    masses = [atoms.kinds[i - 1].mass for i in types]
    line = f"fix {group}_friction {group} viscous {gamma!r}"
    if temperature > 0.0:
        number = 1 + (1000 * seed + index) % 900_000_000  # LAMMPS's largest seed
        ends = f"{temperature!r} {temperature!r}"
        if changes(reservoir.temperature):
            yield f'variable {group}_temperature equal "{_formula(reservoir.temperature)}"'
            ends = f"v_{group}_temperature {temperature!r}"
        line = f"fix {group}_friction {group} langevin {ends} {masses[0] / gamma!r} {number}"
        for i, mass in zip(types[1:], masses[1:], strict=True):
            line += f" scale {i} {mass / masses[0]!r}"
    mean = surface.velocity if reservoir.velocity is None else reservoir.velocity
    yield line
    yield from _added(group, "wind", "equal", [repr(gamma * v) if v else "0" for v in mean])


def _fields(scene: Scene, surface: Surface, group: str) -> Iterator[str]:
    """The fields that act on a surface's bobs."""
    for number, item in enumerate(scene.fields):
        if surface.name in item.on and type(item.potential) in FORCES:
            x = f"c_unwrapped-({item.origin[0]!r})-({item.velocity[0]!r})*time"
            force = FORCES[type(item.potential)](item.potential, x)
            if item.modulation is not None:
                force = f"({_formula(item.modulation)})*({force})"
            yield from _added(group, f"field{number}", "atom", [force, "0"])


def _corrugation(potential: Any, x: str) -> str:
    q = 2.0 * math.pi / potential.period
    return f"{-potential.amplitude * q!r}*sin({q!r}*({x}))"


# The fields that LAMMPS can have, and their force along x as a formula of a text for x.
FORCES: dict[type, Callable[[Any, str], str]] = {Corrugation: _corrugation}
