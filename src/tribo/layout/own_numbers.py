"""The numbers in which members of an ensemble may differ, and these from the values of keys."""

from collections.abc import Iterable, Mapping

import numpy as np

from tribo.compiler.numbers_in_lanes import numbers_of
from tribo.kernels.records import ASPERITE, OF_MEMBERS, OWN_SPEED
from tribo.layout.contacts import are_coupled
from tribo.layout.layout import Layout, once_per_layout
from tribo.layout.scene_records import MemberNumbers, fill_parameters, resting_bobs
from tribo.layout.slots import slide
from tribo.model.asperite import Asperite
from tribo.model.keys import INTERACTION, reservoir_part
from tribo.model.parameters import with_values
from tribo.model.surface import Surface
from tribo.model.tables import field_names
from tribo.validation import inside

# Keys of a surface whose numbers may differ between members: its velocity, and a part of it.
VELOCITY = "velocity"
ASPERITE_PART = "asperite"
Values = Mapping[str, np.ndarray]  # of a key: (members, 1), or (members, 2) of velocities


def can_differ(layout: Layout, keys: Iterable[str], by_pair_loop: bool) -> bool:
    """Whether members of a scene may differ in numbers with these dotted keys.

    Whatever else refers to a velocity, or to the numbers of an asperite, is that of the scene.  The
    loop of a pair takes no mass of a surface from the scene.
    """
    scene = layout.scene
    surfaces = scene.surfaces
    if not all(each.is_uniform for surface in surfaces for each in surface.reservoirs):
        return False  # the table of numbers has those of each asperite
    keys = tuple(keys)
    # Surfaces without charges are no pair of a layout whose potential acts between charges.
    if any(key.endswith(".charge") for key in keys):
        for interaction in scene.interactions:
            if not all(are_coupled(scene, interaction, pair) for pair in scene.pairs(interaction)):
                return False
    plain = tuple([name for name, slides in _plain_parts(layout) if by_pair_loop or not slides])
    known = _known_numbers(layout)
    return all(key in known or key.startswith(plain) for key in keys)


@once_per_layout
def _plain_parts(layout: Layout) -> list[tuple[str, bool]]:
    """What keys of plain asperites begin with, and whether their surfaces can slide."""
    surfaces = layout.scene.surfaces
    return [
        (f"{surface.name}.{ASPERITE_PART}.", slides)
        for surface, slides in zip(surfaces, slide(layout.scene).tolist(), strict=True)
        if _is_plain(surface)
    ]


@once_per_layout
def _known_numbers(layout: Layout) -> set[str]:
    """Keys of numbers in which members may differ, but for those of asperites."""
    surfaces = layout.scene.surfaces
    known = {f"{INTERACTION}.{name}" for name in _names_of_potential(layout)}
    for index, surface in enumerate(surfaces):
        known |= {f"{surface.name}.{name}" for name in _numbers_of_parts(layout, index)}
    # A field, a plug-in or a reservoir may be given in the laboratory.
    reservoirs = [reservoir for surface in surfaces for reservoir in surface.reservoirs]
    fixed = any(reservoir.velocity is not None for reservoir in reservoirs)
    # So is the way of a stage that follows a schedule.
    fixed = fixed or bool(np.any(layout.surfaces["stage_schedule"] > 0))
    fixed = fixed or any(surface.drive.gives_motion for surface in surfaces)
    if not (layout.model.fields or layout.model.drives or layout.model.ends or fixed):
        known |= {f"{name}.{VELOCITY}" for name in layout.parts}
    return known


def _numbers_of_parts(layout: Layout, index: int) -> dict[str, str]:
    """Keys of a surface's drive and reservoir, which pairs do not have -> names in `OF_MEMBERS`."""
    surface = layout.scene.surfaces[index]
    drive = surface.drive
    given = [name for name in drive.own_numbers if _is_float(drive, name)]
    if drive.stage is not None and drive.stage.follows_schedule:
        given = [name for name in given if name != "speed"]
    found = {f"drive.{name}": name for name in given}
    if surface.is_noisy:  # so that there is noise
        for each in surface.reservoirs:
            part = reservoir_part(surface, each.on)
            before = "swing_" if each.on == "swing" else ""
            names = [name for name in ("gamma", "temperature") if _is_float(each, name)]
            found |= {f"{part}.{name}": before + name for name in names}
    return found


def _is_float(item: object, name: str) -> bool:
    """Whether a field is one number, which members may have of their own."""
    return isinstance(getattr(item, name), float)


def _is_plain(surface: Surface) -> bool:
    """Whether only masses of a surface, beside its asperites, follow from their numbers."""
    stiff = bool(np.all(surface.each["kappa"] > 0.0)) and not surface.asperite.is_rigid
    others = surface.bath, surface.springs, surface.initial.temperature, surface.langevin
    return stiff and not (surface.drive.holds_bars or any(others))


def _names_of_potential(layout: Layout) -> tuple[str, ...]:
    """The numbers of the potential of the only interaction, if it consists of numbers."""
    contacts = layout.model.contacts
    if len(contacts) != 1 or layout.model.inner is not None:
        return ()
    potential = contacts[0].potential
    return tuple(potential._fields) if numbers_of(potential) else ()


def member_numbers(layout: Layout, members: int, values: Values) -> MemberNumbers:
    """The numbers of members.  Raises InputError if one cannot be used."""
    scene = layout.scene
    asperites = np.tile(np.asarray(layout.asperites).view(ASPERITE), (members, 1))
    charges = np.empty(asperites.shape)
    velocity = np.empty((members, len(scene.surfaces), 2))
    for index, surface in enumerate(scene.surfaces):
        part = layout.parts[surface.name]
        rows = (members, surface.count)
        each = parameters_of_members(surface, members, values)
        bobs = np.tile(resting_bobs(scene, index), (members, 1))
        own = asperites[:, part].ravel()
        fill_parameters(own, surface, each, bobs)
        asperites[:, part] = own.reshape(rows)
        charges[:, part] = each["charge"].reshape(rows)
        velocity[:, index] = values.get(f"{surface.name}.{VELOCITY}", surface.velocity)
    own_velocity = velocity[:, np.asarray(layout.asperites)["surface"]] - velocity[:, :1]
    asperites["vx"] = own_velocity[..., 0]
    asperites["vy"] = own_velocity[..., 1]
    others = _of_surfaces(layout, velocity, values), _potentials(layout, members, values)
    return MemberNumbers(asperites, charges, velocity, *others)


def _of_surfaces(layout: Layout, velocity: np.ndarray, values: Values) -> np.ndarray:
    """The numbers of drives and reservoirs, (members, surfaces, numbers)."""
    table = np.empty((*velocity.shape[:2], len(OF_MEMBERS)))
    surfaces = np.asarray(layout.surfaces)
    for row, name in enumerate(OF_MEMBERS):
        table[..., row] = surfaces[name]
    table[..., :2] = velocity - velocity[:, :1]
    for index, surface in enumerate(layout.scene.surfaces):
        stage = surface.drive.stage
        if stage is not None and not stage.follows_schedule:
            table[:, index, OWN_SPEED] = stage.speed - velocity[:, index, 0]
        for part, name in _numbers_of_parts(layout, index).items():
            key = f"{surface.name}.{part}"
            if key in values:
                own = _checked(layout, key, values[key])
                if name == "speed":
                    own = own - velocity[:, index, 0]
                if name == "load":
                    own = -own * surface.facing_sign
                table[:, index, OF_MEMBERS.index(name)] = own
    return table


def _checked(layout: Layout, key: str, rows: np.ndarray) -> np.ndarray:
    """The values of a key, (members,).  Raises InputError if one cannot be used.

    The extremes of all members so far are tried, and serve for those between them.
    """
    known = _usable(layout)
    low, high = known.get(key, (np.inf, -np.inf))
    for extreme in (float(rows.min()), float(rows.max())):
        if not low <= extreme <= high:
            with_values(layout.scene, {key: extreme})
            low = min(low, extreme)
            high = max(high, extreme)
    known[key] = low, high
    return rows[:, 0]


@once_per_layout
def _usable(layout: Layout) -> dict[str, tuple[float, float]]:
    """Key -> the smallest and the largest value of members that could be used."""
    return {}


def parameters_of_members(surface: Surface, members: int, values: Values) -> dict[str, np.ndarray]:
    """Every parameter of the asperites of a surface, (members x count,)."""
    before = f"{surface.name}.{ASPERITE_PART}."
    count = surface.count
    own: dict[str, float | np.ndarray] = {
        key.removeprefix(before): np.repeat(v[:, 0], count)
        for key, v in values.items()
        if key.startswith(before)
    }
    for name in field_names(Asperite):
        if name not in own:
            common = getattr(surface.asperite, name)
            own[name] = common if isinstance(common, float) else np.tile(common, members)
    with inside(before[:-1]):
        return Asperite(**own).for_each(members * count)


def _potentials(layout: Layout, members: int, values: Values) -> np.ndarray:
    """The numbers of the potential, (members, fields)."""
    names = _names_of_potential(layout)
    numbers = numbers_of(layout.model.contacts[0].potential) if names else ()
    table = np.tile(np.array(numbers, float), (members, 1))
    for key, rows in values.items():
        part, _, name = key.rpartition(".")
        if part == INTERACTION:
            table[:, names.index(name)] = _checked(layout, key, rows)
    return table
