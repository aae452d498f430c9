"""A rigid row of atoms loses its static friction if its spacing does not fit the substrate.

The forces of a substrate of period a on N atoms with spacing s add up to at most

    F_N = F_1 |sin(pi N s / a) / sin(pi s / a)| .

If the spacing fits, F_N is N F_1.  With a misfit s/a - 1 of 1/N, as many atoms climb as descend,
and the static friction vanishes.  Here rows move at constant speed, and the static friction is the
largest force of the substrate.

M. Hirano, K. Shinjo, Phys. Rev. B 41 (1990) 11837; M. Dienwiebel et al., Phys. Rev. Lett. 92 (2004)
126101.
"""

import numpy as np

import tribo

# Atoms in a row, and amplitude of the substrate [energy], whose period is 1.
N, AMPLITUDE = 40, 0.1
MISFITS = np.concatenate([[0.0, 0.5], np.linspace(0.1, 3.0, 30)]) / N


def static_friction():
    """Largest force on each row, relative to that on N atoms that fit."""
    rows = [
        tribo.Surface(
            f"row {k}",
            shape=(N, 1),
            spacing=(1.0 + misfit, 0.0),
            velocity=(1.0, 0.0),
            drive=tribo.DrivenBars(),
            asperite=tribo.Asperite(kappa=np.inf),
        )
        for k, misfit in enumerate(MISFITS)
    ]
    substrate = tribo.Field(tribo.Corrugation(AMPLITUDE, 1.0), on=[row.name for row in rows])
    output = tribo.Output(samples=401, series=("forces",))
    scene = tribo.Scene(rows, [], 1.0, fields=[substrate], output=output)
    result = tribo.simulate(scene, method="verlet", step=0.01)
    forces = [result[row.name].f_field_x.sum(axis=1) for row in rows]
    return np.max(np.abs(forces), axis=1) / (N * 2.0 * np.pi * AMPLITUDE)


def main(folder="."):
    """Static friction with a spacing that fits, and with half the misfit that cancels it."""
    found = static_friction()
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.4)
        misfit = np.linspace(0.0, 3.0, 500) / N
        closed_form = np.abs(np.sinc(N * misfit) / np.sinc(misfit))
        ax.plot(N * misfit, closed_form, color="#d55e00", label="closed form")
        ax.plot(N * MISFITS, found, "o", ms=3, color=tribo.plotting.INK, label="simulation")
        ax.set(xlabel="misfit $N (s - a) / a$", ylabel="static friction $F_N / (N F_1)$")
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/structural_lubricity.png")
    return {"friction with a spacing that fits": found[0], "with a misfit of 1/(2N)": found[1]}


if __name__ == "__main__":
    print(main())
