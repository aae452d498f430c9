"""Every example runs, draws its figure, and gives numbers that theory or a publication gives."""

import importlib.util
import json

import numpy as np
import pytest
from scipy.special import i0

from support.examples import FOLDER, example

EXAMPLES = sorted(path.stem for path in FOLDER.glob("*.py"))
GALLERY = FOLDER.parent / "docs" / "gallery"


def aubry_transition(shown):
    """The critical strength for the golden mean; J. M. Greene, J. Math. Phys. 20 (1979) 1183."""
    assert shown["critical strength"] == pytest.approx(0.971635, rel=0.002)


def commensurate_rows(shown):
    """256 asperites that fit have the friction of one each; 256 others, that of a rigid row."""
    golden_mean = (1.0 + np.sqrt(5.0)) / 2.0
    rigid = abs(np.sin(256.0 * np.pi * golden_mean) / np.sin(np.pi * golden_mean))
    assert shown["F_N / F_1 of 256 that fit"] == pytest.approx(1.0, rel=0.01)
    assert shown["N F_N / F_1 of 256"] == pytest.approx(rigid, rel=0.02)


def depinning(shown):
    """v = sqrt(F^2 - F_c^2) / gamma is 3/4 at F = 5/4 F_c."""
    assert shown["velocity at 0.9 F_c"] == 0.0
    assert shown["velocity at 1.25 F_c"] == pytest.approx(0.75, rel=0.01)


def diffusion(shown):
    """D gamma / T = 1 / I_0(A / T)^2, within three standard errors of the variance."""
    expected = 1.0 / i0(1.0) ** 2
    assert shown["D gamma / T at A / T = 1"] == pytest.approx(expected, rel=0.12)
    shift = abs(shown["D gamma / T at A / T = 2"] - 1.0 / i0(2.0) ** 2)
    assert shift < 1.5 * shown["half-width at A / T = 2"] < 0.04


def free_block(shown):
    """The loss of speed to lowest order in the corrugation."""
    expected = shown["speed lost by the closed form"]
    assert shown["speed lost"] == pytest.approx(expected, rel=0.04)


def friction_loop(shown):
    """A slow pull slips at F_c = A q, both ways, and the energy budget closes."""
    assert shown["largest force / F_c"] == pytest.approx(1.0, abs=0.02)
    assert shown["smallest force / F_c"] == pytest.approx(-1.0, abs=0.02)
    assert shown["largest gap of the energy"] == 0.0


def friction_against_load(shown):
    """Hard spheres: tan(asin(1/4)) = 1 / sqrt(15)."""
    assert shown["friction / load"] == pytest.approx(15.0**-0.5, rel=0.01)


def heat_into_baths(shown):
    """The decay is that of the continuum, to 1 %, for as long as tribo says."""
    assert shown["40 oscillators act as a continuum until t"] > 50.0
    assert shown["largest error of 40 until then"] < 0.01


def load_and_energy(shown):
    """Amontons' law within the intervals; the budget is closed to the error of verlet's step."""
    assert shown["exponent"] == pytest.approx(1.0, abs=0.1)
    assert shown["largest gap / work, to 0.001"] == 0.0


def friction_against_speed(shown):
    """Friction by Kramers' rate, within 6 % at every speed: the error of the mean of 40 tips."""
    assert len(shown) == 4
    assert list(shown.values()) == pytest.approx([1.0] * 4, rel=0.06)


def measured_block(shown):
    """Balances of force and of energy, within thermal noise and the errors of samples and steps."""
    assert shown["mean normal force / load"] == pytest.approx(1.0, rel=0.02)
    assert shown["(friction + drag) / pull"] == pytest.approx(1.0, rel=0.03)
    assert shown["area of the loop / work of the stage"] == pytest.approx(1.0, rel=2e-3)
    assert shown["gap of the energy / work of the stage"] < 1e-3


def postcard(shown):
    """The energy balance is closed within the error estimates, and the card passes."""
    assert shown["largest gap of the energy balance"] <= shown["error estimates of both sides"]
    assert shown["checks that passed"] == shown["checks on the card"] >= 9


def rough_grid(shown):
    """The share in contact of Greenwood and Williamson; twice the load takes 1.7 times as many."""
    assert shown["share in contact / theory"] == pytest.approx(1.0, rel=0.15)
    assert 1.6 < shown["share in contact, load doubled / single"] < 2.0


def rough_surface(shown):
    """The energy balance is closed, and most of the work is heat."""
    assert shown["largest gap / work"] < 1e-8
    assert 0.8 < shown["heat / work"] < 1.0


def squeezed_layers(shown):
    """Layers break at the closed form's loads; a load that grows is late, most at the weakest."""
    assert len(shown) == 3
    late = [value - 1.0 for value in shown.values()]
    assert 0.06 > late[0] > late[1] > late[2] > 0.0


def stick_slip(shown):
    """The work of a slow pull is nearly zero below eta = 1, and that of the equilibria above."""
    assert abs(shown["work for eta = 0.7"]) < 2e-3
    assert shown["work / jump for eta = 4"] == pytest.approx(1.0, rel=0.02)


def structural_lubricity(shown):
    """|F_N| / (N F_1) = sinc(1/2) / sinc(1/(2N)) for a misfit of 1/(2N), N = 40."""
    assert shown["friction with a spacing that fits"] == pytest.approx(1.0, rel=1e-3)
    expected = np.sinc(0.5) / np.sinc(0.5 / 40.0)
    assert shown["with a misfit of 1/(2N)"] == pytest.approx(expected, rel=1e-3)


def thermal_friction(shown):
    """Friction decreases with temperature by more than the intervals of the means."""
    mean = [shown[f"friction at T = {t}"] for t in (0.01, 0.1, 0.3)]
    half = [shown[f"half-width at T = {t}"] for t in (0.01, 0.1, 0.3)]
    assert mean[0] - half[0] > mean[1] + half[1]
    assert mean[1] - half[1] > mean[2] + half[2] > 0.0


def time_reversal(shown):
    """The internal energy of 0.520 that the paper prints is gone after the reversed run."""
    assert shown["internal energy after the pass"] == pytest.approx(0.520, abs=5e-4)
    assert abs(shown["internal energy at the end"]) < 1e-9
    assert abs(shown["angle at the end"]) < 1e-9


def two_frames(shown):
    """All observers find the internal energy that the paper prints, and different works."""
    assert shown["internal energy"] == pytest.approx(0.520, abs=5e-4)
    assert shown["its range over observers"] < 1e-9
    assert shown["range of the work of the contact"] > 1.0


def washboard_resonance(shown):
    """The peak to lowest order in the corrugation."""
    assert shown["friction / closed form at the resonance"] == pytest.approx(1.0, rel=0.01)


CHECKS = {name: globals()[name] for name in EXAMPLES}

# Examples that take more than five seconds of CPU time, most of it to compile a loop that no other
# test of the default set needs.
LONG = {
    *("aubry_transition", "commensurate_rows", "free_block", "friction_against_load"),
    *("load_and_energy", "measured_block", "postcard"),
    *("rough_surface", "stick_slip", "structural_lubricity", "thermal_friction"),
    "washboard_resonance",
}

# Examples whose motion is chaotic, so that averages differ by this ratio from machine to machine.
CHAOTIC = {"load_and_energy": 0.1, "measured_block": 0.05}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n in LONG else []) for n in EXAMPLES]
)
def test_example(name, tmp_path):
    """Its numbers are those of theory, and those that the gallery shows."""
    if name == "measured_block":
        pytest.importorskip("SurfaceTopography")
    shown = {key: float(value) for key, value in example(name).main(tmp_path).items()}
    assert [path.name for path in tmp_path.iterdir()] == [f"{name}.png"]
    CHECKS[name](shown)
    stored = json.loads((GALLERY / "numbers.json").read_text(encoding="utf-8"))[name]
    assert shown == pytest.approx(stored, rel=CHAOTIC.get(name, 1e-2), abs=1e-7)


@pytest.mark.parametrize("name", EXAMPLES)
def test_length(name):
    """An example is less than 75 lines long."""
    assert len((FOLDER / f"{name}.py").read_text(encoding="utf-8").splitlines()) < 75


def test_gallery(monkeypatch):
    """The pages have every example, its explanation, its numbers and its picture."""
    monkeypatch.syspath_prepend(GALLERY)
    spec = importlib.util.spec_from_file_location("draw", GALLERY / "draw.py")
    draw = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(draw)
    numbers = json.loads(draw.NUMBERS.read_text(encoding="utf-8"))
    assert sorted(numbers) == EXAMPLES
    pages = draw.pages(numbers)
    assert sorted({*pages} - {"index"}) == EXAMPLES
    for name, text in pages.items():
        assert (GALLERY / f"{name}.md").read_text(encoding="utf-8") == text, f"{name}: draw.py"
    for name, shown in numbers.items():
        for value, (reference, _) in zip(shown.values(), draw.REFERENCES[name], strict=True):
            if reference:
                expected = float(reference.split()[0])
                assert value == pytest.approx(expected, rel=0.15, abs=2e-3), name
    assert [path.stem for path in sorted(GALLERY.glob("*.png"))] == EXAMPLES
