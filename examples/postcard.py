"""A class with parameters and an energy defines a user's own potential.

Here 64 bobs slide over 64 others with this potential, and the report card checks its force, its
smoothness and its limits.
"""

import numpy as np
from matplotlib.figure import Figure

import tribo


class Gauss(tribo.Potential):
    """U = h exp(-(r/w)^2/2)."""

    height: float  # [energy]
    width: float  # [length]

    def energy(self, r):
        """Energy at a distance r."""
        return self.height * np.exp(-0.5 * (r / self.width) ** 2)


def draw(potential, t, work, change, path):
    """Energy and force of the potential, and both sides of the energy balance."""
    r = np.linspace(0.0, 1.0, 200)
    force = -np.gradient(potential.energy(r), r, edge_order=2)
    with tribo.plotting.style():
        figure = Figure(figsize=(tribo.plotting.PAGE, 2.4), layout="constrained")
        law, balance = figure.subplots(1, 2)
        law.plot(r, potential.energy(r), label="energy")
        law.plot(r, force, label="force")
        law.set(xlabel="distance $r$", ylabel="energy, force")
        balance.plot(t, work, color=tribo.plotting.INK, label="work of the drives")
        balance.plot(t, change, "--", color="#d55e00", label="change of energy")
        balance.set(xlabel="$t$", ylabel="energy", ylim=(-1.0, 0.6))
        law.legend()
        balance.legend(loc="upper right")
    tribo.plotting.save(figure, path)


def main(folder=None):
    """Run the scene, check the potential, and draw both results in a folder."""
    mine = Gauss(height=0.05, width=0.2)
    row = {"shape": (64, 1), "spacing": (1.0, 0.0)}
    upper = tribo.Surface("upper", bob=(0.0, 0.3), velocity=(0.5, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    result = tribo.simulate(tribo.Scene((upper, lower), mine, duration=4.0), accuracy=1e-5)
    card, system = tribo.check(mine), result.system
    work, change = system["applied_work"], system["total_energy_change"]
    if folder is not None:
        draw(mine, result.t, work, change, f"{folder}/postcard.png")
    return {
        "work done by the drives": work[-1],
        "largest gap of the energy balance": np.max(np.abs(work - change)),
        "error estimates of both sides": result.error_estimate["applied_work"]
        + result.error_estimate["total_energy_change"],
        "checks on the card": len(card.checks),
        "checks that passed": sum(check.passed for check in card.checks),
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
