"""Runs of the module of a page beside those of tribo.simulate, all on a generic processor.

A program: it takes names of potentials and a number of random scenes for each, and prints a line of
JSON for each scene.  The environment has NUMBA_CPU_NAME=generic, without which bits differ.
"""

import json
import sys

import numpy as np

import tribo
from support.live_module import Machine
from tribo.kernels.records import CLOCK
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import assemble
from tribo.live_pages import program
from tribo.live_pages.compile import module_of
from tribo.live_pages.inputs import inputs_of
from tribo.live_pages.quantities import MEMBERS, OF_ASPERITE, OfSystem
from tribo.pair import step_rows


class Own(tribo.Potential):
    """A user's potential with an exponential, whose force follows from its energy."""

    strength: float
    width: float

    def energy(self, r):
        return self.strength * np.exp(-(r * r) / (self.width * self.width)) / (1.0 + r)


POTENTIALS = {
    "Coulomb": tribo.Coulomb(0.2),
    "Own": Own(0.5, 2.0),
    "Expression": tribo.potentials.expression("A*cos(3*r)*exp(-r/a)", A=0.4, a=1.5),
    "Yukawa": tribo.Yukawa(-0.3, 0.4),
    "Plummer": tribo.potentials.Plummer(0.3, 0.5),
    "LennardJones": tribo.LennardJones(0.3, 0.8),
    "WeeksChandlerAndersen": tribo.potentials.WeeksChandlerAndersen(0.4, 0.9),
    "Mie": tribo.potentials.Mie(0.3, 0.8, 11.5, 5.5),
    "SoftSphere": tribo.potentials.SoftSphere(0.3, 0.8, 4.5),
    "Morse": tribo.Morse(0.3, 1.5, 1.0),
    "BornMayer": tribo.potentials.BornMayer(1.0, 0.5),
    "Buckingham": tribo.potentials.Buckingham(80.0, 0.25, 0.1),
    "Gaussian": tribo.potentials.Gaussian(0.5, 1.2),
    "Hertz": tribo.potentials.Hertz(2.0, 1.5),
    "Sum": tribo.Coulomb(0.2) + 0.5 * tribo.Morse(0.3, 1.5, 1.0),
    "Switched": tribo.Morse(0.3, 1.5, 1.0).with_cutoff(4.0),
    "ForceShifted": tribo.LennardJones(0.3, 0.8).with_cutoff(3.0, "force-shift"),
    "Shifted": tribo.Coulomb(0.2).with_cutoff(5.0, "shift"),
    "Table": tribo.potentials.tabulated(tribo.Morse(0.3, 1.5, 1.0).energy, 0.3, 12.0, 1e-6),
    "Truncated": tribo.Coulomb(0.2).with_cutoff(5.0, "truncate"),
}
# Of the run that the others are compared with.
ACCURACY = 1e-9
SERIES = ("forces", "energies")


def random_scene(rng, potential):
    """One asperite on one, each with a drive, parameters and a start of its own."""

    def surface(name, facing, x, y):
        number = rng.uniform
        asperite = tribo.Asperite(
            m1=number(0.5, 5.0),
            m2=number(0.5, 8.0),
            kappa=number(0.5, 4.0),
            length=number(1.0, 3.0),
            bar_length=number(2.0, 4.0),
            charge=number(0.5, 1.5),
        )
        initial = tribo.Initial(swing=number(-0.2, 0.2), omega=number(-0.2, 0.2))
        return tribo.Surface(
            name,
            facing=facing,
            bob=(x, y),
            depth=number(-0.1, 0.1),
            velocity=(number(0.2, 1.0) if facing == "down" else number(-0.3, 0.0), 0.0),
            drive=str(rng.choice(["forced", "free", "bars"])),
            asperite=asperite,
            initial=initial,
        )

    upper = surface("upper", "down", rng.uniform(-6.0, -4.0), rng.uniform(0.3, 0.6))
    lower = surface("lower", "up", 0.0, 0.0)
    output = tribo.Output(samples=101, series=SERIES)
    return tribo.Scene((upper, lower), potential, 12.0, output=output)


def compared(scene):
    """Whether all bits of a run are the same, and the largest relative error of any quantity."""
    simulation = tribo.prepare(scene, accuracy=ACCURACY, method="gauss-radau-15")
    layout, pair = simulation.layout, simulation.integrator.pair
    potential, setting = layout.model.contacts[0].potential, simulation.plan.setting
    tolerance = setting.of_adaptive_steps()
    times = layout.times
    memory = pair.rows()
    memory[step_rows.LIMITS : step_rows.STATE] = pair.limits(setting)
    options = np.zeros(program.OPTIONS)
    options[program.GIVEN], options[program.NEAR] = 1.0, tolerance.encounter_fraction
    options[program.MOST_STEPS] = 1e6
    host = Machine(module_of(potential), potential, times.size, CLOCK.itemsize)
    numbers = inputs_of(lay_out(scene))
    code = host.run(numbers=numbers, options=options, memory=memory, times=times)
    run = pair.integrate(setting, layout.start, times)
    found, series = host.get("record")[:-1], host.get("series")
    same = bool(np.array_equal(found, run.samples._record))
    ledger = assemble(layout, run.samples)
    worst, worst_of = 0.0, ""
    wanted = {}
    for k, surface in enumerate(scene.surfaces):
        table = ledger.of(surface.name)
        for place, name in enumerate(OF_ASPERITE):
            if name in table:
                wanted[f"{surface.name}.{name}"] = k * MEMBERS + place, np.asarray(table[name])
    for place, name in enumerate(OfSystem._fields):
        if name in ledger.system:
            wanted[name] = 2 * MEMBERS + place, ledger.system[name]
    for name, (row, values) in wanted.items():
        size = max(1.0, float(np.max(np.abs(values))))
        error = float(np.max(np.abs(series[row] - values.reshape(times.size, -1)[:, 0]))) / size
        if error > worst:
            worst, worst_of = error, name
    own = own_settings(host, numbers, scene)
    return {
        "status": [code, str(run.status)],
        "same": same,
        "compared": len(wanted),
        "worst": worst,
        "worst_of": worst_of,
        **own,
    }


def own_settings(host, numbers, scene):
    """The run at the page's own settings: its errors, in units of what it says of them."""
    accurate = host.get("series").copy()
    options = np.zeros(program.OPTIONS)
    options[program.LEVEL], options[program.NEAR] = program.level_of(1e-8), program.NEAR_FINE
    options[program.MOST_STEPS], options[program.ESTIMATE] = 1e5, 1.0
    options[program.ROUGH] = np.isfinite(scene.smoothness)
    code = host.run(numbers=numbers, options=options)
    errors = np.abs(host.get("series") - accurate).max(axis=1)
    said = host.get("errors") + ACCURACY * np.abs(accurate).max(axis=1)
    known = said > 0.0
    return {"own_code": code, "own_excess": float(np.max(errors[known] / said[known]))}


def main(names, scenes):
    for name in names:
        rng = np.random.default_rng([7, *name.encode()])
        potential = POTENTIALS[name]
        for _ in range(scenes):
            print(json.dumps({"name": name, **compared(random_scene(rng, potential))}), flush=True)


if __name__ == "__main__":
    main(sys.argv[2:], int(sys.argv[1]))
