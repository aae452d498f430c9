"""Scenes seen otherwise: elsewhere, from a moving frame, backwards, in other units, in a mirror."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from tribo import Corrugation, Coulomb, DrivenBars, Interaction, LennardJones, Morse, Pulled, Pushed


def changed(scene, change, field=lambda f: f, **others):
    """The scene with every surface and every external field changed."""
    surfaces = tuple(change(s) for s in scene.surfaces)
    return replace(scene, surfaces=surfaces, fields=tuple(map(field, scene.fields)), **others)


def started(surface, **changes):
    """The surface's initial angles and rates, those that are given changed by a function."""
    initial = surface.initial
    old = {name: getattr(initial, name) for name in changes}
    new = {name: changes[name](value) for name, value in old.items() if value is not None}
    return replace(initial, **new)


def plus(one, other):
    """The sum of two vectors."""
    return (one[0] + other[0], one[1] + other[1])


def reservoir(langevin, change):
    """The reservoir with its velocity changed, if it has one of its own."""
    if langevin is None or langevin.velocity is None:
        return langevin
    return replace(langevin, velocity=change(langevin.velocity))


def pulled_back(drive):
    """The drive with its stage, if it has one, moving the other way."""
    return replace(drive, speed=-drive.speed) if isinstance(drive, Pulled) else drive


def translated(scene, by, along_z=0.0):
    """The scene somewhere else."""

    def move(s):
        return replace(s, bob=plus(s.bob, by), depth=s.depth + along_z)

    return changed(scene, move, lambda f: replace(f, origin=plus(f.origin, by)))


def boosted(scene, u):
    """The scene seen by an observer who moves at -u; stages, fields, reservoirs likewise."""

    def boost(s):
        drive = s.drive
        if isinstance(drive, Pulled):
            drive = replace(drive, speed=drive.speed + u[0])
        langevin = reservoir(s.langevin, lambda v: plus(v, u))
        return replace(s, velocity=plus(s.velocity, u), drive=drive, langevin=langevin)

    return changed(scene, boost, lambda f: replace(f, velocity=plus(f.velocity, u)))


def references(surface):
    """x, y, z of what an initial angle does not move: centres of mass, or driven bars."""
    return surface.resting_bobs() + _above_bobs(surface)


def placed(surface, r, **others):
    """The surface with its `references` at other places, and other things changed as well."""
    bobs = r - _above_bobs(surface)
    no_grid = {"bob": (0.0, 0.0), "shape": (1, 1), "spacing": (0.0, 0.0), "depth": 0.0}
    if surface.springs:
        row = range(surface.count)
        no_grid["springs"] = replace(surface.springs, pairs=list(pairwise(row)))
    return replace(surface, positions=bobs, heights=None, **no_grid, **others)


def _above_bobs(surface):
    """The vectors (n, 3) from resting bobs to `references`."""
    length = "length" if isinstance(surface.drive, DrivenBars) else "l1"
    lift = surface.facing_sign * surface.asperite.for_each(surface.count)[length]
    return np.column_stack([0.0 * lift, lift, 0.0 * lift])


def turned_back(result):
    """A scene that starts at the end of a run, all velocities reversed.

    A surface starts with one velocity, so this is for surfaces whose asperites keep together.
    """

    def turn(s):
        end = {name: values[-1] for name, values in result[s.name].items()}
        point = "bar" if isinstance(s.drive, DrivenBars) else "cm"
        r = np.column_stack([end[f"x_{point}"], end[f"y_{point}"], references(s)[:, 2]])
        start = {"theta": end["theta"], "phi": end["phi"], "omega": -end["omega"], "nu": -end["nu"]}
        velocity = (-end["vx_cm"][0], -end["vy_cm"][0])
        if isinstance(s.drive, DrivenBars):
            velocity = (-s.velocity[0], -s.velocity[1])
        return placed(s, r, velocity=velocity, initial=replace(s.initial, **start))

    return changed(result.scene, turn)


def potential_in_units(potential, length, energy):
    """The same potential in other units."""
    if isinstance(potential, Coulomb):
        return Coulomb(potential.strength * energy * length)
    if isinstance(potential, Morse):
        return Morse(potential.D * energy, potential.alpha / length, potential.r0 * length)
    return LennardJones(potential.epsilon * energy, potential.sigma * length)


def drive_in_units(drive, length, mass, time):
    """The same drive in other units."""
    if drive.load is not None:
        drive = replace(drive, load=drive.load * (mass * length / time**2))
    if isinstance(drive, Pushed):
        force = np.array([drive.force, drive.rate])
        unit = mass * length / time**2
        return replace(drive, force=force[0] * unit, rate=force[1] * (unit / time))
    if isinstance(drive, Pulled):
        stiffness = drive.stiffness * (mass / time**2)
        speed = drive.speed * (length / time)
        drive = replace(drive, stiffness=stiffness, speed=speed)
    return drive


def asperite_in_units(a, length, mass, energy):
    """The same parameters in other units."""
    factors = {
        "m1": mass,
        "m2": mass,
        "kappa": energy,
        "length": length,
        "bar_length": length,
        "i2": mass * length**2,
    }
    return replace(a, **{name: np.multiply(getattr(a, name), f) for name, f in factors.items()})


def extras_in_units(s, length, mass, time):
    """A surface's springs, bath and reservoir in other units."""
    on_swing = s.langevin is not None and s.langevin.on == "swing"
    pairs = zip(s.bath.masses * mass, s.bath.frequencies / time, strict=True)
    return {
        "springs": replace(s.springs, stiffness=s.springs.stiffness * (mass / time**2)),
        "bath": {"oscillators": [{"mass": m, "frequency": w} for m, w in pairs]},
        "langevin": s.langevin
        and replace(
            reservoir(s.langevin, lambda v: np.multiply(v, length / time)),
            gamma=s.langevin.gamma * (mass / time) * (length**2 if on_swing else 1.0),
        ),
    }


def field_in_units(f, length, energy, time):
    """The same field in other units."""
    potential = Corrugation(f.potential.amplitude * energy, f.potential.period * length)
    origin = np.multiply(f.origin, length)
    velocity = np.multiply(f.velocity, length / time)
    return replace(f, potential=potential, origin=origin, velocity=velocity)


def in_units(scene, length, mass, time):
    """The same scene in other units: every length is multiplied by `length`, and so on."""
    energy = mass * length**2 / time**2

    def convert(s):
        """A surface in other units of length, mass and time."""
        rates = dict.fromkeys(("omega", "nu"), lambda rate: np.divide(rate, time))
        return replace(
            s,
            bob=np.multiply(s.bob, length),
            velocity=np.multiply(s.velocity, length / time),
            spacing=np.multiply(s.spacing, length),
            depth=s.depth * length,
            heights=s.heights * length,
            drive=drive_in_units(s.drive, length, mass, time),
            asperite=asperite_in_units(s.asperite, length, mass, energy),
            initial=started(s, **rates),
            **extras_in_units(s, length, mass, time),
        )

    potential = potential_in_units(scene.interactions[0].potential, length, energy)
    return changed(
        scene,
        convert,
        lambda f: field_in_units(f, length, energy, time),
        interactions=(Interaction(potential),),
        duration=scene.duration * time,
    )


def reflected(scene):
    """The scene in a mirror: x -> -x."""

    def reflect(s):
        """A surface with x reflected."""
        mirror = started(
            s,
            theta=lambda theta: 2.0 * s.rest - np.asarray(theta),
            **dict.fromkeys(("phi", "omega", "nu"), np.negative),
        )
        return replace(
            s,
            bob=(-s.bob[0], s.bob[1]),
            velocity=(-s.velocity[0], s.velocity[1]),
            spacing=(-s.spacing[0], s.spacing[1]),
            drive=pulled_back(s.drive),
            langevin=reservoir(s.langevin, lambda v: (-v[0], v[1])),
            initial=mirror,
        )

    def reflect_field(f):
        origin = (-f.origin[0], f.origin[1])
        velocity = (-f.velocity[0], f.velocity[1])
        return replace(f, origin=origin, velocity=velocity)

    return changed(scene, reflect, reflect_field)


def upside_down(scene):
    """The scene turned by pi, with its surfaces in the other order.

    Bars are turned by pi too, that is, their ends change names.
    """

    def turn(s):
        return replace(
            s,
            facing="up" if s.facing == "down" else "down",
            bob=(-s.bob[0], -s.bob[1]),
            velocity=(-s.velocity[0], -s.velocity[1]),
            spacing=(-s.spacing[0], s.spacing[1]),
            heights=-s.heights,
            drive=pulled_back(s.drive),
            langevin=reservoir(s.langevin, np.negative),
            initial=started(s, theta=lambda theta: np.asarray(theta) + np.pi - 2.0 * s.rest),
        )

    def turn_field(f):
        return replace(f, origin=np.negative(f.origin), velocity=np.negative(f.velocity))

    scene = changed(scene, turn, turn_field)
    return replace(scene, surfaces=scene.surfaces[::-1])


def rotated(scene, angle):
    """The scene turned by an angle; rest angles, theta - phi, stay."""
    cos = np.cos(angle)
    sin = np.sin(angle)
    matrix = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])

    def turn(s):
        start = started(s, theta=lambda a: np.add(a, angle), phi=lambda a: np.add(a, angle))
        velocity = matrix[:2, :2] @ s.velocity
        return placed(s, references(s) @ matrix.T, velocity=velocity, initial=start)

    return changed(scene, turn)
