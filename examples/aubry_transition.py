"""A chain of atoms on a substrate that does not fit is pinned above a critical strength.

Atoms that are connected by springs k lie on a corrugation -A cos(2 pi x / a), at a mean distance of
g a with the golden mean g (Frenkel-Kontorova model).  Up to the critical strength

    K = 4 pi^2 A / (k a^2) = 0.971635

the chain slides without static friction; above it, the substrate pins the chain.  Rings of q atoms
on p periods approach the golden mean g = (sqrt(5) - 1) / 2 by p/q.  Greene's residue of a ring is
-det(H)/4, where H is the matrix of second derivatives of its energy at the minimum, in units of k.
As q grows, the magnitude of the residue vanishes below the transition and diverges above it; the
curves cross at the transition.

M. Peyrard, S. Aubry, J. Phys. C 16 (1983) 1593; J. M. Greene, J. Math. Phys. 20 (1979) 1183.
"""

import numpy as np

import tribo

# An odd q keeps the ring symmetric about an atom in a minimum, so that it relaxes without sliding.
FRACTIONS = ((8, 13), (13, 21), (34, 55))
# The stiffness of the springs and the period of the substrate are 1.
ATOM = tribo.Asperite(m1=0.5, m2=0.5, kappa=np.inf)


def residue(strength, p, q):
    """Magnitude of the residue of a ring that damping has brought to rest."""
    row = {"shape": (q, 1), "spacing": (p / q, 0.0), "springs": {"stiffness": 1.0, "wrap": True}}
    reservoir = tribo.Langevin(gamma=0.3)
    chain = tribo.Surface("chain", asperite=ATOM, drive=tribo.Free(), langevin=reservoir, **row)
    substrate = tribo.Field(tribo.Corrugation(strength / (4.0 * np.pi**2), 1.0), on=["chain"])
    scene = tribo.Scene([chain], [], 400.0, fields=[substrate], output=tribo.Output(samples=2))
    x = tribo.simulate(scene, method="verlet", step=0.1)["chain"].x_bob[-1]
    hessian = np.diag(2.0 + strength * np.cos(2.0 * np.pi * x))
    hessian -= np.roll(np.eye(q), 1, axis=0) + np.roll(np.eye(q), -1, axis=0)
    return np.linalg.det(hessian) / 4.0


def main(folder="."):
    """The strength at which the curves of the two longest rings cross."""
    strengths = np.linspace(0.86, 1.08, 12)
    residues = {q: np.array([residue(s, p, q) for s in strengths]) for p, q in FRACTIONS}
    critical = np.interp(0.0, np.log(residues[55] / residues[21]), strengths)
    with tribo.plotting.style():
        ax = tribo.plotting.axes(tribo.plotting.COLUMN, 2.5)
        for q, values in residues.items():
            ax.plot(strengths, values, label=f"{q} atoms")
        ax.axvline(0.971635, color="0.5", lw=0.7, ls=":")
        for x, word in ((0.94, "sliding"), (1.0, "pinned")):
            ax.text(x, 6e-4, word, ha="center", fontsize=7.5, color=tribo.plotting.INK)
        ax.set(xlabel="strength $K$", ylabel="magnitude of the residue", yscale="log")
        ax.legend()
    tribo.plotting.save(ax, f"{folder}/aubry_transition.png")
    return {"critical strength": critical}


if __name__ == "__main__":
    print(main())
