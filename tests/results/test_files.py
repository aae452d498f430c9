"""Result files and journals: complete or not at all, and never other numbers."""

import argparse
import errno
import io
import lzma
import os
import random
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import h5py
import pytest
import xarray

import tribo
from support.command import main
from support.continued import chain, pair, same_end
from tribo import Coulomb, InputError, Output, Scene, Surface, seals
from tribo.commands import bundle
from tribo.layout import contacts
from tribo.loops import frames, integrate
from tribo.results import result_file

# The ends of the pair in golden.nc.
GOLDEN = {"theta": -0.3516559610861557, "W": 0.1245543644459436}
SLOWLY = 3  # steps of a chunk: small enough for many checkpoints


class Killed(BaseException):
    """The process ends here."""


@pytest.fixture
def often(monkeypatch):
    """A checkpoint after every chunk of a few steps; neighbour lists for few bobs too."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)
    monkeypatch.setattr(frames, "INTERVAL", -1.0)
    monkeypatch.setattr(frames, "RELATIVE_INTERVAL", 0.0)
    monkeypatch.setattr(integrate, "FIRST_CHUNK", SLOWLY)
    monkeypatch.setattr(integrate, "LARGEST_CHUNK", SLOWLY)


def killer(after):
    """A function that kills the process after so many calls."""
    calls = []

    def kill(*arguments):
        calls.append(arguments)
        if len(calls) > after:
            raise Killed

    return kill


HOW = {  # scene, and how it is run
    "noise": (chain(), {"method": "verlet", "step": 0.02}),
    "pair": (pair(), {"accuracy": 1e-6}),
}


@pytest.mark.parametrize("name", [*HOW, "state"])
def test_resumed_after_kills(often, tmp_path, name):
    """Killed again and again, a run ends with the bits of one that was not."""
    scene, how = HOW.get(name, HOW["pair"])
    if name == "state":  # by the general loop of a method with memory
        how = how | {"start": tribo.simulate(pair(4.0), **how).state()}
    out = tmp_path / "run.nc"
    whole = tribo.simulate(scene, **how)
    kills = 0
    while True:
        try:
            found = tribo.simulate(scene, **how, out=out, resume=True, progress=killer(kills + 2))
            break
        except Killed:
            kills += 1
            assert not out.exists() and (tmp_path / "run.nc.part").exists()
            for file in (out, tmp_path / "run.nc.part"):
                with pytest.raises(tribo.InputError, match="completes the file with --resume"):
                    tribo.load_result(file)
    assert kills >= 4
    assert same_end(whole, found) and found.error_estimate == whole.error_estimate
    assert not (tmp_path / "run.nc.part").exists()
    again = tribo.simulate(scene, **how, out=out, resume=True, progress=killer(0))
    assert same_end(whole, again) and found.cost == again.cost


def test_killed_while_it_saves(monkeypatch, tmp_path):
    """Wherever a save ends, an earlier file is whole, and the run resumes."""
    out = tmp_path / "run.nc"
    kinds = {"accuracy": 1e-6}
    whole = tribo.simulate(pair(), **kinds, out=out)
    for name in ("fsync", "replace"):
        original = getattr(os, name)
        before = out.read_bytes()
        for after in range(0, 20, 4):
            kill = killer(after)
            with monkeypatch.context() as patch:
                patch.setattr(os, name, lambda *a, do=original, kill=kill: (kill(), do(*a)))
                try:
                    tribo.simulate(pair(), **kinds, out=out)
                    break
                except Killed:
                    assert out.read_bytes() == before
            found = tribo.simulate(pair(), **kinds, out=out, resume=True)
            assert same_end(whole, found)
            before = out.read_bytes()
        assert after >= (8 if name == "fsync" else 4)


def test_full_disk(monkeypatch, tmp_path):
    """One sentence; an earlier file is whole, and the run resumes when there is room."""

    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    out = tmp_path / "run.nc"
    whole = tribo.simulate(pair(), accuracy=1e-6)
    before = b"an earlier file"
    out.write_bytes(before)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        for write in (lambda path: tribo.simulate(pair(), accuracy=1e-6, out=path), whole.save):
            with pytest.raises(InputError, match=r"cannot be written \(No space left on device\)"):
                write(out)
            assert out.read_bytes() == before
    assert same_end(whole, tribo.simulate(pair(), accuracy=1e-6, out=out, resume=True))


def test_damaged_result(tmp_path):
    """Any change of a value is refused in one sentence; a byte without meaning leaves a note."""
    path = tmp_path / "run.nc"
    whole = tribo.simulate(pair(), accuracy=1e-4, out=path)
    content = path.read_bytes()
    read = 0
    rng = random.Random(1)
    for trial in range(134):
        damaged = bytearray(content)
        if trial % 4 == 0:
            damaged = damaged[: rng.randrange(len(content))]
        elif trial % 4 == 1:
            start = rng.randrange(len(content))
            damaged[start : start + 100] = rng.randbytes(100)
        else:
            damaged[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
        path.write_bytes(damaged)
        try:
            found = tribo.load_result(path)
        except InputError as error:
            assert re.search(r"cannot be read: .* is damaged, or the file is no result", str(error))
        else:
            assert same_end(whole, found) and found.notes == (*whole.notes, result_file.REWRITTEN)
            read += 1
    assert read < 40
    path.write_bytes(content)
    assert tribo.load_result(path).status == "completed"


def test_a_damaged_file_that_hangs_its_reader(tmp_path):
    """A byte of a file of version 0.2 was changed, in which HDF5 runs without end."""
    packed = Path(__file__).with_name("hangs_when_read.nc.xz").read_bytes()
    (tmp_path / "run.nc").write_bytes(lzma.decompress(packed))
    began = time.process_time()
    for read in (tribo.load_result, bundled):
        with pytest.raises(InputError, match="cannot be read: it is damaged"):
            read(tmp_path / "run.nc")
    assert time.process_time() - began < 1.0  # the other process has its own time


def bundled(path):
    options = argparse.Namespace(files=[path], out=path.with_suffix(".zip"))
    return bundle.run_bundle(options)


def test_damage_is_found_before_a_library_reads(tmp_path, monkeypatch):
    """Any change of a byte before the end is told from the bytes alone."""
    path = tmp_path / "run.nc"
    tribo.simulate(pair(), accuracy=1e-4, out=path)
    content = path.read_bytes()
    monkeypatch.setattr(h5py, "File", None)
    monkeypatch.setattr(xarray, "load_dataset", None)
    monkeypatch.setattr(seals, "check_readable", None)
    rng = random.Random(2)
    for trial in range(500):
        at = rng.randrange(len(content) - seals.SEAL.size)
        damaged = bytearray(content)
        if trial % 2:
            damaged[at] ^= 1 << rng.randrange(8)
        else:
            damaged[at:at] = rng.randbytes(rng.randrange(1, 100))
        with pytest.raises(InputError, match="cannot be read: it is damaged"):
            seals.is_sealed(io.BytesIO(damaged), str(path))
    assert seals.is_sealed(io.BytesIO(content), str(path))


@pytest.mark.thorough
def test_threads_save_and_load_side_by_side(tmp_path):
    """The NetCDF library is not made for threads: without a lock the process crashes."""
    result = tribo.simulate(pair(), accuracy=1e-4)

    def again(name):
        for _ in range(2):
            result.save(tmp_path / name)
            if not same_end(result, tribo.load_result(tmp_path / name)):
                return False
        return True

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(again, [f"{k}.nc" for k in range(4)]))


def named(name):
    surfaces = (Surface(name, bob=(-1.0, 0.0)), Surface("lower", facing="up"))
    return Scene(surfaces, Coulomb(0.2), 1.0, output=Output(samples=3))


@pytest.mark.filterwarnings("error")
def test_series_keep_their_order(tmp_path):
    """In files of results and of ensembles, as every other program reads them."""
    scene = replace(tribo.paper.scene("A"), duration=1.0)
    result = tribo.simulate(scene, accuracy=1e-6)
    result.save(tmp_path / "run.nc")
    loaded = tribo.load_result(tmp_path / "run.nc")
    assert list(loaded["upper"]) == list(result["upper"])
    assert list(loaded.to_pandas()) == list(result.to_pandas())
    with xarray.open_dataset(tmp_path / "run.nc") as data:
        assert [name for name in data if name in result.to_xarray()] == list(result.to_xarray())
    keep = ["upper.w2", "upper.w1", "upper.W"]
    swings = {"upper.swing": [0.0, 0.1]}
    members = tribo.ensemble(scene, 2, swings, keep=keep, out=tmp_path / "members.nc")
    with xarray.open_dataset(tmp_path / "members.nc") as data:
        assert list(data) == list(members)


def test_names_of_surfaces(tmp_path):
    """Series of a surface "state" are kept apart from the state; names are names in NetCDF too."""
    for name in ("state", "my tip"):
        result = tribo.simulate(named(name), accuracy=1e-4)
        result.save(tmp_path / "run.nc")
        found = tribo.load_result(tmp_path / "run.nc")
        assert same_end(result, found) and found.notes == result.notes
        state = result.state().arrays()
        other = found.state().arrays()
        assert state.keys() == other.keys()
        if shutil.which("ncdump"):
            subprocess.run(["ncdump", "-h", tmp_path / "run.nc"], check=True, capture_output=True)
    for name in (" tip", "tip "):
        with pytest.raises(InputError, match=r"name: must be a word .* without blanks at its ends"):
            named(name)


def touched(source, target):
    """A copy of a file to which an attribute was added that is not there any more."""
    target.write_bytes(source.read_bytes())
    with h5py.File(target, "r+") as file:
        file.attrs["mine"] = "x" * 100
    with h5py.File(target, "r+") as file:
        del file.attrs["mine"]


def by_program(name, *options):
    """What copies a file by a program of netCDF or HDF5, where that is installed."""

    def rewrite(source, target):
        if shutil.which(name) is None:
            pytest.skip(f"needs {name}")
        subprocess.run([name, *options, source, target], check=True)

    return rewrite


def written_by_xarray(source, target):
    """A file that xarray has read and written, with the variables compressed."""
    data = xarray.load_dataset(source)
    packed = {name: {"zlib": True} for name, each in data.variables.items() if each.ndim}
    data.to_netcdf(target, encoding=packed)


REWRITE = {
    "touched": touched,
    "xarray": written_by_xarray,
    "nccopy": by_program("nccopy", "-d1"),
    "h5repack": by_program("h5repack", "-f", "GZIP=1"),
}


@pytest.mark.parametrize("program", REWRITE)
def test_written_again(program, tmp_path):
    """The same values in other bytes are read with a note; another value or unit is refused."""
    rewrite = REWRITE[program]
    first = tmp_path / "run.nc"
    second = tmp_path / "again.nc"
    whole = tribo.simulate(pair(), accuracy=1e-4, out=first)
    rewrite(first, second)
    assert first.read_bytes() != second.read_bytes()
    found = tribo.load_result(second)
    assert same_end(whole, found) and found.error_estimate == whole.error_estimate
    assert found.notes == (*whole.notes, result_file.REWRITTEN)
    assert tribo.load_result(first).notes == whole.notes
    for change, name in (
        (lambda file: file["upper.theta"].__setitem__((-1, 0), 0.1), "upper.theta"),
        (lambda file: file["upper.w1"].attrs.__setitem__("units", "J"), "upper.w1"),
        (lambda file: file.attrs.__setitem__("method", "verlet"), "its description"),
        (lambda file: file.__delitem__("upper.w1"), "its description"),
        (lambda file: file["state.y"].__setitem__(0, 0.3), "state.y"),
    ):
        rewrite(first, second)
        with h5py.File(second, "r+") as file:
            change(file)
        with pytest.raises(InputError, match=f"cannot be read: {name} is damaged"):
            tribo.load_result(second)


def test_golden_file():
    """A file that this version has written, for all later ones; its run has the same numbers."""
    result = tribo.load_result(Path(__file__).parent / "golden.nc")
    assert result.status == "completed" and list(result.t) == [0.0, 1.0, 2.0]
    assert result_file.REWRITTEN not in result.notes
    assert result["upper"].theta[-1, 0] == pytest.approx(GOLDEN["theta"], abs=1e-12)
    assert result["upper"].W[-1] == pytest.approx(GOLDEN["W"], abs=1e-12)
    again = tribo.simulate(result.scene)
    assert again["upper"].theta[-1, 0] == pytest.approx(GOLDEN["theta"], abs=1e-7)


@pytest.mark.thorough
def test_journal_without_replaced_frames(often, monkeypatch, tmp_path):
    """A journal that has grown is written again, and resumes as before."""
    monkeypatch.setattr(frames, "MOST_REPLACED", 0)
    scene, how = HOW["noise"]
    out = tmp_path / "run.nc"
    part = tmp_path / "run.nc.part"
    with pytest.raises(Killed):
        tribo.simulate(scene, **how, out=out, progress=killer(40))
    smaller = part.stat().st_size
    found = tribo.simulate(scene, **how, out=out, resume=True)
    assert same_end(tribo.simulate(scene, **how), found)
    monkeypatch.setattr(frames, "MOST_REPLACED", 2**60)
    with pytest.raises(Killed):
        tribo.simulate(scene, **how, out=out, progress=killer(40))
    assert smaller < 0.2 * part.stat().st_size


def test_full_disk_when_a_journal_is_written_again(often, monkeypatch, tmp_path):
    """One sentence; the journal stays as it was, nothing else is left, and the run resumes."""
    monkeypatch.setattr(frames, "MOST_REPLACED", 0)
    scene, how = HOW["noise"]
    out = tmp_path / "run.nc"
    part = tmp_path / "run.nc.part"

    def full(source, target):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        with pytest.raises(InputError, match=r"cannot be written \(No space left on device\)"):
            tribo.simulate(scene, **how, out=out)
    assert [path.name for path in tmp_path.iterdir()] == [part.name]
    found = tribo.simulate(scene, **how, out=out, resume=True)
    assert same_end(tribo.simulate(scene, **how), found)


def test_another_run_is_refused(often, monkeypatch, tmp_path):
    """By name, from the journal and from the complete file; both stay as they were."""
    out = tmp_path / "run.nc"
    part = tmp_path / "run.nc.part"
    with pytest.raises(Killed):
        tribo.simulate(pair(), accuracy=1e-6, out=out, progress=killer(5))
    for path in (part, out):
        before = path.read_bytes()
        for scene, accuracy, problem in (
            (pair(9.0), 1e-6, r"scene.duration was 8.0, is 9.0"),
            (replace(pair(), interactions=Coulomb(0.3)), 1e-6, r"\[0\].strength was 0.2, is 0.3"),
            (pair(), 1e-5, r"settings.accuracy was 1e-06, is 1e-05"),
        ):
            with pytest.raises(InputError, match=f"is of another run: .*{problem}"):
                tribo.simulate(scene, accuracy=accuracy, out=out, resume=True)
        with monkeypatch.context() as patch:
            patch.setattr("tribo.simulation.version", lambda: "0.0.1")
            with pytest.raises(InputError, match=r"version was .*, is '0.0.1'"):
                tribo.simulate(pair(), accuracy=1e-6, out=out, resume=True)
        assert path.read_bytes() == before
        tribo.simulate(pair(), accuracy=1e-6, out=out, resume=True)
    assert not part.exists()


def test_two_writers(often, tmp_path):
    """The journal is of one process alone."""
    out = tmp_path / "run.nc"

    def another(t):
        with pytest.raises(InputError, match="is being written by another process"):
            tribo.simulate(pair(), accuracy=1e-6, out=out)

    tribo.simulate(pair(), accuracy=1e-6, out=out, progress=another)


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX's links and pipes")
def test_links_pipes_and_devices(tmp_path):
    """A link is followed; what is no file is refused before the run."""
    (tmp_path / "link.nc").symlink_to("real.nc")
    tribo.simulate(pair(), accuracy=1e-4, out=tmp_path / "link.nc")
    assert (tmp_path / "link.nc").is_symlink() and (tmp_path / "real.nc").is_file()
    os.mkfifo(tmp_path / "pipe")
    for path, problem in (
        (tmp_path / "pipe", "must be a regular file, got the pipe or device"),
        ("/dev/null", "must be a regular file, got the pipe or device"),
        (tmp_path, "must be the name of a file, got the folder"),
        (tmp_path / ("n" * 300), "must be a name of at most"),
        (tmp_path / "real.nc" / "x.nc", "must be in a folder that exists"),
    ):
        with pytest.raises(InputError, match=f"out: {problem}"):
            tribo.simulate(pair(), accuracy=1e-4, out=path)


def quick():
    """A scene whose run takes about a second."""
    surfaces = (Surface("upper", bob=(-1.0, 0.0)), Surface("lower", facing="up"))
    return Scene(surfaces, Coulomb(0.2), 1e3, output=Output(samples=101))


PROGRAM = "import sys; from tribo.commands.cli import main; sys.exit(main())"


@pytest.mark.parametrize("kills", [3, pytest.param(100, marks=pytest.mark.slow)])
def test_killed_at_random(kills, tmp_path):
    """Programs that are killed at any moment, from the first on; each end has the same bits."""
    path = tmp_path / "scene.toml"
    out = tmp_path / "run.nc"
    scene = replace(quick(), numerics=tribo.Numerics(method="verlet", step=1e-3))
    scene.save(path)
    whole = tribo.simulate(scene)
    rng = random.Random(kills)
    command = [sys.executable, "-c", PROGRAM, "run", str(path), "--out", str(out), "--resume"]
    ends = killed = 0
    while killed < kills or not ends:
        with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
            if killed < kills:
                time.sleep(rng.uniform(0.2, 2.0))
                killed += process.poll() is None
                process.kill()
        assert process.returncode != 0 or out.exists()
        if out.exists():  # a kill may come between the last rename and the end of the program
            ends += 1
            assert same_end(whole, tribo.load_result(out))
            out.unlink()


PLUGIN = """
from pathlib import Path
from typing import NamedTuple
Path(__file__).with_name("loaded").touch()
class Own(NamedTuple):
    s: float
    def energy(self, r):
        return self.s / r
"""
TABLE = """
duration = 1.0
output = { samples = 2 }
numerics = { method = "midpoint", step = 0.1 }
interaction = { potential = "own.py:Own", s = 0.2, cutoff = 3.0 }
surface = [ { name = "upper", bob = [-1.0, 0.0] }, { name = "lower", facing = "up" } ]
"""
OPENED = """
import sys, tribo
from pathlib import Path
result = tribo.load_result(sys.argv[1])
print(result.status, result, result.scene.duration, result.state().t)
tribo.plotting.save(result.plot.snapshots([0.5]), sys.argv[2])
result.save(sys.argv[1])
assert not Path(sys.argv[1]).with_name("loaded").exists()
try:
    tribo.simulate(tribo.load_result(sys.argv[1]).scene)
except tribo.InputError as error:
    print("refused:", error)
print(Path(sys.argv[1]).with_name("loaded").exists())
"""


def test_opening_a_result_loads_no_code(tmp_path, capsys, server):
    """Running its scene does, if the plug-in is what it was; `--no-plugins` refuses it."""
    scene = tmp_path / "scene.toml"
    own = tmp_path / "own.py"
    scene.write_text(TABLE)
    own.write_text(PLUGIN)
    assert main(["run", str(scene), "--no-plugins"]) == 2
    assert "own.py:Own, which --no-plugins refuses" in capsys.readouterr().err
    assert not (tmp_path / "loaded").exists()
    out = tmp_path / "run.nc"
    tribo.simulate(tribo.load_scene(scene), out=out)
    for plugin, refused in ((PLUGIN, False), (PLUGIN.replace("/ r", "/ r**2"), True)):
        own.write_text(plugin)
        (tmp_path / "loaded").unlink()
        printed = server.run(OPENED, out, tmp_path / "figure.png")
        assert printed.startswith("completed") and printed.endswith("True\n")
        assert ("refused: interaction[0].potential: " in printed) == refused
    changed = r"plugin.interaction\[0\].potential was '[\w/]+', is '[\w/]+'"
    with pytest.raises(InputError, match=changed):
        tribo.simulate(tribo.load_scene(scene), out=out, resume=True)
