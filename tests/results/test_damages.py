"""Random damages of files: read in bounded time, and refused or read to the same numbers."""

import argparse
import os
import random
import zipfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import xarray
from scipy import stats

import tribo
from support.continued import pair, same_end
from tribo import InputError, seals
from tribo.commands import bundle
from tribo.ensembles import batches
from tribo.loops import frames, integrate

HOW = {"accuracy": 1e-4}
# Processor time of one read beyond that of the intact file, with which a run may go on, and with
# that of processes that read for it [s].
MOST_SECONDS = 1.0


class Killed(BaseException):
    """The process ends here."""


def kill_after(calls):
    """A progress function that kills the process at so many calls."""
    left = iter(range(calls))

    def progress(done):
        if next(left, None) is None:
            raise Killed

    return progress


@contextmanager
def often():
    """Frames after every few steps, and every few members."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda descriptor: None)
        patch.setattr(frames, "INTERVAL", -1.0)
        patch.setattr(frames, "RELATIVE_INTERVAL", 0.0)
        patch.setattr(integrate, "FIRST_CHUNK", 3)
        patch.setattr(integrate, "LARGEST_CHUNK", 3)
        patch.setattr(batches, "CHUNK", 16)
        yield


def flipped(rng, content):
    at = rng.randrange(len(content))
    return content[:at] + bytes([content[at] ^ 1 << rng.randrange(8)]) + content[at + 1 :]


def overwritten(rng, content):
    at = rng.randrange(len(content))
    size = rng.randrange(1, 200)
    new = rng.choice((bytes, rng.randbytes))(min(size, len(content) - at))
    return content[:at] + new + content[at + len(new) :]


def cut(rng, content):
    return content[: rng.randrange(len(content))]


def inserted(rng, content):
    at = rng.randrange(len(content))
    return content[:at] + rng.randbytes(rng.randrange(1, 200)) + content[at:]


def left_out(rng, content):
    at = rng.randrange(len(content))
    return content[:at] + content[at + rng.randrange(1, 200) :]


def overwritten_at_its_end(rng, content):
    """Of a file with a seal both the seal and what precedes it."""
    size = rng.randrange(1, 4 * seals.SEAL.size)
    return content[:-size] + rng.randbytes(size)


def exchanged(rng, content):
    """The content with two of its parts in each other's place."""
    one = rng.randrange(len(content))
    size = rng.randrange(1, 500)
    other = rng.randrange(len(content))
    damaged = bytearray(content)
    first = content[one : one + size]
    second = content[other : other + size]
    damaged[other : other + len(first)] = first
    damaged[one : one + len(second)] = second
    return bytes(damaged)


DAMAGES = (flipped, flipped, overwritten, cut, inserted, left_out, exchanged)


def results(folder):
    """A result that this version has written, with its seal."""
    path = folder / "run.nc"
    whole = tribo.simulate(pair(), **HOW, out=path)

    def read():
        found = tribo.load_result(path)
        return same_end(whole, found) and whole.error_estimate == found.error_estimate

    return path, read


def rewritten_results(folder):
    """A result that another program has written again, without a seal."""
    path, read = results(folder)
    data = xarray.load_dataset(path)
    data.to_netcdf(path)
    return path, read


def old_results(folder):
    """A result of version 0.2."""
    path = folder / "old.nc"
    path.write_bytes(Path(__file__).with_name("golden.nc").read_bytes())
    whole = tribo.load_result(path)
    return path, lambda: same_end(whole, tribo.load_result(path))


def journals(folder):
    """The part of a result that was not completed, from which its run continues."""
    out = folder / "run.nc"
    whole = tribo.simulate(pair(), **HOW)
    with often(), pytest.raises(Killed):
        tribo.simulate(pair(), **HOW, out=out, progress=kill_after(4))
    part = folder / "run.nc.part"
    return part, lambda: same_end(whole, tribo.simulate(pair(), **HOW, out=out, resume=True))


SWINGS = {"upper.theta": stats.uniform(0.0, 0.2)}


def members(folder):
    return {"scene": pair(), "members": 48, "vary": SWINGS, "keep": ["upper.w1"], **HOW} | {
        "out": folder / "members.nc",
        "resume": True,
    }


def same_members(whole, found):
    with found:
        return all(np.array_equal(found[name], whole[name]) for name in ("upper.w1", "upper.theta"))


def stores(folder):
    """The file of an ensemble, from which a call that resumes takes it."""
    call = members(folder)
    whole = tribo.ensemble(**call).load()
    return call["out"], lambda: same_members(whole, tribo.ensemble(**call))


def parts(folder):
    """The part of an ensemble that was not completed."""
    call = members(folder)
    whole = tribo.ensemble(**call | {"out": None, "resume": False}).load()
    with often(), pytest.raises(Killed):
        tribo.ensemble(**call, progress=kill_after(2))
    return folder / "members.nc.part", lambda: same_members(whole, tribo.ensemble(**call))


def bundles(folder, files=results):
    """An archive that gets a result: its content is that of the file, or it is refused."""
    path, read_result = files(folder)
    archive = folder / "all.zip"

    def read():
        bundle.run_bundle(argparse.Namespace(files=[path], out=archive))
        with zipfile.ZipFile(archive) as packed:
            path.write_bytes(packed.read(path.name))
        return read_result()

    return path, read


def rewritten_bundles(folder):
    return bundles(folder, rewritten_results)


# Kinds of files: the part of the trials that each has, and how often a trial reads the file.
# Without a seal a file is first read in another process, which takes a third of a second.
KINDS = {
    results: (0.3, 1),
    rewritten_results: (0.05, 1),
    old_results: (0.05, 1),
    journals: (0.2, 1),
    stores: (0.22, 1),
    parts: (0.1, 1),
    bundles: (0.06, 2),
    rewritten_bundles: (0.02, 2),
}


def processor_time():
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


@pytest.mark.parametrize(
    "trials",
    [
        25,
        pytest.param(100, marks=pytest.mark.thorough),
        pytest.param(10_000, marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("files", KINDS, ids=lambda files: files.__name__)
def test_random_damages(files, trials, tmp_path):
    """A read takes a second more than the intact file at most: the same numbers, or a sentence."""
    path, read = files(tmp_path)
    content = path.read_bytes()
    began = processor_time()
    assert read()
    share, reads = KINDS[files]
    most = processor_time() - began + reads * MOST_SECONDS
    rng = random.Random(f"{files.__name__} {trials}")
    refused = 0
    slowest = 0.0
    for trial in range(max(5, round(share * trials))):
        damage = overwritten_at_its_end if trial % 10 == 9 else rng.choice(DAMAGES)
        for other in tmp_path.iterdir():
            other.unlink()
        path.write_bytes(damage(rng, content))
        began = processor_time()
        try:
            assert read(), (damage.__name__, trial)
        except InputError as error:
            assert "\n" not in str(error)
            refused += 1
        slowest = max(slowest, processor_time() - began)
        assert slowest < most, (damage.__name__, trial)
    print(f"{files.__name__}: {trial + 1} damages, {refused} refused, slowest {slowest:.2f} s")
