"""Runs of the module of a row or grid beside those of tribo.simulate, on a generic processor.

A program: it takes names of scenes and prints a line of JSON for each.  The environment has
NUMBA_CPU_NAME=generic, without which bits differ.
"""

import json
import sys
from dataclasses import replace

import numpy as np

import tribo
from support.lattice_machine import LatticeMachine
from tribo.layout.layout import lay_out
from tribo.ledger.ledger import assemble
from tribo.live_pages.lattice import FULL, METHOD, SHORT, program_of
from tribo.live_pages.lattice_compile import module_of
from tribo.live_pages.lattice_quantities import MEMBERS, Drawn, OfSurface, OfWhole

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


SCENES = {"rows": rows()}


def compared(scene):
    """Whether all bits of a run are the same, and the largest relative error of any quantity."""
    layout = lay_out(scene)
    program = program_of(layout, STEP)
    machine = LatticeMachine(module_of(scene, program, layout.plugins), program)
    code = machine.run(FULL)
    found = {name: machine.get(array) for name, array in program.results[FULL].items()}
    columns = [machine.get(each) for each in program.columns]
    simulation = tribo.prepare(scene, method=METHOD, step=STEP)
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
        "short": bool(np.allclose(ends, found["series"][:, [0, -1]], rtol=1e-9, atol=1e-9)),
    }


def pairs_of(scene, ledger, found):
    """Names, the module's series and those of the ledger."""
    series, drawn = found["series"], found["drawn"]
    first = 0
    for n, surface in enumerate(scene.surfaces):
        table = ledger.of(surface.name)
        block = ledger.blocks[surface.name]
        for place, name in enumerate(OfSurface._fields):
            row = series[n * MEMBERS + place]
            if name in block:
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
        print(json.dumps({"name": name, **compared(SCENES[name])}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
