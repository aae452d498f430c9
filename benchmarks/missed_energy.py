"""Energy that no work accounts for in random scenes with noise, and with half and a quarter of the
step: for methods.md.

    python benchmarks/missed_energy.py            # 400 scenes, 2 CPU minutes

Rows, blocks and free surfaces with a reservoir slide over a row.  Steps are those that tribo finds
from the start of a run, given to it, so that no run is repeated.  The program prints quantiles of
the missed part of the energy that drives and reservoirs exchange, and the scenes that miss most.
"""

import argparse
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import tribo
from tribo.ledger.guards import missed_energy
from tribo.potentials import Gaussian, LennardJones, WeeksChandlerAndersen

POTENTIALS: dict[str, Callable[[float, Any], tribo.Potential]] = {
    "lennard-jones": lambda epsilon, random: LennardJones(epsilon, 1.0).with_cutoff(2.5),
    "cut in the core": lambda epsilon, random: LennardJones(epsilon, 1.0).with_cutoff(
        random.uniform(0.5, 0.9)
    ),
    "wca": lambda epsilon, random: WeeksChandlerAndersen(epsilon, 1.0),
    "morse": lambda epsilon, random: tribo.Morse(epsilon, random.uniform(2.0, 6.0), 1.0),
    "gaussian": lambda epsilon, random: Gaussian(epsilon, 0.5),
}
SHOWN = 10  # scenes that miss most


def drives(load: float) -> dict[str, Any]:
    """The drives of the upper surface."""
    return {
        "pulled": tribo.Pulled(stiffness=2.0, speed=0.1, load=load),
        "block": tribo.Pulled(stiffness=2.0, speed=0.1, load=load, block=True),
        "free": tribo.Free(),
    }


def scene(seed: int) -> tuple[str, tribo.Scene]:
    """A random scene, and what it is."""
    random = np.random.default_rng(seed)
    count = int(random.choice([1, 2, 4, 12]))
    name = str(random.choice(list(POTENTIALS)))
    epsilon = 10.0 ** random.uniform(-2.0, 0.0)
    temperature = epsilon * 10.0 ** random.uniform(-2.0, 0.3)
    drive = str(random.choice(["pulled", "block", "free"]))
    is_flexible = drive != "block" and random.random() < 0.6  # blocks with noise are rigid
    on = "swing" if is_flexible and random.random() < 0.3 else "bar"
    asperite = tribo.Asperite(kappa=10.0 ** random.uniform(-0.5, 1.5) if is_flexible else np.inf)
    gap = (0.3 if name == "gaussian" else 1.0) + random.uniform(0.1, 0.8)
    upper = tribo.Surface(
        "upper",
        bob=(0.3, gap),
        velocity=(random.uniform(0.0, 0.5), 0.0),
        shape=(count, 1),
        spacing=(1.4, 0.0),
        drive=drives(10.0 ** random.uniform(-2.5, 0.0))[drive],
        springs=tribo.Springs(5.0) if drive == "pulled" and count > 1 else None,
        langevin=tribo.Langevin(10.0 ** random.uniform(-1.5, 0.7), temperature, on=on),
        asperite=asperite,
    )
    lower = tribo.Surface(
        "lower",
        facing="up",
        bob=(-6.0, 0.0),
        shape=(int(random.choice([4, 12, 24])), 1),
        spacing=(1.5, 0.0),
        drive="bars",
        asperite=tribo.Asperite(kappa=np.inf),
    )
    duration = float(random.choice([10.0, 40.0, 100.0]))
    output = tribo.Output(samples=201)
    potential = POTENTIALS[name](epsilon, random)
    return f"{count} {drive}, {name}", tribo.Scene(
        [upper, lower], potential, duration, seed=seed, output=output
    )


def missed_part(given: tribo.Scene, step: float) -> float:
    """The part of the energy for which no work accounts; NaN of a run that does not complete."""
    simulation = tribo.prepare(given, method="verlet", step=step)
    result = simulation.run()
    if result.status != "completed":
        return np.nan
    missed, through = missed_energy(simulation.layout, result.ledger)
    return float(missed[0] / through[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("--scenes", type=int, default=400)
    count = parser.parse_args().scenes
    warnings.simplefilter("ignore", tribo.TriboWarning)
    rows = []
    for seed in range(count):
        name, given = scene(seed)
        step = tribo.explain(given).step
        parts = [missed_part(given, step / divisor) for divisor in (1.0, 2.0, 4.0)]
        rows.append((parts[0], f"{seed:4} {name:28}" + "".join(f"{part:10.2e}" for part in parts)))
    known = np.array([part for part, _ in rows if np.isfinite(part)])
    print(f"{known.size} of {count} scenes completed")
    for part in (0.5, 0.9, 0.95, 0.99, 1.0):
        print(f"{100.0 * part:3.0f} % miss less than {100.0 * np.quantile(known, part):.2g} %")
    rows = [row for row in rows if np.isfinite(row[0])]
    print("\nseed scene                       step  half of it   a quarter")
    for _, text in sorted(rows, reverse=True)[:SHOWN]:
        print(text)


if __name__ == "__main__":
    main()
