"""By how much a damped step heats pendulums: <kappa twist^2> / T - 1, which should be zero.

1500 free bars with reservoirs carry pendulums, at the largest z = gamma h / M of a step h that
tribo accepts at a temperature.  w h is 0.1, so that the covariance of a harmonic step adds nothing.
Every number has the standard error over pendulums.

    python benchmarks/damped_swings.py      # 2 CPU minutes
"""

import math

import numpy as np

import tribo

PENDULUMS = 1500
ASPERITE = tribo.Asperite()
MASS = ASPERITE.m1 + ASPERITE.m2
INERTIA = ASPERITE.m1 * ASPERITE.m2 / MASS * ASPERITE.length**2
# Step [time], a tenth of a radian of the pendulum.
STEP = 0.1 / math.sqrt(ASPERITE.kappa / INERTIA)
# Damping of a step and temperature in units of kappa, at the limits of `tribo.loops.resolution`:
# 0.25 of z at any temperature, and 0.1 of z^2 T / kappa.
LIMITS = ((0.249, 3.0), (0.249, 10.0), (0.44, 0.5), (0.98, 0.104), (1.98, 0.025), (4.4, 0.005))
# Length of a run in units of the slowest time of its twist, of which the first tenth is left out.
TIMES, SAMPLES = 100, 401


def excess(z: float, temperature: float) -> tuple[float, float]:
    """The relative excess of the mean square of the twist, and its standard error."""
    gamma = z * MASS / STEP
    # A swing about a bar that strong friction holds decays as slowly as this.
    slowest = max(gamma * ASPERITE.length**2 / ASPERITE.kappa, MASS / gamma)
    surface = tribo.Surface(
        "bars",
        shape=(1, PENDULUMS),
        spacing=(0.0, 5.0),
        asperite=ASPERITE,
        drive=tribo.Free(load=0.0),
        initial=tribo.Initial(temperature=temperature * ASPERITE.kappa),
        langevin=tribo.Langevin(gamma, temperature * ASPERITE.kappa),
    )
    output = tribo.Output(samples=SAMPLES, ledger="none")
    scene = tribo.Scene([surface], [], TIMES * slowest, output=output)
    result = tribo.simulate(scene, method="verlet", step=STEP)
    assert result.status == "completed", result.status
    theta = result["bars"].theta[SAMPLES // 10 :]
    squares = np.mean(theta**2, axis=0) / temperature
    return float(squares.mean() - 1.0), float(squares.std() / math.sqrt(PENDULUMS))


def main() -> None:
    """Measure every limit."""
    for z, temperature in LIMITS:
        mean, error = excess(z, temperature)
        print(f"z {z:5.3f}, T/kappa {temperature:6.3f}: {100 * mean:+.2f} +- {100 * error:.2f} %")


if __name__ == "__main__":
    main()
