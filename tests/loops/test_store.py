"""The one store of runs, ensembles and sweeps: killed, on a full disk and damaged."""

import errno
import os
import random
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import tribo
from support.continued import pair
from tribo import InputError, paper
from tribo.ensembles import batches
from tribo.ledger import sinks
from tribo.loops import frames, integrate

SCENE, KEEP = paper.scene("A"), ["upper.W"]
THETA = {"upper.theta": stats.norm(0.0, 0.1)}
SPEEDS = {"upper.velocity": [0.4, 0.45, 0.5, 0.55, 0.6, 0.65]}
ACCURATE = {"accuracy": 1e-6}


class Killed(BaseException):
    """The process ends here."""


def a_run(**how):
    return tribo.simulate(pair(), **ACCURATE, **how).end["surfaces"]


def in_portions(**how):
    scene = replace(pair(), output=replace(pair().output, keep=("upper.W", "contact_energy")))
    result = tribo.simulate(scene, method="midpoint", step=0.05, **how)
    return [result["upper"].W.tolist(), result.system["contact_energy"].tolist()]


def an_ensemble(keep=KEEP, **how):
    data = tribo.ensemble(SCENE, 12, THETA, keep=keep, threads=1, **ACCURATE, **how)
    return {name: data[name].values.tolist() for name in data.data_vars}


def statistics(**how):
    return an_ensemble(statistics=True, **how)


def means(**how):
    return an_ensemble(keep=None, **how)


def a_sweep(**how):
    data = tribo.sweep(SCENE, SPEEDS, keep=KEEP, threads=1, **how)
    return {name: data[name].values.tolist() for name in data.data_vars}


def point_by_point(**how):
    speeds = {key: values[:3] for key, values in SPEEDS.items()}
    data = tribo.sweep(SCENE, speeds, 12, THETA, keep=KEEP, statistics=True, **how)
    return {name: data[name].values.tolist() for name in data.data_vars}


EVERY = [a_run, in_portions, an_ensemble, statistics, means, a_sweep, point_by_point]


@pytest.fixture(autouse=True)
def often(monkeypatch):
    """Few members and steps in each portion, which are written at once."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)
    monkeypatch.setattr(batches, "CHUNK", 2)
    monkeypatch.setattr(integrate, "FIRST_CHUNK", 3)
    monkeypatch.setattr(integrate, "LARGEST_CHUNK", 3)
    monkeypatch.setattr(sinks, "PORTION_BYTES", 2500)
    monkeypatch.setattr(frames, "INTERVAL", -1.0)
    monkeypatch.setattr(frames, "RELATIVE_INTERVAL", 0.0)


def after(count, error):
    """A function that raises an error from so many calls on, and the values it was called with."""
    told = []

    def call(*arguments):
        told.append(arguments)
        if len(told) >= count:
            raise error

    return call, told


def same(one, other):
    """Whether two results have the same bits."""
    np.testing.assert_equal(one, other)
    return True


def stopped(compute, out):
    """The bytes that a computation which was killed leaves beside its file."""
    with pytest.raises(Killed):
        compute(out=out, progress=after(2, Killed)[0])
    return out.with_name(out.name + ".part").read_bytes()


@pytest.mark.parametrize("compute", EVERY)
def test_killed_again_and_again(compute, tmp_path):
    """What goes on ends with the bits of what did not stop, as often as that is."""
    out, whole = tmp_path / "a.nc", compute()
    stopped(compute, out)
    for _ in range(50):
        try:
            found = compute(out=out, resume=True, progress=after(2, Killed)[0])
        except Killed:
            continue
        break
    assert same(found, whole)
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


@pytest.mark.parametrize("compute", EVERY)
def test_what_is_written_is_not_done_again(compute, tmp_path):
    """A resumed computation tells of less than a whole one."""
    out, (count, every), (again, told) = (
        tmp_path / "a.nc",
        after(10**6, Killed),
        after(10**6, Killed),
    )
    compute(progress=count)
    stopped(compute, out)
    compute(out=out, resume=True, progress=again)
    assert 0 < len(told) < len(every)


@pytest.mark.parametrize("compute", EVERY)
@pytest.mark.parametrize("writes", [pytest.param(1, marks=pytest.mark.thorough), 3])
def test_full_disk(compute, writes, monkeypatch, tmp_path):
    """One sentence; an earlier file stays, and what was written is used when there is room."""
    out = tmp_path / "a.nc"
    out.write_bytes(b"an earlier file")
    full = after(writes, OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))[0]
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(InputError, match=r"cannot be written \(No space left on device\)") as e:
            compute(out=out)
    assert "\n" not in str(e.value) and out.read_bytes() == b"an earlier file"
    assert same(compute(out=out, resume=True), compute())
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


@pytest.mark.parametrize("compute", EVERY)
def test_damage(compute, tmp_path):
    """What follows a byte that changed, or the end of a shortened file, is computed again."""
    out, part, whole = tmp_path / "a.nc", tmp_path / "a.nc.part", compute()
    content, rng = stopped(compute, out), random.Random(3)
    for shortened in (False, True, False):
        damaged = bytearray(content)
        # Another first byte is that of another kind of file.
        damaged[rng.randrange(len(content) // 4, len(content))] ^= 1 << rng.randrange(8)
        part.write_bytes(
            damaged[: rng.randrange(len(content) // 2, len(content))] if shortened else damaged
        )
        assert same(compute(out=out, resume=True), whole)
        out.unlink()
