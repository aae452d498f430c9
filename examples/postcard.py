"""A user's own potential, from its definition to a result and a report card.

A class with parameters and an energy is all that is needed.  Here 64 bobs slide over 64 others with
this potential, and the report card checks its force, its smoothness and its limits.
"""

from pathlib import Path

import numpy as np

import tribo


class Gauss(tribo.Potential):
    """U = h exp(-(r/w)^2/2)."""

    height: float  # [energy]
    width: float  # [length]

    def energy(self, r):
        """Energy at a distance r."""
        return self.height * np.exp(-0.5 * (r / self.width) ** 2)


def main(folder=None):
    """Run the scene, check the potential, and save the figure of its card in a folder."""
    mine = Gauss(height=0.05, width=0.2)
    row = {"shape": (64, 1), "spacing": (1.0, 0.0)}
    upper = tribo.Surface("upper", bob=(0.0, 0.3), velocity=(0.5, 0.0), **row)
    lower = tribo.Surface("lower", facing="up", **row)
    result = tribo.simulate(tribo.Scene((upper, lower), mine, duration=4.0), accuracy=1e-5)
    card = tribo.check(mine)
    if folder is not None:
        card.save_figure(Path(folder) / "postcard.png")
    system = result.system
    gap = np.max(np.abs(system["applied_work"] - system["total_energy_change"]))
    return {
        "work done by the drives": system["applied_work"][-1],
        "largest gap of the energy balance": gap,
        "error estimates of both sides": result.error_estimate["applied_work"]
        + result.error_estimate["total_energy_change"],
        "checks on the card": len(card.checks),
        "checks that passed": sum(check.passed for check in card.checks),
    }


if __name__ == "__main__":
    for name, value in main(".").items():
        print(f"{name:40} {value:.6g}")
