"""Parameters of asperites that are drawn, or read from columns of files."""

import tomllib

import numpy as np
import pytest

import tribo
from support.scene_tables import scene_from
from tribo.model import drawn


def surface(name="upper", **asperite):
    return tribo.Surface(name, shape=(400, 1), spacing=(1.0, 0.0), asperite=asperite)


def test_distributions():
    kappa = surface(kappa={"normal": [2.0, 0.2]}).asperite.kappa
    assert np.mean(kappa) == pytest.approx(2.0, abs=0.04)
    assert np.std(kappa) == pytest.approx(0.2, abs=0.03)
    assert np.array_equal(kappa, surface(kappa={"normal": [2.0, 0.2]}).asperite.kappa)
    m1 = surface(m1={"lognormal": [1.5, 0.5], "seed": 3}).asperite.m1
    assert np.median(m1) == pytest.approx(1.5, abs=0.15)
    charge = surface(charge={"uniform": [-1.0, 1.0]}).asperite.charge
    assert -1.0 <= np.min(charge) < -0.9 and 0.9 < np.max(charge) <= 1.0


def test_independent():
    """Parameters, surfaces and seeds have draws of their own."""
    table = {"normal": [2.0, 0.2]}
    both = surface(kappa=table, m1=table).asperite
    draws = [both.kappa, both.m1, surface("lower", kappa=table).asperite.kappa]
    draws.append(surface(kappa=table | {"seed": 1}).asperite.kappa)
    correlations = np.corrcoef(draws) - np.eye(4)
    assert np.max(np.abs(correlations)) < 0.2


def test_file():
    """A file of the scene has the numbers."""
    scene = tribo.Scene([surface(kappa={"normal": [2.0, 0.2]})], [], duration=1.0)
    again = scene_from(tomllib.loads(scene.to_toml()))
    assert again == scene
    table = {"duration": 1.0, "surface": [{"name": "upper", "shape": [400, 1]}]}
    table["surface"][0] |= {"spacing": [1.0, 0.0], "asperite": {"kappa": {"normal": [2.0, 0.2]}}}
    assert scene_from(table) == scene


def test_columns(tmp_path):
    (tmp_path / "row.csv").write_text("height, charge\n0.1, 1.0\n-0.2, 2.0\n0.3, -1.5\n")
    (tmp_path / "plain.txt").write_text("# strengths\n1.0\n2.0\n-1.5\n")
    (tmp_path / "scene.toml").write_text(
        """
duration = 1.0
[[surface]]
name = "one"
shape = [3, 1]
spacing = [1.0, 0.0]
heights = {file = "row.csv", column = "height"}
asperite = {charge = {file = "row.csv", column = 2}}
[[surface]]
name = "other"
shape = [3, 1]
spacing = [1.0, 0.0]
asperite = {charge = {file = "plain.txt"}}
"""
    )
    one, other = tribo.load_scene(tmp_path / "scene.toml").surfaces
    assert one.heights.tolist() == [0.1, -0.2, 0.3]
    assert one.asperite.charge.tolist() == other.asperite.charge.tolist() == [1.0, 2.0, -1.5]


@pytest.mark.parametrize(
    "text",
    [
        "0,1\n0,2\n",
        "a,b\n0,01\n0,02\n",
        "a,b\n0,1,\n0,2,\n",
        "0.5,1\n1,2\n",
        "0, 1\n0, 2\n",
        "on,n\nbob 1,1\nbob 2,2\n",
    ],
)
def test_commas_that_separate_columns(text, tmp_path):
    """Between whole numbers, too, where no other separator or heading tells of decimals."""
    (tmp_path / "row.csv").write_text(text)
    assert drawn.column({"file": "row.csv", "column": 2}, tmp_path) == [1.0, 2.0]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"normal": [2.0]}, r"asperite.kappa.normal: must be \[mean, standard deviation\]"),
        ({"normal": [2.0, -1.0]}, r"normal\[1\]: must not be negative"),
        ({"normal": [0.1, 3.0]}, r"asperite.kappa\[\d+\]: must not be negative"),
        ({"lognormal": [-1.0, 0.1]}, "must be positive"),
        ({"uniform": [2.0, 1.0]}, "must be .low, high."),
        ({"gauss": [2.0, 1.0]}, "not a known key"),
        ({"normal": [2.0, 1.0], "uniform": [1.0, 2.0]}, "must be one of"),
        ({"file": "nowhere.csv"}, "nowhere.csv"),
    ],
)
def test_refused(table, message):
    with pytest.raises(tribo.InputError, match=message):
        surface(kappa=table)


def test_refused_columns(tmp_path):
    path = tmp_path / "row.csv"
    for text, column, message in (
        ("a, b\n1, 2\n", None, "column: is missing; the file has 2 columns"),
        ("a, b\n1, 2\n", "c", 'must be "a" or "b"'),
        ("a\n1\nx\n", None, "row 2 must have a number, got 'x'"),
        ("a\n1\n2\n", None, "size 400, got size 2"),
        ("", None, "has no rows"),
        ("0,1\n0,2\n", None, "column: is missing; the file has 2 columns: the first row is 0, 1"),
        ("0,8;10,5\n1,2;3,5\n", 1, "got a decimal comma in the line '0,8;10,5'; write 0.5 for"),
        ("a b\n0,8 10,5\n", 2, "got a decimal comma in the line '0,8 10,5'"),
        ("height\n0,8\n1,2\n", 1, "decimal comma"),
        ("0,8\n1\n1,2\n", 1, "decimal comma"),
        ("0,8\n1,05\n", 1, "got a decimal comma in the line '1,05'"),
        ("a,b\n0,8,1,5\n", 1, "got 2 headings and 4 columns"),
        ("\0\1", None, r"file: must be a text file .*\{topography = "),
    ):
        path.write_text(text)
        table = {"file": str(path)} | ({} if column is None else {"column": column})
        with pytest.raises(tribo.InputError, match=message):
            surface(charge=table)
