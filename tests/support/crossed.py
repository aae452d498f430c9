"""Every effect crossed with every other, with noise and without, in steps of equal length.

Runs uncompiled, in a process of its own: `python -m support.crossed` prints what is wrong.
"""

from functools import cache, partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

import tribo
from support.laws import identities, tables
from tribo import (
    Asperite,
    Bath,
    Corrugation,
    Coulomb,
    Custom,
    DrivenBars,
    Ends,
    Field,
    Forced,
    Free,
    Initial,
    Interaction,
    Langevin,
    Morse,
    Output,
    Periodic,
    Pulled,
    Pushed,
    Scene,
    Springs,
    Surface,
)

STEP = 0.01
END = 0.03
# Largest difference of verlet from one step of rk4.
AGREE = 2e-5
# Least change of the motion by an effect.
ACT = 1e-4
# Largest residual of an identity of the ledger, of energies of order 1: round-off, and with stored
# energies the error of the step.  A reservoir with noise moves bars by jumps, whose works are
# shared with the next kick: half of the last one is missing.
CLOSED = {"W = delta(K + E_int)": 1e-4, "applied work = change of energy": 4e-4}
ROUND_OFF = 1e-13
# The pseudoworks of forces on ends are not reported; those of a user's do not cancel.
NOT_A_LAW = ("w_ps is the sum of the pseudoworks", True)
# Effects that bars which keep their velocities do not feel: driven ones, and forced rigid ones.
IDLE = dict.fromkeys(("springs", "bath"), ("driven bars", "rigid asperites"))
# A temperature at which noise changes nothing.
COLD = 1e-30
# A temperature at which it does, and the least change of the motion.
WARM = 0.3
NOISE = 0.01


class Push(NamedTuple):
    """A drive that knows its bar's place and velocity."""

    strength: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """A pull in both directions, against friction."""
        return self.strength * (1.0 - 0.3 * vx * abs(vx) - 0.2 * x), 0.3 * vx - 0.2 * vy - fy


class Turn(NamedTuple):
    """Forces on the ends of a bar that know its rate of rotation."""

    strength: float

    def end_forces(self, t, phi, nu, twist):
        """Two forces that are not opposed."""
        return 0.1, -self.strength * nu, 0.2 - nu, self.strength * (twist + 1.0)


# The effects, each as settings of a surface or of the scene.
EFFECTS = {
    "free": {"drive": Free},
    "rigid": {"drive": partial(Free, rigid=True)},
    "pulled": {"drive": partial(Pulled, stiffness=2.0, speed=1.5)},
    "pushed": {"drive": partial(Pushed, force=(0.6, 0.0), rate=(0.4, 0.0))},
    "custom": {"drive": partial(Custom, force=Push(1.5))},
    "driven bars": {"drive": DrivenBars, "load": None, "end forces": False, "on": "swing"},
    "rigid asperites": {
        "kappa": np.inf,
        "bars": "clamped",
        "inertias": (),
        "torsional_frequencies": (),
        "on": "bar",
    },
    "load": {"load": 0.7},
    "turning bars": {"bars": "free"},
    "ends": {"bars": Ends(Turn(0.8)), "end forces": True},
    "springs": {"springs": Springs(30.0)},
    "bath": {"masses": (0.4, 0.3), "frequencies": (4.0, 7.0)},
    "torsional bath": {"inertias": (0.3,), "torsional_frequencies": (4.0,)},
    "reservoir": {"gamma": 0.6, "on": "bar"},
    "swing reservoir": {"gamma": 0.6, "on": "swing"},
    "field": {"field": Corrugation(0.5, 1.5)},
    "within": {"within": Morse(3.0, 2.0, 0.6)},
    "cutoff": {"cutoff": 1.2},
    "periodic": {"period": 2.4},
}
# Effects that others bring with them.
NEEDED_BY = {"turning bars": ("torsional bath",), "cutoff": ("periodic",)}


def surface(name, settings, temperature):
    """Two asperites that turn and swing."""
    upper = name == "upper"
    bath = {key: settings[key] for key in Bath.__dataclass_fields__ if key in settings}
    bars = settings.get("bars", "free" if "inertias" in bath else "clamped")
    gamma = settings.get("gamma", 0.0 if temperature is None else 0.05)
    on = settings.get("on", "bar")
    rates = {} if "kappa" in settings else {"omega": (-0.4, 0.9), "nu": 1.2}
    return Surface(
        name,
        facing="down" if upper else "up",
        bob=(-1.8, 0.25) if upper else (0.0, 0.0),
        velocity=(0.5, 0.1) if upper else (0.0, 0.0),
        shape=(2, 1),
        spacing=(0.9, 0.0),
        asperite=Asperite(kappa=settings.get("kappa", (3.0, 2.0)), charge=(1.0, 1.4)),
        drive=settings.get("drive", Forced)(load=settings.get("load")),
        bars=bars,
        springs=settings.get("springs"),
        bath=Bath(**bath) if bath else None,
        langevin=Langevin(gamma, temperature or 0.0, on=on) if gamma else None,
        initial=Initial(theta=0.5 if upper else 3.5, phi=0.1, **rates),
    )


def scene(names, temperature):
    """A scene with some effects: on the upper surface, or on the lower where two exclude another.

    `temperature` is that of reservoirs on both surfaces; None leaves these out.
    """
    settings = {"upper": {}, "lower": {}}
    for name in names:
        taken = EFFECTS[name].keys() & settings["upper"].keys()
        settings["lower" if taken else "upper"].update(EFFECTS[name])
    whole = settings["upper"]
    period = whole.get("period")
    contact = Coulomb(0.8)
    if "cutoff" in whole or period:
        contact = contact.with_cutoff(whole.get("cutoff", 1.2))
    interactions = [Interaction(contact, ("upper", "lower"))]
    if "within" in whole:
        cut = whole["within"].with_cutoff(1.2)
        interactions.append(Interaction(cut, ("upper", "upper")))
    return Scene(
        tuple(surface(name, own, temperature) for name, own in settings.items()),
        tuple(interactions),
        END,
        seed=5,
        periodic=Periodic(x=period),
        fields=(Field(whole["field"], on=("upper",)),) if "field" in whole else (),
        output=Output(samples=2),
    )


def motion(result):
    """All coordinates and velocities at the end."""
    names = ("theta", "phi", "omega", "nu", "x_cm", "y_cm", "vx_cm", "vy_cm")
    return np.array([result[s][name][-1] for s in ("upper", "lower") for name in names])


@cache
def run(names, temperature, method=None, step=STEP):
    """A run in equal steps, by the method that is chosen for noise without a name."""
    return tribo.simulate(scene(names, temperature), method=method, step=step)


def apart(one, other):
    """The largest difference of two runs."""
    return float(np.max(np.abs(motion(one) - motion(other))))


def residuals(result):
    """The largest residual of each identity of the ledger."""
    found = {}
    for law, _, one, other in identities(table for _, table in tables(result)):
        found[law] = max(found.get(law, 0.0), float(np.max(np.abs(one - other))))
    return found


def complaints(names):
    """What is wrong with a scene of some effects."""
    for temperature, method in ((None, "verlet"), (COLD, None)):
        same = run(names, temperature, method)
        reference = None if temperature is None else 0.0
        truth = run(names, reference, "rk4", END)
        if apart(same, truth) > AGREE:
            yield f"{same.method} at T = {temperature} is {apart(same, truth):.1e} from rk4"
        for name in names:
            rest = tuple(other for other in names if other != name)
            without_effect = NEEDED_BY.get(name, ()) + IDLE.get(name, ())
            if not set(rest) & set(without_effect):
                gap = apart(same, run(rest, temperature, method))
                if gap < ACT:
                    yield f"{name} acts by {gap:.1e} at T = {temperature}"
    warm = run(names, WARM)
    if apart(warm, run(names, COLD)) < NOISE:
        yield "there is no noise"
    for law, gap in residuals(warm).items():
        if gap > CLOSED.get(law, ROUND_OFF) and (law, "ends" in names) != NOT_A_LAW:
            yield f"{law}: {gap:.1e}"


def order_with_user_forces():
    """The ratio of verlet's errors at two steps, with forces that depend on velocities."""
    names = ("custom", "ends")
    truth = run(names, 0.0, "rk4", 0.5 * STEP)
    coarse, fine = (apart(run(names, COLD, None, step), truth) for step in (STEP, 0.5 * STEP))
    return coarse / fine


def main():
    """Print what is wrong."""
    for names in combinations(EFFECTS, 2):
        for complaint in complaints(names):
            print(f"{' and '.join(names)}: {complaint}")
    if not 3.8 < order_with_user_forces() < 4.2:
        print(f"half the step has 1 / {order_with_user_forces():.2f} of the error")


if __name__ == "__main__":
    main()
