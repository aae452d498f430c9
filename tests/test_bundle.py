"""`tribo bundle`: what another person needs to check and to repeat a run is in one archive."""

import hashlib
import json
import subprocess
import sys
import tomllib
import zipfile

import pytest

from support.command import main

PLUGIN = """
from typing import NamedTuple

class Soft(NamedTuple):
    strength: float

    def energy(self, r):
        return self.strength / r
"""
SCENE = """
duration = 4.0
seed = 7
interaction = { potential = "soft.py:Soft", strength = 0.2 }
surface = [
    { name = "upper", bob = [-1.0, 0.5], velocity = [0.5, 0.0] },
    { name = "lower", facing = "up" },
]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A scene with a plug-in, and the result of its run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "soft.py").write_text(PLUGIN, encoding="utf-8")
    (tmp_path / "a scene.toml").write_text(SCENE, encoding="utf-8")
    assert main(["run", "a scene.toml", "--out", "run.nc", "--json"]) == 0
    return tmp_path


def test_what_an_archive_contains(folder):
    """Sums that other programs accept, the scene of the result, its plug-in, versions and seed."""
    assert main(["bundle", "a scene.toml", "run.nc", "-o", "all.zip"]) == 0
    first = (folder / "all.zip").read_bytes()
    with zipfile.ZipFile("all.zip") as archive:
        archive.extractall("unpacked")
    unpacked = folder / "unpacked"
    names = {path.name for path in unpacked.iterdir()}
    own = {"a scene.toml", "run.nc", "run.nc.toml", "soft.py"}
    assert names == {*own, "manifest.json", "SHA256SUMS"}
    for line in (unpacked / "SHA256SUMS").read_text(encoding="utf-8").splitlines():
        digest, name = line.split("  ")
        assert hashlib.sha256((unpacked / name).read_bytes()).hexdigest() == digest
    manifest = json.loads((unpacked / "manifest.json").read_text(encoding="utf-8"))
    assert set(manifest["files"]) == own
    about = manifest["files"]["run.nc"]
    assert (about["seed"], about["status"]) == (7, "completed")
    assert {"python", "tribo", "numba", "system"} <= manifest["made_with"].keys()
    assert main(["bundle", "a scene.toml", "run.nc", "-o", "all.zip"]) == 0
    assert (folder / "all.zip").read_bytes() == first  # no dates, no places
    subprocess.run(["python", "-m", "zipfile", "-t", "all.zip"], check=True, capture_output=True)
    assert main(["run", "unpacked/run.nc.toml", "--json"]) == 0


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (["missing.toml"], "missing.toml: cannot be read"),
        (["soft.py", "other/soft.py"], "would be a second soft.py in the archive; rename it"),
        (["soft.py", "Soft.py"], "differs from soft.py in case alone"),
        (["broken.nc"], "broken.nc: cannot be read: it is damaged"),
        (["manifest.json"], "would be a second manifest.json"),
    ],
)
def test_refused(files, message, tmp_path, monkeypatch, capsys):
    """Before anything is written."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    for name in ("soft.py", "Soft.py", "broken.nc", "manifest.json", "other/soft.py"):
        (tmp_path / name).write_text(name, encoding="utf-8")
    assert main(["bundle", *files, "-o", "all.zip"]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "all.zip").exists()


@pytest.mark.thorough
def test_an_archive_is_repeated_elsewhere(folder, capsys):
    """From the files in it: those of the author are gone, or have changed there."""
    (folder / "data.txt").write_text("1.0", encoding="utf-8")
    read = "FACTOR = float(Path(__file__).with_name('data.txt').read_text())\n\nclass"
    plugin = PLUGIN.replace("class", read, 1).replace("self.strength", "FACTOR * self.strength")
    (folder / "soft.py").write_text("from pathlib import Path\n" + plugin, encoding="utf-8")
    assert main(["run", "a scene.toml", "--out", "run.nc", "--json"]) == 0
    assert main(["bundle", "run.nc", "data.txt", "-o", "all.zip"]) == 0
    with zipfile.ZipFile("all.zip") as archive:
        archive.extractall("elsewhere")
    scene = tomllib.loads((folder / "elsewhere" / "run.nc.toml").read_text(encoding="utf-8"))
    assert scene["interaction"][0]["potential"] == "soft.py:Soft"
    capsys.readouterr()

    def repeated():
        code = main(["run", "elsewhere/run.nc", "--json"])
        return code, capsys.readouterr().err

    assert repeated() == (0, "elsewhere/run.nc: repeated, bit for bit\n")
    (folder / "soft.py").write_text(PLUGIN, encoding="utf-8")
    assert repeated() == (0, "elsewhere/run.nc: repeated, bit for bit\n")
    (folder / "soft.py").unlink()
    assert repeated() == (0, "elsewhere/run.nc: repeated, bit for bit\n")
    (folder / "elsewhere" / "data.txt").write_text("2.0", encoding="utf-8")
    # A module is loaded once in a process as long as its source is the same.
    for name in [name for name in sys.modules if name.startswith("tribo_plugin_")]:
        del sys.modules[name]
    code, message = repeated()
    assert code == 2 and "soft.py:Soft, or a value that it reads, has changed since" in message
