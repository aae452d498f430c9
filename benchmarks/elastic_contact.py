"""Compare the contact of elastic bodies with ContactMechanics, and their speed with springs.

A rigid sphere, and a rough surface, are pressed on an elastic half-space of n × n cells, periodic
along both axes.  ContactMechanics (pip install ContactMechanics) finds the displacements that a
hard flat wall leaves, by conjugate gradients under constraints; tribo relaxes bars on the body that
a flat wall of stiff tips holds.  At equal loads it prints, as ratios of tribo to ContactMechanics,
the approach of the bodies far away, the area of contact, and the root mean square and largest
pressure.  A wall twice as stiff shows what the tips' own compliance adds.

With --speed it measures a step of a pulled block over driven bars that touch it, with springs
between neighbours and with an elastic body in their place, in turn; medians count.

    python benchmarks/elastic_contact.py            # 24 × 24 cells: half a minute
    python benchmarks/elastic_contact.py --side 64
    python benchmarks/elastic_contact.py --speed 10000 100000
"""

import argparse
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import tribo

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

# Young's modulus [force / length^2]; Poisson's ratio of 1/2 does not couple shear and pressure.
MODULUS = 1.0
POISSON = 0.5
CONTACT_MODULUS = MODULUS / (1.0 - POISSON**2)

# Cells a side and radius of the sphere; each cell is 1 [length].
SIDE = 24
RADIUS = 60.0
LOADS = (1.0, 3.0, 6.0)

# Stiffness of a wall's tip [force / length], and how often it is doubled.
WALL = 50.0
DOUBLINGS = 2

# Runs of each kind that are timed in turn; steps of a short run, how many more a long one has, and
# their length [time].
ROUNDS = 5
FEW = 10
STEPS = 100
STEP = 0.01


class Contact(NamedTuple):
    """A contact at a load: approach [length], area [length^2], rms and largest pressure."""

    approach: float
    area: float
    rms_pressure: float
    largest_pressure: float


def contact_of(approach, pressure):
    """The numbers of a contact from the pressures on its cells, of area 1."""
    touching = pressure > 1e-9 * pressure.max()
    rms = float(np.sqrt(np.mean(pressure[touching] ** 2)))
    return Contact(float(approach), float(touching.sum()), rms, float(pressure.max()))


def sphere(side):
    """(side, side) gaps of a sphere over a flat wall [length]."""
    across = np.arange(side) - side // 2
    return (across[:, None] ** 2 + across**2) / (2.0 * RADIUS)


def rough(side):
    """(side, side) gaps of a periodic rough surface over a flat wall [length]."""
    rng = np.random.default_rng(0)
    q = np.hypot(*np.meshgrid(np.fft.fftfreq(side), np.fft.fftfreq(side)))
    q[0, 0] = 1.0
    shape = np.where((q > 1.5 / side) & (q < 0.25), q**-1.8, 0.0)
    heights = np.fft.ifft2(shape * np.fft.fft2(rng.standard_normal((side, side)))).real
    heights *= 0.3 / heights.std()
    return heights - heights.min()


def by_tribo(gap, load, stiffness):
    """The contact of bars on an elastic body with a wall."""
    from support.pressed_body import pressed_body

    elastic = tribo.Elastic(MODULUS, POISSON)
    scene = pressed_body(gap, elastic, load, stiffness, friction=0.3, duration=400.0)
    step = 0.5 / np.sqrt(stiffness)
    own = tribo.simulate(scene, method="verlet", step=400.0 / np.ceil(400.0 / step))["body"]
    pressure = own["f_field_y"][-1]
    assert abs(pressure.sum() / load - 1.0) < 1e-4, "the body still moves"
    return contact_of(np.mean(own["y_bar"][0] - own["y_bar"][-1]), pressure)


def by_contact_mechanics(gap, load):
    """The contact with a hard wall by ContactMechanics."""
    from ContactMechanics import PeriodicFFTElasticHalfSpace, make_system
    from SurfaceTopography import Topography

    size = tuple(map(float, gap.shape))
    topography = Topography(-gap, size, periodic=True)
    substrate = PeriodicFFTElasticHalfSpace(gap.shape, CONTACT_MODULUS, size)
    system = make_system(interaction="hardwall", surface=topography, substrate=substrate)
    found = system.minimize_proxy(external_force=load, pentol=1e-8, maxiter=2000)
    assert found.success, found.message
    # Its uniform displacement has the stiffness of the longest wave; that of a half-space has none.
    approach = found.offset - np.mean(found.x)
    return contact_of(approach, np.asarray(found.jac))


def compare(side):
    """Print the ratios of both programs."""
    for name, gap in (("sphere", sphere(side)), ("rough", rough(side))):
        for load in LOADS:
            known = by_contact_mechanics(gap, load)
            for stiffness in WALL * 2.0 ** np.arange(DOUBLINGS + 1):
                found = by_tribo(gap, load, stiffness)
                ratios = "  ".join(
                    f"{key} {one / other:.4f}"
                    for key, one, other in zip(Contact._fields, found, known, strict=True)
                )
                print(f"{name:7} load {load:g}  wall {stiffness:5g}  {ratios}", flush=True)


def sliding(bars, kind, steps):
    """A block of about so many bars over a grid of driven bars, which it touches."""
    side = 4 * round(bars**0.5 / 4)
    grid = {
        "shape": (side, side),
        "spacing": (1.0, 1.0),
        "asperite": tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf),
    }
    joined = {
        "springs": {"springs": tribo.Springs(1.0, wrap=True)},
        "elastic": {"elastic": tribo.Elastic(1.0, 0.3)},
    }
    upper = tribo.Surface(
        "upper",
        bob=(0.3, 0.95),
        heights=np.random.default_rng(0).uniform(0.0, 0.05, side * side),
        drive=tribo.Pulled(stiffness=0.1, speed=0.1, load=0.03),
        **grid,
        **joined[kind],
    )
    lower = tribo.Surface("lower", facing="up", drive="bars", **grid)
    contact = tribo.LennardJones(0.05, 1.0).with_cutoff(2.5)
    periodic = tribo.Periodic(x=side, z=side)
    output = tribo.Output(samples=2, ledger="surfaces")
    return tribo.Scene((upper, lower), contact, steps * STEP, periodic=periodic, output=output)


def speed(bars):
    """Print the time of a step with springs and with an elastic body, and their ratio.

    The time of a few steps, with the first list of neighbours, is subtracted from that of many.
    """
    runs = {
        (kind, steps): tribo.prepare(
            sliding(bars, kind, steps), method="verlet", step=STEP, threads=1
        )
        for kind in ("springs", "elastic")
        for steps in (FEW, FEW + STEPS)
    }
    taken = {key: [] for key in runs}
    for _ in range(ROUNDS):
        for key, run in runs.items():
            began = time.process_time()
            run.run(estimate=False)
            taken[key].append(time.process_time() - began)
    springs, elastic = (
        (np.median(taken[kind, FEW + STEPS]) - np.median(taken[kind, FEW])) / STEPS
        for kind in ("springs", "elastic")
    )
    print(
        f"{bars} bars: a step takes {1e3 * springs:.3f} ms with springs, {1e3 * elastic:.3f} ms on "
        f"an elastic body; ratio {elastic / springs:.2f}",
        flush=True,
    )


def main():
    """Compare the contacts, or the speeds."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--side", type=int, default=SIDE, help="cells along each side")
    parser.add_argument("--speed", type=int, nargs="+", metavar="BARS", help="measure steps")
    options = parser.parse_args()
    if options.speed:
        for bars in options.speed:
            speed(bars)
    else:
        compare(options.side)


if __name__ == "__main__":
    main()
