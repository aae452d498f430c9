"""Work of forced drives at a temperature, where surfaces have unlike mass ratios."""

import re

import pytest

import tribo

# Masses of bars, whose bobs have a mass of 1.
LIGHT = 0.2
HEAVY = 5.0
SPEED = 0.05


def run(bars, temperature, drive="forced", keep=None):
    """One asperite slides over another and its images, slowly; reservoirs are on the swings."""
    upper, lower = (
        tribo.Surface(
            name,
            facing=facing,
            bob=(0.0, gap),
            velocity=(speed, 0.0),
            asperite=tribo.Asperite(m2=m2),
            drive=drive,
            langevin=tribo.Langevin(gamma=0.5, temperature=temperature, on="swing"),
        )
        for (name, facing, gap, speed), m2 in zip(
            (("upper", "down", 0.15, SPEED), ("lower", "up", 0.0, 0.0)), bars, strict=True
        )
    )
    contact = tribo.Gaussian(0.5, 0.3).with_cutoff(1.5)
    output = tribo.Output(samples=1001, keep=keep)
    scene = tribo.Scene((upper, lower), contact, 1000.0, periodic={"x": 3.0}, output=output)
    return tribo.simulate(scene, method="verlet", step=0.02)


def pumped(result):
    """The notes on heat that drives pump."""
    return [note for note in result.notes if "pump heat" in note]


@pytest.mark.parametrize("bars", [(LIGHT, HEAVY), (HEAVY, LIGHT)])
def test_pumped_heat_is_noted(bars):
    """With the works that follow from heats and energies, which the note does not use."""
    result = run(bars, temperature=1.0)
    (note,) = pumped(result)
    number = r"(-?[\d.e-]+)"
    words = (
        f"do {number} of work.*distance, {number}, .*m2\\), {number}, by {number} \\+- {number}:"
    )
    found = re.search(words, note)
    assert found is not None, note
    work, friction, part, excess, half_width = map(float, found.groups())
    parts = [m2 / (1.0 + m2) for m2 in bars]
    received = [
        float(result[name].delta_e_int[-1, 0] + result[name].heat[-1, 0])
        for name in ("upper", "lower")
    ]
    contact = result.system["contact_energy"]
    change = float(contact[-1] - contact[0])
    assert work == pytest.approx(sum(received) + change, rel=1e-3)
    weighted = sum(part * energy for part, energy in zip(parts, received, strict=True))
    assert friction == pytest.approx(weighted + change, rel=1e-2, abs=0.02)
    assert part == pytest.approx(min(parts), rel=1e-2)
    assert excess == pytest.approx(work - friction / min(parts), rel=1e-2)
    assert 0.0 < half_width < excess
    assert min(received) < 0.0 < max(received)  # one surface gives heat


def test_streamed_runs_are_noted_alike(monkeypatch):
    """The works are those of all samples, from portions of a few."""
    held = pumped(run((LIGHT, HEAVY), 1.0))
    monkeypatch.setattr("tribo.ledger.sinks.PORTION_BYTES", 20_000)
    assert pumped(run((LIGHT, HEAVY), 1.0, keep=["upper.W"])) == held


@pytest.mark.parametrize(
    ("bars", "temperature", "drive"),
    [
        ((LIGHT, HEAVY), 0.0, "forced"),
        ((2.0, 2.0), 1.0, "forced"),
        ((LIGHT, HEAVY), 1.0, "bars"),
    ],
)
def test_other_drives_pump_no_heat(bars, temperature, drive):
    """From rest, with like mass ratios, and on driven bars."""
    assert pumped(run(bars, temperature, drive)) == []


def test_work_of_forced_drives_from_rest():
    """Over friction times distance, the integral of the force, it lies between the 1 / lambda."""
    surfaces = [
        tribo.Surface(name, facing=facing, bob=bob, velocity=v, asperite=tribo.Asperite(m2=m2))
        for name, facing, bob, v, m2 in (
            ("upper", "down", (-10.0, 0.3), (0.5, 0.0), LIGHT),
            ("lower", "up", (0.0, 0.0), (0.0, 0.0), HEAVY),
        )
    ]
    output = tribo.Output(samples=4001, series=["forces"])
    scene = tribo.Scene(surfaces, tribo.Coulomb(0.2), 400.0, output=output)
    result = tribo.simulate(scene, accuracy=1e-8)
    force = result["upper"].friction_force
    t = result.t
    friction = -0.5 * float(((force[1:] + force[:-1]) / 2 * (t[1:] - t[:-1])).sum())
    work = sum(float(result[name].w2[-1, 0]) for name in ("upper", "lower"))
    contact = result.system["contact_energy"]
    change = float(contact[-1] - contact[0])
    ratio = (work - change) / (friction - change)
    assert (1.0 + HEAVY) / HEAVY < ratio < (1.0 + LIGHT) / LIGHT
