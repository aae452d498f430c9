"""ASE calculators as the contact between surfaces."""

import numpy as np
import pytest
from ase import Atoms
from ase.calculators.calculator import Calculator, all_changes
from ase.calculators.emt import EMT
from ase.calculators.lj import LennardJones as LennardJonesOfASE

import tribo
from tribo.potentials import from_calculator

EPSILON = 0.3
SIGMA = 1.1


def scene(potential, **settings) -> tribo.Scene:
    """A short row of copper dragged over another."""
    common = {"shape": (2, 1), "spacing": (2.6, 0.0), "species": "Cu"}
    upper = tribo.Surface("upper", bob=(-2.0, 2.3), velocity=(0.6, 0.0), **common)
    lower = tribo.Surface("lower", facing="up", **common)
    settings = {"duration": 2.0, "output": tribo.Output(samples=5)} | settings
    return tribo.Scene([upper, lower], potential, **settings)


def same(one: tribo.Result, other: tribo.Result, bound: float) -> None:
    """All works and angles agree within the bound, relative to the largest work."""
    for surface in ("upper", "lower"):
        for name in ("theta", "w1", "w2", "w", "delta_e_int"):
            assert np.max(np.abs(one[surface][name] - other[surface][name])) <= bound, name
    assert np.allclose(one.system["contact_energy"], other.system["contact_energy"], atol=bound)


@pytest.mark.slow
def test_a_pairwise_calculator_is_its_potential():
    """ASE's Lennard-Jones between surfaces, cutoff far away, is tribo's own."""
    calculator = LennardJonesOfASE(epsilon=EPSILON, sigma=SIGMA, rc=1e4)
    end = 4.0 * EPSILON * ((SIGMA / 1e4) ** 12 - (SIGMA / 1e4) ** 6)
    assert abs(end) < 1e-20  # ASE shifts its energies by this
    ours = tribo.simulate(scene(tribo.LennardJones(EPSILON, SIGMA)), accuracy=1e-9)
    theirs = tribo.simulate(scene(from_calculator(calculator)), accuracy=1e-9)
    assert theirs.met
    same(ours, theirs, 1e-8)


def test_many_body_terms_are_between_surfaces():
    """The contact energy of an EMT scene is E(all) - E(upper) - E(lower), at every sample."""
    result = tribo.simulate(scene(from_calculator(EMT())), method="verlet", step=0.02)
    assert result.status == "completed"
    for k in range(result.t.size):
        groups = [
            np.column_stack([result[s].x_bob[k], result[s].y_bob[k], np.zeros(2)])
            for s in ("upper", "lower")
        ]
        energies = []
        for places in (np.vstack(groups), *groups):
            atoms = Atoms(["Cu"] * len(places), places)
            atoms.calc = EMT()
            energies.append(atoms.get_potential_energy())
        expected = energies[0] - energies[1] - energies[2]
        assert result.system["contact_energy"][k] == pytest.approx(expected, abs=1e-10)
    change = result.system["total_energy_change"] - result.system["applied_work"]
    assert np.max(np.abs(change)) < 1e-3 * np.max(np.abs(result["upper"].w1))


def test_periodic_images():
    """In a period of z the calculator sees the images: a bob at z = 0 meets one at z = 5.5."""
    period = tribo.Periodic(z=6.0)
    upper = tribo.Surface("upper", bob=(-1.0, 0.0), velocity=(0.5, 0.0), species="Ar")
    lower = tribo.Surface("lower", facing="up", depth=5.0, species="Ar")
    calculator = LennardJonesOfASE(epsilon=EPSILON, sigma=SIGMA, rc=2.9, smooth=True, ro=2.5)
    common = {"duration": 1.0, "periodic": period, "output": tribo.Output(samples=3)}
    wrapped = tribo.Scene([upper, lower], from_calculator(calculator, reach=2.9), **common)
    result = tribo.simulate(wrapped, method="verlet", step=0.05)
    near = tribo.Surface("lower", facing="up", depth=-1.0, species="Ar")
    common.pop("periodic")
    plain = tribo.simulate(
        tribo.Scene([upper, near], from_calculator(calculator), **common),
        method="verlet",
        step=0.05,
    )
    assert np.max(np.abs(plain["upper"].w1)) > 1e-3
    same(result, plain, 1e-12)


class Failing(Calculator):
    """Raises an error, or a Ctrl-C, at its nth call."""

    implemented_properties = ["energy", "forces"]  # noqa: RUF012

    def __init__(self, left: int, error: type[BaseException]) -> None:
        super().__init__()
        self.left = left
        self.kind = error

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
        """No force at all, until it fails once."""
        super().calculate(atoms, properties, system_changes)
        self.left -= 1
        if self.left == 0 or (self.left < 0 and self.kind is OSError):
            raise self.kind("the disk is full")
        self.results = {"energy": 0.0, "forces": np.zeros((len(atoms), 3))}


def test_a_calculator_that_fails_stops_the_run_by_name():
    """What was reached is kept, and the note says what was raised."""
    with pytest.warns(tribo.TriboWarning, match="CalculatorFailed"):
        result = tribo.simulate(scene(from_calculator(Failing(100, OSError))), accuracy=1e-9)
    assert result.status == "CalculatorFailed"
    assert any("OSError: the disk is full" in note for note in result.notes)
    assert np.all(np.isfinite(result["upper"].theta))


def test_ctrl_c_inside_a_calculator_keeps_the_state_whole():
    """The call is made again, and the run stops after it."""
    failing = scene(from_calculator(Failing(20, KeyboardInterrupt)))
    with pytest.raises(KeyboardInterrupt) as caught:
        tribo.simulate(failing, method="verlet", step=0.02)
    result = caught.value.result
    assert result.status == "Interrupted"
    assert np.all(np.isfinite(result["upper"].theta))


def test_in_a_scene_file(tmp_path):
    """The calculator is made again from its class and arguments."""
    before = scene(
        from_calculator("ase.calculators.lj:LennardJones", epsilon=EPSILON, sigma=SIGMA, rc=1e4)
    )
    before.save(tmp_path / "scene.toml")
    after = tribo.load_scene(tmp_path / "scene.toml")
    one, other = (tribo.simulate(item, method="verlet", step=0.05) for item in (before, after))
    same(one, other, 0.0)


@pytest.mark.parametrize(
    ("potential", "change", "says"),
    [
        (
            lambda: from_calculator("ase.calculators.emt:NoSuch"),
            {},
            "calculator: ase.calculators.emt:NoSuch",
        ),
        (lambda: from_calculator(3.0), {}, "calculator: must be a calculator of ASE, got 3.0"),
        (lambda: from_calculator(EMT(), reach=-1.0), {}, "reach: must be positive"),
        (
            lambda: from_calculator(EMT()),
            {"periodic": tribo.Periodic(x=9.0)},
            "cutoff: must be at most half",
        ),
        (
            lambda: tribo.Interaction(from_calculator(EMT()), species=("Cu", "Cu")),
            {},
            "species: cannot go",
        ),
    ],
)
def test_refusals(potential, change, says):
    """The message names the field."""
    with pytest.raises(tribo.InputError, match=says):
        tribo.simulate(scene(potential(), **change), method="verlet", step=0.1)


def test_species_must_be_elements():
    """A calculator needs the species of the bobs."""
    bare = [tribo.Surface("upper", bob=(0.0, 2.0)), tribo.Surface("lower", facing="up")]
    with pytest.raises(tribo.InputError, match="needs elements as the species of bobs"):
        tribo.simulate(tribo.Scene(bare, from_calculator(EMT()), 1.0), method="verlet", step=0.1)
