"""Friction of a rough surface of 16 × 16 asperites grows with the load.

Springs pull the upper bars, each of which bears a load and carries a Drude bath.  The lower bars
are held, and reservoirs damp their swings.  The power law is a fit to one pair of surfaces, for
loads per asperite from 0.05 to 0.4 only.  Most of the work becomes heat.

B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840.
"""

import numpy as np
from matplotlib.figure import Figure

import tribo

LOADS, SPEED = np.array([0.05, 0.1, 0.2, 0.4]), 0.3
CONTACT = tribo.WeeksChandlerAndersen(epsilon=0.2, sigma=1.0)
GRID = {"shape": (16, 16), "spacing": (1.5, 1.5), "asperite": tribo.Asperite(kappa=4.0)}
BATH = tribo.Bath(spectrum=tribo.Spectrum("drude", gamma=1.0, cutoff=4.0, n=100))
PULLED = {"bob": (0.75, 2.0), "velocity": (SPEED, 0), "springs": {"stiffness": 5.0}, "bath": BATH}
HELD = {"drive": tribo.DrivenBars(), "langevin": tribo.Langevin(gamma=1.0, on="swing")}


def pull(load):
    """Run under a load on each asperite."""
    rough = [tribo.Roughness(rms=0.3, hurst=0.8, seed=seed) for seed in (1, 2)]
    drive = {"kind": "pulled", "stiffness": 2.0, "speed": SPEED, "load": load}
    upper = tribo.Surface("upper", heights=rough[0], drive=drive, **PULLED, **GRID)
    lower = tribo.Surface("lower", facing="up", heights=rough[1], **HELD, **GRID)
    output = tribo.Output(301, ledger="surfaces", series=("forces", "energies"))
    scene = tribo.Scene((upper, lower), CONTACT, 60.0, periodic={"x": 24, "z": 24}, output=output)
    return tribo.simulate(scene, method="verlet", step=0.02)


def main(folder="."):
    """The exponent of the power law, and the largest gap between work and energies."""
    results = [pull(load) for load in LOADS]
    force, error = np.abs([each.friction_force("upper", 20.0)[:2] for each in results]).T / 256
    exponent, logarithm = np.polyfit(np.log(LOADS), np.log(force), 1)
    upper, lower = results[-1]["upper"], results[-1]["lower"]
    contact = results[-1].system["contact_energy"]
    motion = sum(each.delta_K + each.delta_E_int for each in (upper, lower)) - upper.heat_bath
    parts = {"contact": contact, "motion": motion, "bath": upper.heat_bath, "swings": lower.heat}
    with tribo.plotting.style():
        figure = Figure(figsize=(tribo.plotting.PAGE, 2.5), layout="constrained")
        law, budget = figure.subplots(1, 2)
        law.errorbar(
            LOADS, force, error, fmt="o", ms=4, color=tribo.plotting.INK, label="simulation"
        )
        law.plot(LOADS, np.exp(logarithm) * LOADS**exponent, color="#d55e00", label="power law")
        law.set(
            xlabel="load per asperite",
            ylabel="friction per asperite",
            xlim=(0, None),
            ylim=(0, None),
        )
        law.legend()
        budget.stackplot(results[-1].t, *parts.values(), labels=parts)
        budget.plot(results[-1].t, upper.w2, color=tribo.plotting.INK, label="drive")
        budget.set(xlabel="$t$", ylabel="energy", xlim=(0, 60))
        budget.legend(loc="upper left", reverse=True)
    tribo.plotting.save(figure, f"{folder}/load_and_energy.png")
    gap = np.abs(upper.w2 - sum(parts.values())).max() / upper.w2[-1]
    return {"exponent": exponent, "largest gap / work, to 0.001": round(gap, 3)}


if __name__ == "__main__":
    print(main())
