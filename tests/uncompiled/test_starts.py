"""What a scene is laid out as: starts, columns by slot, plug-ins, and what a drive is told."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import tribo
from support.everything import everything
from support.scene_tables import scene_from
from support.uncompiled.ledger import ALL, scene_of
from support.uncompiled.start import start_of
from tribo.kernels.equations_of_motion import place_bobs
from tribo.kernels.user_forces import set_customs
from tribo.layout.layout import lay_out
from tribo.ledger.motion import columns
from tribo.model.identity import plugins_of
from tribo.threads.writable_memory import own_model

CALLS: list[tuple[float, ...]] = []  # arguments with which a drive was called


class Recorder(NamedTuple):
    """A drive that records its arguments."""

    nothing: float = 0.0

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):
        """f2."""
        CALLS.append((t, x, y, vx, vy, fx, fy))
        return self.nothing, self.nothing


def test_arguments_of_a_drive():
    """A drive is told of place and velocity of the bar in the laboratory, and of f1."""
    table = ALL["slid"]
    t = 0.7
    scene = scene_from(table)
    drive = tribo.Custom(force=Recorder())
    layout = lay_out(replace(scene, surfaces=[replace(s, drive=drive) for s in scene.surfaces]))
    q, v = np.zeros((2, layout.room[0]))
    q[layout.places.q], v[layout.places.q] = np.split(layout.start, 2)
    model, _ = own_model(layout)
    place_bobs(model, t, q)
    count = layout.asperites.size
    fx = 1.0 + np.arange(count)
    fy = -2.0 - np.arange(count)
    model.f1[:, layout.places.columns] = fx, fy
    CALLS.clear()
    set_customs(model, model.drives, t, q, v)
    start = start_of(table)
    bar = start.bar + start.velocity * t
    expected = [np.full(count, t), *bar, *start.bar_velocity, fx, fy]
    names = ("t", "x", "y", "vx", "vy", "fx", "fy")
    for name, found, truth in zip(names, np.array(CALLS).T, expected, strict=True):
        assert np.allclose(found, truth, 0.0, 1e-13), name


@pytest.mark.parametrize(
    ("slots", "absent", "expected"),
    [
        ([2, -1, 0], 5.0, [[2.0, 5.0, 0.0], [5.0, 5.0, 3.0]]),
        ([-1, 1, -1], [[7.0, 8.0, 9.0]], [[7.0, 1.0, 9.0], [7.0, 4.0, 9.0]]),
        ([1, 2, 0], 5.0, [[1.0, 2.0, 0.0], [4.0, 5.0, 3.0]]),
        ([-1, -1, -1], [[7.0, 8.0, 9.0]], [[7.0, 8.0, 9.0], [7.0, 8.0, 9.0]]),
    ],
)
def test_columns_by_slot(slots, absent, expected):
    """The columns of a table in some slots, and another value where a slot is absent."""
    table = np.arange(6.0).reshape(2, 3)
    found = columns(np.array(slots), table, np.array(absent))
    assert np.array_equal(found, expected)


CONTACT = {"potential": "coulomb", "strength": 0.1}
FREE = {"kind": "free", "load": 0.1}
ROW = {"name": "upper", "shape": [3, 1], "spacing": [1.0, 0.0]}


def layout_of(upper):
    """The layout of a surface above another one."""
    lower = {"name": "lower", "facing": "up", "bob": [0.0, -3.0]}
    table = {"duration": 1.0, "interaction": CONTACT, "surface": [ROW | upper, lower]}
    return lay_out(scene_from(table))


def test_given_starts():
    """Displacements and velocities that are given are those of each centre of mass."""
    given = {"x": [0.1, 0.2, 0.3], "y": 0.4, "vx": 0.5, "vy": [0.6, 0.7, 0.8]}
    layout = layout_of({"initial": given, "drive": FREE})
    q, v = np.split(layout.start, 2)
    for name, value in given.items():
        slots = layout.asperites[f"dof_{name[-1]}"][:3]
        found = (v if name.startswith("v") else q)[slots]
        assert np.array_equal(found, np.broadcast_to(value, 3)), name


SHIFT = {"x": [0.1, 0.2, 0.4], "y": [-0.3, 0.5, 0.7]}


@pytest.mark.parametrize(
    ("drive", "given"), [(FREE, SHIFT), ({"kind": "forced"}, {}), ("bars", {})]
)
def test_cold_baths(drive, given):
    """Oscillators of a bath at temperature 0 start where their bars are."""
    swing = 0.3
    rod = {"m1": 0.6, "m2": 1.2, "length": 1.4}
    l2 = rod["length"] * rod["m1"] / (rod["m1"] + rod["m2"])
    bath = {"oscillators": [{"mass": 0.2, "frequency": 1.5}, {"mass": 0.1, "frequency": 2.0}]}
    initial = {"theta": swing} | given
    layout = layout_of({"asperite": rod, "drive": drive, "initial": initial, "bath": bath})
    q, _ = np.split(layout.start, 2)
    first = layout.asperites.dof_bath[:3]
    moved = {"x": -l2 * np.sin(swing), "y": -l2 * (1.0 - np.cos(swing))}
    for axis, name in enumerate("xy"):
        held = drive == "bars"  # in place, whatever the swing
        bars = np.broadcast_to(given.get(name, 0.0), 3) + (0.0 if held else moved[name])
        for oscillator in range(2):
            assert np.allclose(q[first + 2 * axis + oscillator], bars, 0.0, 1e-14), name


CONTACTS = [f"interaction[{k}].potential" for k in range(3)]


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("by hand", [CONTACTS[0], "surface[0].drive", "surface[1].bars"]),
        ("waves", [CONTACTS[0], "field[0].kind"]),
        ("rows", CONTACTS),
    ],
)
def test_named_plugins(name, fields):
    """Every plug-in of a scene goes with the field that it is in."""
    layout = lay_out(scene_of(ALL[name]))
    found = plugins_of(layout.scene)
    assert [field for field, _ in found] == fields
    assert {id(plugin) for _, plugin in found} == {id(plugin) for plugin in layout.plugins}


BATH = tribo.Bath((0.1, 0.2), (1.3, 2.0), inertias=(0.3,), torsional_frequencies=(1.5,))


def test_further_series():
    """The sum of all forces changes the momentum, that of all energies with the total energy."""
    scene = everything(0.4)
    push = tribo.Pushed(force=(0.4, -0.2), rate=(0.5, 0.7))
    upper, lower = scene.surfaces
    surfaces = (replace(upper, bath=BATH), replace(lower, drive=push, velocity=(0.0, 0.3)))
    output = tribo.Output(samples=41, series=("forces", "energies", "oscillators"))
    scene = replace(scene, surfaces=surfaces, output=output)
    result = tribo.simulate(scene, method="verlet", step=0.01)
    total = result.system["contact_energy"] + result.system["field_energy"]
    for surface, masses in zip(surfaces, (np.array([3.0, 3.5]), 3.0), strict=True):
        table = result[surface.name]
        for axis in "xy":
            keys = [k for k in table if k.startswith("f") and k.endswith(f"_{axis}")]
            force = sum(table[k] for k in keys)
            velocity = table[f"v{axis}_cm"]
            # By Simpson's rule over 20 panels of 0.02.
            impulse = np.sum(force[:-2:2] + 4.0 * force[1:-1:2] + force[2::2], axis=0) / 300.0
            gained = masses * (velocity[-1] - velocity[0])
            assert np.max(np.abs(gained - impulse)) <= 1e-4, f"{surface.name}: {axis}"
        for key, values in table.items():
            # The springs of stages are not part of the system.
            if key.startswith(("k_", "e_")) and key != "e_pull":
                total = total + (values if values.ndim == 1 else values.sum(axis=1))
        assert np.all(table.k_bath > 0.0)
        assert np.all(table.e_bath >= -1e-15)
        stiffness = surface.bath.masses * surface.bath.frequencies**2
        force = np.einsum("m,tamx->xta", stiffness, result.oscillators(surface.name))
        assert np.max(np.abs(force - [table.f_bath_x, table.f_bath_y])) <= 1e-12
    # Both torsional oscillators turn with their bars at the start.
    heat = result["upper"].k_bath[0] + result["upper"].e_bath[0]
    assert heat == pytest.approx(0.5 * 2.0 * 0.3 * 0.4**2, abs=1e-12)
    gained = result.system["total_energy_change"]
    assert np.max(np.abs(total - total[0] - gained)) <= 1e-12
    plain = replace(scene, duration=0.01, output=tribo.Output(samples=2))
    assert tribo.simulate(plain, method="verlet", step=0.01).ledger.oscillators == {}
