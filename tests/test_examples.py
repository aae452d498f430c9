"""Every example runs, draws its picture, and shows the one number that it is about."""

import pytest

from support.examples import FOLDER, example

EXAMPLES = sorted(path.stem for path in FOLDER.glob("*.py"))


def commensurate_rows(shown):
    """512 that fit have the friction of one each; 512 that do not, of one together."""
    one = shown["friction of one asperite"]
    assert shown["commensurate, of each of 512"] == pytest.approx(one, rel=0.01)
    assert shown["the same, all 512 together"] == pytest.approx(1.05 * one, rel=0.02)


def heat_into_baths(shown):
    """The continuum's decay, within 1 % for as long as is claimed."""
    assert shown["their largest distance until then"] < 0.01
    assert shown["e_int with 160 oscillators at the end"] < 1e-6


def postcard(shown):
    """The books close within the error bars, and the card passes."""
    assert shown["largest gap in the budget"] <= shown["what it may be by the error bars"]
    assert shown["of which passed"] == shown["checks on the card"] >= 10


def rough_surface(shown):
    """Nothing is lost."""
    assert shown["largest gap in the budget / work"] < 1e-8
    assert shown["heat"] > 0.8 * shown["work put in"]


def stick_slip(shown):
    """Below eta = 1 a slow pull costs next to nothing, above what the statics say."""
    assert shown["work in a period, eta = 0.7"] < 0.02
    statics = shown["the same by statics, eta = 4.0"]
    assert shown["work in a period, eta = 4.0"] == pytest.approx(statics, rel=0.02)


def thermal_friction(shown):
    """The warmer the less, by more than the means are uncertain."""
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


LONG = {"commensurate_rows", "stick_slip"}  # about a minute each


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n in LONG else []) for n in EXAMPLES]
)
def test_example(name, tmp_path):
    shown = example(name).main(tmp_path)
    assert [path.suffix for path in tmp_path.iterdir()] == [".png"]
    CHECKS[name](shown)
