"""From which step or accuracy on each method passes the integral theorem.

    python benchmarks/theorem_tolerances.py

The mean of exp(-w / T) with a method is compared with that from the same starts by a splitting,
which keeps volume at any step: the difference is the error of the method, almost without noise.
"""

import warnings

import numpy as np
from direction_of_energy import keep_numbers

import tribo

MEMBERS, TEMPERATURE, SEED = 4096, 3.0, 1
STEPS = (0.1, 0.05, 0.025, 0.0125)
SETTINGS = [(name, {"step": step}) for name in ("midpoint", "rk4", "gauss-8") for step in STEPS]
SETTINGS += [
    (name, {"accuracy": accuracy})
    for name in ("midpoint", "rk4", "dop853", "rkn8", "rkn12", "gauss-radau-15")
    for accuracy in (0.1, 1e-2)
]


def scene() -> tribo.Scene:
    """Two asperites in contact from the start."""
    soft = tribo.Asperite(m1=0.7, m2=1.5, kappa=1.9, length=1.3)
    upper = tribo.Surface("upper", bob=(-1.0, 0.3), velocity=(0.7, 0.0), asperite=soft)
    lower = tribo.Surface("lower", facing="up", asperite=soft)
    output = tribo.Output(samples=2)
    return tribo.Scene((upper, lower), tribo.Gaussian(1.5, 0.5), 4.0, output=output)


def weights(method: str, **settings: float) -> np.ndarray:
    """exp(-w / T) of the members; NaN where a step would jump an encounter."""
    keep = ["upper.delta_e_int", "lower.delta_e_int"]
    starts = {"*.swing_state": tribo.Canonical(TEMPERATURE)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", tribo.TriboWarning)
        data = tribo.ensemble(
            scene(), MEMBERS, starts, seed=SEED, keep=keep, method=method, **settings
        )
    return np.exp(-sum(data[name].values[:, 0] for name in keep) / TEMPERATURE)


def main() -> None:
    """The miss of each setting, beside the standard error of the mean."""
    exact = weights("kahan-li-8", step=0.01)
    error = float(exact.std() / np.sqrt(MEMBERS))
    found = {"mean": float(exact.mean()), "standard_error": error, "members": MEMBERS}
    for method, setting in SETTINGS:
        kind, value = next(iter(setting.items()))
        try:
            own = weights(method, **setting)
        except tribo.InputError as refusal:
            found[f"{method}, {kind} {value:g}"] = str(refusal)
            continue
        good = np.isfinite(own)
        difference = own[good] - exact[good]
        found[f"{method}, {kind} {value:g}"] = {
            "miss": float(difference.mean()),
            "standard_error": float(difference.std() / np.sqrt(good.sum())),
            "members": int(good.sum()),
            "passes": bool(abs(own[good].mean() - 1.0) < 4.0 * own[good].std() / good.sum() ** 0.5),
        }
        print(method, setting, found[f"{method}, {kind} {value:g}"], flush=True)
    keep_numbers("tolerances", found)


if __name__ == "__main__":
    main()
