"""Runs of the module of a row or grid beside those of tribo.simulate, on a generic processor.

A program: it takes names of scenes and prints a line of JSON for each.  The environment has
NUMBA_CPU_NAME=generic, without which bits differ.
"""

import json
import sys
from dataclasses import replace

import numpy as np

import tribo
from support.crossed import Push, Turn
from support.lattice_machine import LatticeMachine
from tribo.integrators import methods
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import assemble
from tribo.ledger.motion import add_reactions
from tribo.live_pages.lattice import FULL, SHORT, program_of
from tribo.live_pages.lattice_asperite import Drawn
from tribo.live_pages.lattice_compile import module_of
from tribo.live_pages.lattice_keys import is_alike, words_of_keys
from tribo.live_pages.lattice_quantities import MEMBERS, OF_SURFACE, OfWhole
from tribo.live_pages.lattice_source import METHODS
from tribo.model.parameters import with_values

STEP = 0.01
SERIES = ("forces", "energies")


def rows(count=3, **changes):
    """Rows of asperites, the upper one over the lower one; `changes` of both surfaces."""
    scene = tribo.paper.scene("A")
    upper, lower = (
        replace(surface, shape=(count, 1), spacing=(3.0, 0.0), **changes)
        for surface in scene.surfaces
    )
    upper = replace(upper, initial=tribo.Initial(swing=0.1))
    output = tribo.Output(samples=51, series=SERIES)
    return replace(scene, surfaces=(upper, lower), duration=8.0, output=output)


def _pulled():
    """A row with springs, pulled with a load over a row whose bars turn, in a field."""
    scene = rows()
    upper, lower = scene.surfaces
    drive = tribo.Pulled(stiffness=1.0, speed=0.5, load=0.1)
    upper = replace(upper, drive=drive, springs=tribo.Springs(stiffness=2.0))
    lower = replace(lower, bars="free")
    field = tribo.Field(tribo.Corrugation(0.1, 3.0), on=["upper"])
    return replace(scene, surfaces=(upper, lower), fields=(field,))


def _grids():
    """Two by two on driven bars, over free ones, with a cutoff, lists and a period along z."""
    scene = rows()
    grid = {"shape": (2, 2), "spacing": (3.0, 2.5)}
    upper, lower = (replace(surface, **grid) for surface in scene.surfaces)
    lower = replace(lower, drive="bars", asperite=tribo.Asperite(m1=1.5, kappa=3.0))
    upper = replace(upper, drive="free", bob=(-4.0, 0.9))
    potential = tribo.LennardJones(0.3, 1.0).with_cutoff(2.5)
    periodic = tribo.Periodic(z=7.0)
    return replace(scene, surfaces=(upper, lower), interactions=(potential,), periodic=periodic)


def _pushed():
    """A row pushed over one whose bobs repel each other, by a table; asperites differ."""
    scene = rows()
    upper, lower = scene.surfaces
    unequal = tribo.Asperite(m1=[1.0, 1.5, 2.0], kappa=[2.0, 2.5, 3.0])
    upper = replace(upper, drive=tribo.Pushed(force=(0.05, 0.0)), asperite=unequal)
    table = tribo.potentials.tabulated(tribo.Yukawa(0.1, 0.5).energy, 0.3, 12.0, 1e-6)
    within = tribo.Interaction(table, between=("lower", "lower"))
    across = tribo.Interaction(tribo.Coulomb(0.2), between=("upper", "lower"))
    return replace(scene, surfaces=(upper, lower), interactions=(across, within))


def _baths():
    """A free row with a bath that moves and turns, over bars with a warm bath, which are driven."""
    scene = rows()
    upper, lower = scene.surfaces
    cold = tribo.Bath(
        masses=[0.1, 0.2],
        frequencies=[2.0, 3.0],
        inertias=[0.05],
        torsional_frequencies=[1.5],
    )
    warm = tribo.Bath(masses=[0.1, 0.3], frequencies=[1.0, 2.5], temperature=0.01)
    springs = tribo.Springs(stiffness=2.0)
    upper = replace(upper, drive="free", bars="free", bath=cold, springs=springs)
    lower = replace(lower, drive="bars", bath=warm)
    return replace(scene, surfaces=(upper, lower))


def _schedules():
    """A pulled row whose stage starts and stops, over one with a load that oscillates."""
    scene = rows()
    upper, lower = scene.surfaces
    stops = tribo.Schedule([(1.0, 0.0), (2.0, 0.6), (4.03, 0.6), (5.0, 0.1)])
    upper = replace(upper, drive=tribo.Pulled(stiffness=1.0, speed=stops))
    load = tribo.Schedule.sine(mean=0.05, amplitude=0.03, period=2.5, phase=0.4)
    lower = replace(lower, drive=tribo.Free(load=load))
    return replace(scene, surfaces=(upper, lower))


def _moved():
    """Pendulums on bars that start, stop and shake, over driven bars of rigid asperites."""
    scene = rows()
    upper, lower = scene.surfaces
    along = tribo.Schedule([(0.0, 0.5), (3.0, 0.5), (4.0, 0.1), (5.11, 0.1), (6.0, 0.4)])
    shaken = tribo.Schedule.sine(mean=0.0, amplitude=0.1, period=1.5)
    upper = replace(upper, drive=tribo.Moved(speed=(along, shaken)))
    lower = replace(lower, asperite=tribo.Asperite(kappa=np.inf), drive="forced")
    return replace(scene, surfaces=(upper, lower))


def _blocks():
    """A block of pendulums, pulled with dampers under a load, over a free block of rigid ones."""
    scene = rows()
    upper, lower = scene.surfaces
    drive = tribo.Pulled(
        stiffness=1.0, speed=0.5, load=0.1, block=True, stiffness_y=0.5, damping=0.2, damping_y=0.1
    )
    upper = replace(upper, drive=drive)
    steps = tribo.Schedule([(0.0, 0.0), (3.3, 0.1), (6.0, 0.0)], kind="steps")
    push = tribo.Pushed(force=(steps, 0.05), block=True)
    lower = replace(lower, asperite=tribo.Asperite(kappa=np.inf), drive=push)
    return replace(scene, surfaces=(upper, lower))


def _tilting():
    """A block of pendulums that turns, over one of rigid asperites that turns."""
    scene = rows()
    upper, lower = scene.surfaces
    drive = tribo.Pulled(
        stiffness=1.0, speed=0.5, load=0.1, block=True, tilt="free", stiffness_y=2.0
    )
    upper = replace(upper, drive=drive)
    push = tribo.Pushed(force=(0.05, 0.02), block=True, tilt="free")
    lower = replace(lower, asperite=tribo.Asperite(kappa=np.inf), drive=push)
    return replace(scene, surfaces=(upper, lower))


def _own():
    """Bars with a drive of one's own, over bars with such forces on their ends."""
    scene = rows()
    upper, lower = scene.surfaces
    upper = replace(upper, drive=tribo.Custom(force=Push(0.1)))
    lower = replace(lower, drive="free", bars=tribo.Ends(Turn(0.1)))
    return replace(scene, surfaces=(upper, lower))


SCENES = {
    "rows": rows(),
    "pulled": _pulled(),
    "grids": _grids(),
    "pushed": _pushed(),
    "baths": _baths(),
    "schedules": _schedules(),
    "moved": _moved(),
    "blocks": _blocks(),
    "tilting": _tilting(),
    "own": _own(),
}


def compared(scene, method):
    """Whether all bits of a run are the same, and the largest relative error of any quantity."""
    layout = lay_out(scene)
    program = program_of(layout, STEP, method)
    machine = LatticeMachine(module_of(scene, program, layout.plugins), program)
    code = machine.run(FULL)
    found = {name: machine.get(array) for name, array in program.results[FULL].items()}
    columns = [machine.get(each).copy() for each in program.columns]
    add_reactions(layout, *columns[:2], columns[0][:1])
    simulation = tribo.prepare(scene, method=method, step=STEP)
    result = simulation.integrator(simulation.plan.setting, layout.times)
    samples = result.samples
    same = [
        bool(np.array_equal(one, other, equal_nan=True))
        for one, other in zip(columns, samples.columns[1:], strict=True)
    ]
    ledger = assemble(layout, samples)
    worst, worst_of, count = 0.0, "", 0
    for name, values, wanted in pairs_of(scene, ledger, found):
        count += 1
        size = max(1.0, float(np.max(np.abs(wanted))))
        error = float(np.max(np.abs(values - wanted))) / size
        if not error <= worst:
            worst, worst_of = error, name
    short_code = machine.run(SHORT)
    ends = machine.get(program.results[SHORT]["series"])
    return {
        "codes": [code, short_code],
        "status": str(result.status),
        "same": all(same),
        "same_of": same,
        "compared": count,
        "worst": worst,
        "worst_of": worst_of,
        "short": bool(
            np.allclose(ends, found["series"][:, [0, -1]], rtol=1e-9, atol=1e-9, equal_nan=True)
        ),
        **changed_by_keys(scene, layout, machine),
    }


def changed_by_keys(scene, layout, machine):
    """All keys changed at once: how far memory is from that of the scene with these values."""
    program, image = machine.program, machine.image
    values = {}
    words = image.words.copy()
    for each in words_of_keys(layout, program):
        change = 0.03125 * (abs(each.value) or 0.5)
        key = f"{each.key}.0" if each.key.endswith(".velocity") else each.key
        values[key] = each.value + change
        words.view(float)[each.places] += each.factors * change
    machine.words = words
    machine.load()
    machine.call(program.calls[FULL][0])
    machine.words = image.words
    found = np.frombuffer(machine.read(machine.base, words.nbytes))
    other = program_of(lay_out(with_values(scene, values)), STEP, program.method).image()
    wanted = other.words.view(float)
    numbers = np.ones(wanted.size, bool)
    numbers[image.addresses] = numbers[image.units[:, 0]] = False
    numbers &= ~np.isnan(wanted)
    size = np.maximum(1.0, np.abs(wanted[numbers]))
    with np.errstate(invalid="ignore"):  # infinite masses
        apart = np.abs(found[numbers] - wanted[numbers]) / size
    return {
        "keys": sorted(values),
        "alike": is_alike(image, other),
        "apart": float(np.nanmax(apart)),
    }


def pairs_of(scene, ledger, found):
    """Names, the module's series and those of the ledger."""
    series, drawn = found["series"], found["drawn"]
    first = 0
    for n, surface in enumerate(scene.surfaces):
        table = ledger.of(surface.name)
        block = ledger.blocks[surface.name]
        for place, name in enumerate(OF_SURFACE):
            row = series[n * MEMBERS + place]
            if name == "energy_bath" and surface.bath:
                own = np.asarray(block["k_bath"]) + np.asarray(block["e_bath"])
                yield f"{surface.name}.{name}", row, own
            elif name in block:
                yield f"{surface.name}.{name}", row, np.asarray(block[name])
            elif name in table:
                yield f"{surface.name}.{name}", row, np.asarray(table[name]).sum(axis=1)
        for place, name in enumerate(Drawn._fields):
            if name in table:
                own = drawn[place][:, first : first + surface.count]
                if not (name.startswith("f2") and np.isnan(own).all()):
                    yield f"{surface.name}.{name}", own, np.asarray(table[name])
        first += surface.count
    for place, name in enumerate(OfWhole._fields):
        if name in ledger.system:
            row = series[len(scene.surfaces) * MEMBERS + place]
            yield name, row, np.asarray(ledger.system[name])


def main(names):
    for name in names:
        scene = SCENES[name]
        method = next(m for m in METHODS if not methods.refusal(methods.named(m), scene))
        print(json.dumps({"name": name, **compared(scene, method)}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
