"""How often 95 % intervals of fitted parameters contain the true ones, for a synthetic AFM trace.

A tip that a spring pulls over a corrugation (Prandtl, Tomlinson) sticks and slips.  The lateral
force with independent noise is fitted for the amplitude of the corrugation and the stiffness of
the spring; each seed is another noise and another set of starts.

    python benchmarks/fit_coverage.py --seeds 100
    python benchmarks/fit_coverage.py --seeds 0 --figure docs/measured/fit.png
"""

import argparse
from dataclasses import replace

import numpy as np

import tribo
from tribo.model.parameters import with_values

TRUE = {"field.amplitude": 0.1, "upper.drive.stiffness": 0.5}
RANGES = {"field.amplitude": (0.06, 0.16), "upper.drive.stiffness": (0.3, 0.8)}
QUANTITY = "upper.pull_force"
# Times of the trace, four periods of stick and slip, and the noise, a thirtieth of the force.
TIMES = np.linspace(0.0, 60.0, 301)
NOISE = 0.02


def scene():
    """A damped tip in a corrugation, pulled by a spring."""
    surface = tribo.Surface(
        "upper",
        drive=tribo.Pulled(stiffness=0.4, speed=0.1),
        langevin=tribo.Langevin(2.0, 0.0),
        asperite=tribo.Asperite(kappa=100.0),
    )
    field = tribo.Field(tribo.Corrugation(0.08, 1.0), on=("upper",))
    return tribo.Scene((surface,), (), 60.0, fields=(field,))


def exact():
    """The force of the true scene, by an accuracy and not by the steps of the fit."""
    output = tribo.Output(times=TIMES[1:-1].tolist(), series=("forces",))
    true = replace(with_values(scene(), TRUE), output=output)
    return tribo.simulate(true, accuracy=1e-7)["upper"].pull_force


def fitted(force, seed, **settings):
    """The fit to the force with the noise of a seed."""
    noisy = force + np.random.default_rng(seed).normal(0.0, NOISE, TIMES.size)
    data = TIMES, noisy
    return tribo.fit(scene(), data, RANGES, QUANTITY, noise=NOISE, seed=seed, **settings)


def main():
    """Print each fit, and how many intervals contain the true values."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--figure", help="draw one fit to this file")
    options = parser.parse_args()
    force = exact()
    if options.figure:
        tribo.plotting.save(fitted(force, 1, profiles=False).plot(), options.figure)
    inside = dict.fromkeys(TRUE, 0)
    for seed in range(options.first, options.first + options.seeds):
        found = fitted(force, seed, profiles=False, starts=32)
        for key, true in TRUE.items():
            inside[key] += abs(found.values[key] - true) <= found.half_width[key]
        print(seed, found.values, found.half_width, f"{found.chi2:.1f}", found.notes, flush=True)
    print(inside, "of", options.seeds)


if __name__ == "__main__":
    main()
