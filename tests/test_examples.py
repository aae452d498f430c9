"""Every example runs, draws its figure, and gives the number that it is about."""

import pytest

from support.examples import FOLDER, example

EXAMPLES = sorted(path.stem for path in FOLDER.glob("*.py"))


def commensurate_rows(shown):
    """512 commensurate asperites have the friction of one each; 512 others, of one together."""
    one = shown["friction of one asperite"]
    assert shown["commensurate, per asperite of 512"] == pytest.approx(one, rel=0.01)
    assert shown["golden mean, whole row of 512"] == pytest.approx(1.05 * one, rel=0.02)


def heat_into_baths(shown):
    """The decay is that of the continuum, to 1 %, for as long as tribo says."""
    assert shown["largest error of 40 oscillators until then"] < 0.01
    assert shown["e_int with 160 oscillators at the end"] < 1e-6


def postcard(shown):
    """The energy balance is closed within the error estimates, and the card passes."""
    assert shown["largest gap of the energy balance"] <= shown["error estimates of both sides"]
    assert shown["checks that passed"] == shown["checks on the card"] >= 10


def rough_surface(shown):
    """The energy balance is closed, and most of the work is heat."""
    assert shown["largest gap of the balance / work"] < 1e-8
    assert shown["heat"] > 0.8 * shown["work"]


def stick_slip(shown):
    """The work of a slow pull is nearly zero below eta = 1, and that of the equilibria above."""
    assert shown["work in a period, eta = 0.7"] < 0.02
    expected = shown["the same by equilibria, eta = 4.0"]
    assert shown["work in a period, eta = 4.0"] == pytest.approx(expected, rel=0.02)


def thermal_friction(shown):
    """Friction decreases with temperature by more than the intervals of the means."""
    mean = [shown[f"friction at T = {t}"] for t in (0.01, 0.1, 0.3)]
    half = [shown[f"half-width at T = {t}"] for t in (0.01, 0.1, 0.3)]
    assert mean[0] - half[0] > mean[1] + half[1]
    assert mean[1] - half[1] > mean[2] + half[2] > 0.0


CHECKS = {
    check.__name__: check
    for check in (
        commensurate_rows,
        heat_into_baths,
        postcard,
        rough_surface,
        stick_slip,
        thermal_friction,
    )
}


# Examples that take five seconds or more, most of it to compile.
LONG = {"commensurate_rows", "postcard", "rough_surface", "stick_slip", "thermal_friction"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n in LONG else []) for n in EXAMPLES]
)
def test_example(name, tmp_path):
    shown = example(name).main(tmp_path)
    assert [path.suffix for path in tmp_path.iterdir()] == [".png"]
    CHECKS[name](shown)
