"""Quantities of the user's own, in runs, ensembles and sweeps."""

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import tribo
from support.registered import forgotten
from tribo import InputError

BAR = ["f2_x", "f2_y", "vx_cm", "vy_cm", "theta", "omega"]
THREE = ["contact_energy", "upper.W", "lower.W"]
# Quantities with `uses`, and the same without.
PAIRS = {
    "upper.power": "upper.power_of_all",
    "upper.torsion": "upper.torsion_of_all",
    "upper.branching": "upper.branching_of_all",
    "sum_of_three": "sum_of_all",
}


def power(v):
    """f2 . (velocity of the bar)."""
    arm = v.parameter("l2") * v["omega"]
    vx = v["vx_cm"] - arm * np.cos(v["theta"])
    vy = v["vy_cm"] - arm * np.sin(v["theta"])
    return v["f2_x"] * vx + v["f2_y"] * vy


def branching(v):
    """y of the contact force where the bob is high, else x; a call with ones takes no y."""
    found = np.empty(len(v["y_bob"]))
    for row, height in enumerate(v["y_bob"][:, 0]):
        found[row] = (v["f1_y"] if height > 1.001 else v["f1_x"])[row, 0]
    return found


def torsion(v):
    """1/2 kappa theta^2 of all asperites, whose bars do not turn."""
    return 0.5 * np.sum(v.parameter("kappa") * v["theta"] ** 2, axis=1)


def total_of_three(v):
    """A sum of series of the system and of both surfaces."""
    return sum(v[name] for name in THREE)


@pytest.fixture(autouse=True)
def own_quantities():
    """A quantity of each kind, for the time of a test."""
    with forgotten():
        how = {"of": "asperite", "uses": BAR, "long_name": "power of the drive"}
        tribo.Quantity("power", power, unit="power", **how)
        tribo.Quantity("torsion", torsion, unit="energy", of="surface", uses=["theta"])
        total = {"unit": "energy", "of": "system", "uses": THREE}
        tribo.Quantity("sum_of_three", total_of_three, **total)
        # The same without `uses`, and a formula whose numbers decide what it takes.
        everything = {"unit": "power", "of": "asperite"}
        tribo.Quantity("power_of_all", power, **everything)
        tribo.Quantity("torsion_of_all", torsion, unit="energy", of="surface")
        tribo.Quantity("sum_of_all", total_of_three, unit="energy", of="system")
        force = {"unit": "force", "of": "surface"}
        tribo.Quantity("branching", branching, **force, uses=["y_bob", "f1_x", "f1_y"])
        tribo.Quantity("branching_of_all", branching, **force)
        yield


def scene(samples=401, series=("own", "forces"), keep=None) -> tribo.Scene:
    """A pair, whose upper asperite passes the lower one."""
    upper = tribo.Surface("upper", bob=(-3.0, 1.0), velocity=(0.5, 0.0))
    lower = tribo.Surface("lower", facing="up")
    output = tribo.Output(samples=samples, series=series, keep=keep)
    return tribo.Scene((upper, lower), tribo.Coulomb(0.2), 8.0, output=output)


def test_the_power_of_the_drive_is_the_rate_of_its_work(tmp_path):
    """By the trapezoidal rule; files keep it, with its unit and its meaning."""
    result = tribo.simulate(scene(), accuracy=1e-8)
    upper, t = result["upper"], result.t
    work = np.sum(0.5 * np.diff(t) * (upper["power"][1:, 0] + upper["power"][:-1, 0]))
    assert work == pytest.approx(upper.w2[-1, 0], rel=1e-3)
    result.save(tmp_path / "run.nc")
    again = tribo.load_result(tmp_path / "run.nc")
    assert np.array_equal(again["upper"]["power"], upper["power"])
    attributes = again.to_xarray()["upper.power"].attrs
    assert attributes["units"] == "energy time^-1"
    assert attributes["long_name"] == "power of the drive"


def test_quantities_of_a_surface_and_of_the_system():
    """Of the series that they use."""
    result = tribo.simulate(scene(5), accuracy=1e-6)
    upper = result["upper"]
    kappa = result.scene.surfaces[0].asperite.kappa
    assert np.array_equal(upper["torsion"], 0.5 * np.sum(kappa * upper.theta**2, axis=1))
    wholes = sum(result.ledger.blocks[name]["W"] for name in ("upper", "lower"))
    system = result.ledger.system
    assert np.allclose(system["sum_of_three"], system["contact_energy"] + wholes)
    assert "power" not in tribo.simulate(scene(5, ()), accuracy=1e-6)["upper"]


def test_a_run_keeps_it_alone():
    """By output.keep, with its error estimate unknown."""
    result = tribo.simulate(scene(5, ("own",), ["upper.torsion"]), accuracy=1e-6)
    assert [*result["upper"]] == ["torsion"]
    assert result.error_estimate.get("torsion") is None


def test_members_and_points_keep_it():
    """Each as its single run, with its own parameters."""
    kappas = [1.0, 2.0]
    keep, how = ["upper.torsion", "upper.power"], {"accuracy": 1e-7}
    vary = {"upper.asperite.kappa": kappas}
    plain = scene(5, ())
    members = tribo.ensemble(plain, 2, vary=vary, keep=keep, **how)
    points = tribo.sweep(plain, vary, keep=keep, **how)
    for k, kappa in enumerate(kappas):
        lower = scene(5).surfaces[1]
        stiff = tribo.Surface(
            "upper", bob=(-3.0, 1.0), velocity=(0.5, 0.0), asperite=tribo.Asperite(kappa=kappa)
        )
        alone = tribo.Scene((stiff, lower), tribo.Coulomb(0.2), 8.0, output=scene(5).output)
        run = tribo.simulate(alone, **how)["upper"]
        for data in (members, points):
            found = float(data["upper.torsion"].values[k].ravel()[-1])
            assert found == pytest.approx(run["torsion"][-1], abs=1e-6)
            found = float(data["upper.power"].values[k].ravel()[-1])
            assert found == pytest.approx(run["power"][-1, 0], abs=1e-6)


def test_without_uses_a_run_has_the_same_numbers(tmp_path):
    """In a run of all series, with output.keep, and read from files."""
    settings = {"method": "rk4", "step": 0.02}
    result = tribo.simulate(scene(41), **settings)
    series = result.ledger.flat()
    heights = result["upper"].y_bob
    assert np.any(heights < 1.001) and np.any(heights > 1.001)
    for keep in (None, [*PAIRS], [*PAIRS.values()], [*PAIRS, *PAIRS.values()]):
        run = tribo.simulate(scene(41, keep=keep), **settings)
        run.save(tmp_path / "run.nc")
        for found in (run.ledger.flat(), tribo.load_result(tmp_path / "run.nc").ledger.flat()):
            assert keep is None or {*found} == {*keep}
            for one, other in PAIRS.items():
                for name in found.keys() & {one, other}:
                    assert np.array_equal(found[name], series[one]), name


@pytest.mark.parametrize("at", ["end", "samples"])
def test_without_uses_members_and_points_have_the_same_numbers(tmp_path, at):
    """Whether such quantities are kept alone or beside others, in memory and in files."""
    plain = scene(9, ())
    vary = {"upper.asperite.kappa": [1.0, 2.0]}
    how = {"method": "rk4", "step": 0.02, "at": at}
    for many in (partial(tribo.ensemble, plain, 2, vary=vary), partial(tribo.sweep, plain, vary)):
        exact = many(keep=[*PAIRS], **how)
        out = tmp_path / f"{many.func.__name__}.nc"
        data = many(keep=[*PAIRS, *PAIRS.values()], out=out, **how)
        alone = many(keep=[*PAIRS.values()], **how)
        for one, other in PAIRS.items():
            assert np.all(np.isfinite(exact[one])) and np.ptp(exact[one].values) > 0.0
            for found in (data[one], data[other], alone[other]):
                assert np.array_equal(found, exact[one]), other


def test_it_is_reported_where_its_formula_takes_what_is_recorded():
    """With `uses` or without; `get` takes another value in place of what is not recorded."""
    tribo.Quantity("share", lambda v: v["e_pull"] / 2.0, unit="energy", of="surface")
    tribo.Quantity("zero", lambda v: v.get("e_pull", 0.0 * v["W"]), unit="energy", of="surface")
    plain = scene(5, ("own",))
    upper = replace(plain.surfaces[0], drive=tribo.Pulled(stiffness=0.5, speed=0.4))
    pulled = replace(plain, surfaces=(upper, plain.surfaces[1]))
    result = tribo.simulate(pulled, method="rk4", step=0.05)
    assert np.array_equal(result["upper"]["share"], result["upper"]["e_pull"] / 2.0)
    assert np.array_equal(result["upper"]["zero"], result["upper"]["e_pull"])
    assert "share" not in result["lower"] and not np.any(result["lower"]["zero"])
    assert not {"power", "power_of_all", "branching", "branching_of_all"} & {*result["upper"]}
    result.to_xarray()
    said = r'output.keep\[0\]: must be a quantity .*this one may need output.series = .*"own"'
    for name in ("power", "power_of_all"):
        kept = replace(plain, output=replace(plain.output, keep=[f"upper.{name}"]))
        with pytest.raises(InputError, match=said):
            tribo.simulate(kept, method="rk4", step=0.05)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"name": "w1"}, 'name: is that of a quantity of tribo, "w1"'),
        ({"name": "a b"}, "name: must be a word of letters"),
        ({"unit": "watt"}, 'unit: must be "angle" or "rate"'),
        ({"of": "bob"}, 'of: must be "asperite" or "surface" or "system"'),
        ({"uses": ["w3"]}, "uses[0]: must be the name of a quantity of tribo"),
        ({"uses": ["upper.w1"]}, 'uses[0]: must be as "w1"'),
        ({"uses": ["w1"], "of": "system"}, "uses[0]: must be one of the system"),
    ],
)
def test_what_is_no_quantity_is_refused(given, said):
    """By one sentence."""
    usual = {"name": "mine", "formula": torsion, "unit": "energy", "of": "surface"}
    with pytest.raises(InputError, match=re.escape(said)):
        tribo.Quantity(**usual | {"uses": ["theta"]} | given)


@pytest.mark.parametrize(
    ("formula", "said"),
    [
        (lambda v: np.cumsum(v["theta"], axis=0), "mine: must follow from the series at the same"),
        (lambda v: np.sum(v["theta"], axis=1), "mine: must be of the shape (5, 1), got (5,)"),
        (lambda v: v["omega"], "mine.omega: is not in uses"),
        (lambda v: v.get("omega"), "mine.omega: is not in uses"),
        (lambda v: v["theta"] / None, "mine: TypeError"),
    ],
)
def test_what_a_formula_does_wrong_is_told(formula, said):
    """When its series is first asked for."""
    tribo.Quantity("mine", formula, unit="angle", of="asperite", uses=["theta"])
    result = tribo.simulate(scene(5, ("own",)), method="rk4", step=0.05)
    with pytest.raises(InputError, match=re.escape(said)):
        _ = result["upper"]["mine"]


@pytest.mark.parametrize(
    ("formula", "of", "said"),
    [
        (lambda v: v["omga"], "asperite", "mine.omga: must be the name of a quantity of tribo"),
        (lambda v: v["power"], "asperite", "mine.power: must be the name of a quantity of tribo"),
        (lambda v: v["upper.W"], "surface", 'mine.upper.W: must be as "w1"'),
        (lambda v: v["W"], "system", 'mine.W: must be one of the system, or as "upper.W"'),
        (lambda v: v.parameter("kappa"), "system", "mine.parameter: cannot be taken of the system"),
        (
            lambda v: v["theta" if np.all(v["theta"] == 1.0) else "f1_x"],
            "asperite",
            'mine.f1_x: is not recorded; add "forces" to output.series, or take get(',
        ),
    ],
)
def test_what_a_formula_cannot_take_is_told(formula, of, said):
    """By its name, without `uses`."""
    tribo.Quantity("mine", formula, unit="angle", of=of)
    result = tribo.simulate(scene(5, ("own",)), method="rk4", step=0.05)
    with pytest.raises(InputError, match=re.escape(said)):
        _ = result.system["mine"] if of == "system" else result["upper"]["mine"]
