"""The tables of the kernels: a row for each quantity, a column for each asperite."""

import numpy as np

from tribo.compiler.lanes import LANES
from tribo.compiler.lanes_memory import room
from tribo.kernels import records
from tribo.kernels.model import Box, Tables
from tribo.layout import contacts
from tribo.layout.scene_records import springs
from tribo.layout.slots import Numbering
from tribo.model.scene import Scene

# Fields of an asperite from which all other constants follow.
PARAMETERS = ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length", "pivot", "phi", "nu")
# Constants of those that fill up a pack, (rows, 1): these and their inverses are 1, others 0.
ONES = ("mass", "inertia", "i2", "bar_length", "cos_phi")
OF_FILLING = np.array(
    [[float(name.removeprefix("inverse_") in ONES)] for name in records.CONSTANTS]
)


def model_tables(
    scene: Scene,
    asperites: np.ndarray,
    depths: np.ndarray,
    numbering: Numbering,
    columns: np.ndarray,
    apart: bool,
) -> Tables:
    """The tables of the kernels; contacts, fields and forces of plug-ins are still absent.

    Asperites, with bobs at `depths` (n,), have the columns (n, members); where they are `apart`,
    each has constants of its own.
    """
    n = numbering.columns
    _place_constants(numbering.surfaces, asperites, apart)
    shared = columns_of_constants(numbering.surfaces, asperites["surface"][:, None], columns)
    baths = [surface.bath for surface in scene.surfaces]
    bath = _oscillators([(each.masses, each.frequencies) for each in baths])
    torsional = _oscillators([(each.inertias, each.torsional_frequencies) for each in baths])
    lattice = springs(scene, asperites, columns)
    elastic = any(surface.elastic is not None for surface in scene.surfaces)
    pulls = lattice is not None or bath is not None or elastic
    pivots = asperites["pivot"][None]
    on_bars = any(surface.reservoir("bar") for surface in scene.surfaces)
    tilts = any(surface.tilts for surface in scene.surfaces)
    on_swings = any(surface.reservoir("swing") for surface in scene.surfaces)
    return Tables(
        constants=_table(constants_of(scene, asperites), numbering.surfaces, shared, OF_FILLING),
        each=_each(scene, asperites, depths, columns, n),
        surfaces=numbering.surfaces.view(np.recarray),
        core=numbering.core,
        ledger=None if scene.output.ledger == "none" else True,
        sums=True if scene.output.ledger == "surfaces" else None,
        contacts=(),
        species=contacts.species(scene, columns, n),
        bobs=True,
        directions=True,
        f1=True,
        drive=True,
        internal=True if pulls or any(s.is_rigid_block for s in scene.surfaces) else None,
        displaced=True if pulls else None,
        friction=True if on_bars else None,
        swing_friction=True if on_swings else None,
        pivots=_table(pivots, numbering.surfaces, shared, 0.0) if np.any(pivots > 0.0) else None,
        arms=_arms(asperites, columns, n) if tilts else None,
        turned=True if tilts else None,
        couples=True if tilts else None,
        box=Box(scene.periodic.x or 0.0, scene.periodic.z or 0.0) if scene.periodic else None,
        springs=lattice,
        bath=bath,
        bath_momentum=None if bath is None else True,
        torsional=torsional,
        own=own_of_reservoirs(scene, numbering, columns),
    )


def own_of_reservoirs(scene: Scene, numbering: Numbering, columns: np.ndarray) -> np.ndarray | None:
    """Numbers of surfaces, a column for each asperite, where reservoirs differ between asperites.

    None where none do.  See `kernels.records.OF_MEMBERS`.
    """
    reservoirs = [each for surface in scene.surfaces for each in surface.reservoirs]
    if all(each.is_uniform for each in reservoirs):
        return None
    own = room((len(records.OF_MEMBERS), numbering.columns))
    fill_own(own, numbering.surfaces)
    for surface in scene.surfaces:
        mine = columns[scene.parts[surface.name]]
        for reservoir in surface.reservoirs:
            before = "swing_" if reservoir.on == "swing" else ""
            for name, each in zip(
                ("gamma", "temperature"), reservoir.for_each(surface.count), strict=True
            ):
                own[records.OF_MEMBERS.index(before + name), mine] = each[:, None]
    return own


def fill_own(own: np.ndarray, surfaces: np.ndarray) -> None:
    """Let all asperites of a surface have its numbers."""
    for surface in surfaces:
        for row, name in enumerate(records.OF_MEMBERS):
            own[row, surface["start"] : surface["end"]] = surface[name]


def are_alike(surface: np.void, asperites: np.ndarray) -> bool:
    """Whether a surface's asperites share their constants.

    Those that fill its last pack would turn if the angles of bars were not zero.
    """
    if surface["tilted"]:
        return False
    return asperites.size == 1 or all(
        np.all(asperites[name] == asperites[name][0]) for name in PARAMETERS
    )


def _place_constants(surfaces: np.ndarray, asperites: np.ndarray, apart: bool) -> None:
    ends = np.searchsorted(asperites["surface"], np.arange(surfaces.size + 1))
    first = 0
    for k, surface in enumerate(surfaces):
        alike = not apart and are_alike(surface, asperites[ends[k] : ends[k + 1]])
        surface["first_constants"] = first
        surface["constants_mask"] = 0 if alike else -1
        first += LANES if alike else surface["stop"] - surface["start"]


def columns_of_constants(
    surfaces: np.ndarray, owners: np.ndarray, columns: np.ndarray
) -> np.ndarray:
    """The columns of the constants of some asperites, from their surfaces and columns."""
    place = (columns - surfaces["start"][owners]) & surfaces["constants_mask"][owners]
    return np.asarray(surfaces["first_constants"][owners] + place)


def _each(
    scene: Scene, asperites: np.ndarray, depths: np.ndarray, columns: np.ndarray, count: int
) -> np.ndarray:
    """The table of constants that differ between asperites that are alike otherwise."""
    table = room((records.EACH_ROWS, count))
    values = {
        records.X_START: asperites["x"],
        records.Y_START: asperites["y"] + asperites["facing"] * asperites["pivot"],
        records.Z: depths,
        records.CHARGE: np.concatenate([s.each["charge"] for s in scene.surfaces]),
        records.PRESENT: np.ones(asperites.size),
    }
    for row, value in values.items():
        table[row, columns] = value[:, None]
    return table


def _arms(asperites: np.ndarray, columns: np.ndarray, count: int) -> np.ndarray:
    """The table of the arms of bars of blocks that tilt; 0 for all others."""
    table = room((2, count))
    for row, name in enumerate(("arm_x", "arm_y")):
        table[row, columns] = asperites[name][:, None]
    return table


def _table(
    values: np.ndarray, surfaces: np.ndarray, columns: np.ndarray, others: np.ndarray | float
) -> np.ndarray:
    """A table like that of constants, with values (rows, asperites) in some columns.

    Others fill up packs, and feel no force.  Asperites that are alike share a pack of the first.
    """
    last = surfaces[-1]
    size = LANES if last["constants_mask"] == 0 else last["stop"] - last["start"]
    table = room((len(values), int(last["first_constants"] + size)))
    table[:] = others
    table[:, columns] = values[:, :, None]
    for first in surfaces["first_constants"][surfaces["constants_mask"] == 0]:
        table[:, first : first + LANES] = table[:, first : first + 1]
    return table


def constants_of(scene: Scene, asperites: np.ndarray) -> np.ndarray:
    """The constants of asperites, (rows, asperites)."""
    table = np.zeros((len(records.CONSTANTS), asperites.size))
    for row, name in enumerate(records.CONSTANTS):
        if name in (records.ASPERITE.names or ()):
            table[row] = asperites[name]
    # On driven bars and blocks of pendulums they refer to the bar's centre; see `kernels.levers`.
    about_bar = asperites["pivot"] > 0.0
    a = asperites[about_bar]
    table[records.INERTIA, about_bar] += a["mass"] * a["pivot"] ** 2
    table[records.L1, about_bar] += a["pivot"]
    table[records.L2, about_bar] = 0.0
    held = np.array([s.drive.holds_bars for s in scene.surfaces])[asperites["surface"]]
    table[records.MASS, held] = np.inf
    rigid = np.array([s.asperite.is_rigid for s in scene.surfaces])[asperites["surface"]]
    table[records.INERTIA, rigid] = np.inf
    table[records.INVERSE_MASS] = 1.0 / table[records.MASS]
    table[records.INVERSE_INERTIA] = 1.0 / table[records.INERTIA]
    table[records.INVERSE_BAR_LENGTH] = 1.0 / asperites["bar_length"]
    phi = asperites["phi"]
    table[records.SIN_PHI] = np.sin(phi)
    table[records.COS_PHI] = np.cos(phi)
    turning = asperites["dof_phi"] >= 0
    mobility = table[records.INVERSE_INERTIA] + np.where(turning, 1.0 / asperites["i2"], 0.0)
    table[records.FREQUENCY] = np.sqrt(asperites["kappa"] * mobility)
    return table


def _oscillators(baths: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray | None:
    """Masses and frequencies of all oscillators; those that fill the last pack have none."""
    whole = [-(-masses.size // LANES) * LANES for masses, _ in baths]
    if sum(whole) == 0:
        return None
    table = room((2, sum(whole)))
    first = np.cumsum(whole) - whole
    for k, (masses, frequencies) in enumerate(baths):
        table[:, first[k] : first[k] + masses.size] = masses, frequencies
    return table
