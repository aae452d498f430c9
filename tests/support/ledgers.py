"""Runs that keep the works of asperites, their sums, or none: what all keep has the same numbers.

Runs uncompiled, in a process of its own: `python -m support.ledgers` prints what is wrong.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import tribo
from tribo.ledger.reported import needs_accounts

# Largest difference of a sum that a run keeps from the sum of what another keeps: round-off.
ROUND_OFF = 2e-14
# Works from which a scene counts as one that has works to compare.
LEAST = 1e-3
STEPPED = {"step": 0.02}
# Methods in equal steps of all scenes; one that remembers its last step takes seven times as long.
METHODS = ("verlet", "midpoint")

CONTACT = tribo.Morse(0.4, 1.6, 0.7).with_cutoff(2.5)
OSCILLATORS = {"masses": np.full(3, 0.1), "frequencies": np.linspace(1.0, 3.0, 3)}
TORSIONAL = {"inertias": np.ones(2), "torsional_frequencies": np.ones(2)}
BATH = tribo.Bath(**OSCILLATORS)
FULL_BATH = tribo.Bath(**OSCILLATORS, **TORSIONAL)
FIELD = tribo.Field(tribo.Corrugation(0.2, 1.0), on=("upper", "lower"), velocity=(0.3, 0.0))


def asperites(count: int, seed: int, **given) -> tribo.Asperite:
    """Asperites with parameters of their own, which differ in the shape of their arms too."""
    rng = np.random.default_rng(seed)
    drawn = {name: rng.uniform(1.0, 2.5, count) for name in ("m1", "m2", "length", "kappa")}
    return tribo.Asperite(**drawn | given)


def rows(upper: dict, lower: dict, **scene) -> tribo.Scene:
    """Rows of 19 and of 10 asperites, none of which fill whole packs."""
    above = {"shape": (19, 1), "spacing": (1.1, 0.0), "asperite": asperites(19, 1)} | upper
    below = {"shape": (10, 1), "spacing": (1.1, 0.0), "asperite": asperites(10, 2)} | lower
    surfaces = (
        tribo.Surface("upper", bob=(0.3, 0.7), velocity=(0.5, 0.02), **above),
        tribo.Surface("lower", facing="up", **below),
    )
    return tribo.Scene(surfaces, scene.pop("potential", CONTACT), 0.1, **scene)


def turning(drive: object) -> dict:
    """Bars that are free, with all kinds of oscillators."""
    return {"bars": "free", "bath": FULL_BATH, "drive": drive}


ALIKE = {"asperite": tribo.Asperite(length=1.5)}
SCENES = {
    "forced": rows({}, {}),
    "arms alike": rows(ALIKE, ALIKE | {"drive": "free"}),
    "pulled and loaded": rows(
        {"drive": tribo.Pulled(stiffness=1.0, speed=0.2)},
        {"drive": tribo.Free(rigid=True, load=0.1)},
    ),
    "springs, baths and a moving field": rows(
        {"springs": tribo.Springs(2.0), "bath": BATH}, turning("free"), fields=[FIELD]
    ),
    "clamped bars that turn": rows({"initial": tribo.Initial(theta=0.2, nu=0.4)}, {}),
    "driven bars": rows(
        {"drive": "bars", "bath": BATH, "initial": tribo.Initial(theta=0.4, omega=0.3)},
        {"drive": "bars", "bars": "free"},
    ),
    "rigid asperites": rows(
        {"asperite": asperites(19, 1, kappa=np.inf), "drive": "free", "bath": BATH}, {}
    ),
}
NOISY = {
    "reservoirs": rows(
        {"drive": "bars", "langevin": tribo.Langevin(0.2, 0.3, on="swing")},
        {"asperite": asperites(10, 2, kappa=np.inf), "langevin": tribo.Langevin(0.1, 0.2)},
    ),
}


def run(scene: tribo.Scene, ledger: str, **how) -> tribo.Result:
    """A run that keeps some works."""
    return tribo.simulate(replace(scene, output=tribo.Output(samples=3, ledger=ledger)), **how)


def tables(result: tribo.Result) -> dict[str, np.ndarray]:
    """All series of a result, by surface and quantity."""
    found = {("", name): values for name, values in result.system.items()}
    for surface in result.ledger.surfaces:
        found |= {(surface, name): values for name, values in result[surface].items()}
    return found


def complaints(
    every: tribo.Result, sums: tribo.Result, none: tribo.Result, exact: bool = True
) -> Iterator[str]:
    """What is wrong with three runs of a scene, with the ledgers that their names say.

    Motions are the same to the last bit if `exact`: compilers order operations differently.
    """
    whole = tables(every)
    rounded = 0.0 if exact else ROUND_OFF
    if set(tables(sums)) != set(whole):
        yield "the sums are of other quantities"
    if set(tables(none)) != {key for key in whole if not needs_accounts(key[1])}:
        yield "without a ledger other quantities are missing than the works"
    for name, result in (("surfaces", sums), ("none", none)):
        for key, values in tables(result).items():
            is_sum = values.ndim < whole[key].ndim
            if is_sum != (result is sums and needs_accounts(key[1]) and whole[key].ndim == 2):
                yield f"{key} of {name} is a sum or not, as it should not be"
            expected = whole[key].sum(axis=1) if is_sum else whole[key]
            gap = np.max(np.abs(values - expected))
            if not gap <= (ROUND_OFF if needs_accounts(key[1]) else rounded):
                yield f"{key} of {name} differs by {gap:.1e}"
    if not max(np.max(np.abs(every[s].w1)) for s in every.ledger.surfaces) > LEAST:
        yield "there is no work"


def wrong_with(name: str, method: str) -> list[str]:
    """What is wrong with the runs of one scene."""
    scene = (SCENES | NOISY)[name]
    kinds = ("asperites", "surfaces", "none")
    return list(complaints(*(run(scene, kind, method=method, **STEPPED) for kind in kinds)))


def main() -> None:
    """Print what is wrong."""
    cases = [(name, method) for name in SCENES for method in METHODS]
    cases += [("pulled and loaded", "gauss-8"), *((name, "verlet") for name in NOISY)]
    for name, method in cases:
        for complaint in wrong_with(name, method):
            print(f"{name} by {method}: {complaint}")


if __name__ == "__main__":
    main()
