"""Quantities of the user's own, in runs, ensembles and sweeps."""

import re

import numpy as np
import pytest

import tribo
from support.registered import forgotten
from tribo import InputError

BAR = ["f2_x", "f2_y", "vx_cm", "vy_cm", "theta", "omega"]


def power(v):
    """f2 . (velocity of the bar)."""
    arm = v.parameter("l2") * v["omega"]
    vx = v["vx_cm"] - arm * np.cos(v["theta"])
    vy = v["vy_cm"] - arm * np.sin(v["theta"])
    return v["f2_x"] * vx + v["f2_y"] * vy


def torsion(v):
    """1/2 kappa theta^2 of all asperites, whose bars do not turn."""
    return 0.5 * np.sum(v.parameter("kappa") * v["theta"] ** 2, axis=1)


@pytest.fixture(autouse=True)
def own_quantities():
    """A quantity of each kind, for the time of a test."""
    with forgotten():
        how = {"of": "asperite", "uses": BAR, "long_name": "power of the drive"}
        tribo.Quantity("power", power, unit="power", **how)
        tribo.Quantity("torsion", torsion, unit="energy", of="surface", uses=["theta"])
        uses = ["contact_energy", "upper.W", "lower.W"]
        total = {"unit": "energy", "of": "system", "uses": uses}
        tribo.Quantity("sum_of_three", lambda v: sum(v[name] for name in uses), **total)
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
        (lambda v: v["theta"] / None, "mine: TypeError"),
    ],
)
def test_what_a_formula_does_wrong_is_told(formula, said):
    """When its series is first asked for."""
    tribo.Quantity("mine", formula, unit="angle", of="asperite", uses=["theta"])
    result = tribo.simulate(scene(5, ("own",)), method="rk4", step=0.05)
    with pytest.raises(InputError, match=re.escape(said)):
        _ = result["upper"]["mine"]
