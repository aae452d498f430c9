"""Ensembles in files: what stops is continued to the same bits, and other ensembles are refused."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
import xarray
from scipy import stats

import tribo
from tribo import InputError, Output, ensemble, ensemble_member, paper
from tribo.ensembles import batches, stores
from tribo.loops import frames

KEEP = ["upper.w1", "contact_energy"]
VARY = {"upper.theta": stats.uniform(0.0, 0.2), "lower.omega": stats.norm(0.0, 0.01)}
SCENE = replace(paper.scene("A"), numerics=tribo.Numerics(accuracy=1e-6), output=Output(samples=5))


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    """Chunks of 64 members, which are written at once."""
    monkeypatch.setattr(batches, "CHUNK", 64)
    monkeypatch.setattr(stores, "BLOCK", 100)
    monkeypatch.setattr(frames, "INTERVAL", 0.0)
    monkeypatch.setattr(frames, "RELATIVE_INTERVAL", 0.0)


def stop_with(error, at):
    """A progress function that raises an error after so many members."""

    def progress(done):
        if done >= at:
            raise error

    return progress


def same(one, other):
    """Whether two data sets have the same bits and meanings, but for the time they took."""
    one, other = one.copy(), other.copy()
    for data in (one, other):
        data.attrs = {k: v for k, v in data.attrs.items() if k not in ("seconds", "identity")}
        data["status" if "status" in data.coords else "probability"].load()
    xarray.testing.assert_equal(one, other)
    assert one.attrs == other.attrs
    for name in one.variables:
        if name not in ("status", "value"):
            assert one[name].dtype == other[name].dtype, name
        assert one[name].attrs == other[name].attrs, name
    return True


@pytest.mark.parametrize("settings", [{}, {"statistics": True}, {"at": "samples"}, {"keep": None}])
def test_an_ensemble_that_stops_is_continued(settings, tmp_path):
    """After Ctrl-C, and after an end without warning, to the bits of one that does not stop."""
    out, part = tmp_path / "a.nc", tmp_path / "a.nc.part"
    whole = ensemble(SCENE, 300, VARY, threads=1, **{"keep": KEEP, **settings})
    arguments = {"keep": KEEP, "out": out, "resume": True, **settings}
    with pytest.raises(KeyboardInterrupt) as caught:
        ensemble(SCENE, 300, VARY, progress=stop_with(KeyboardInterrupt, 128), **arguments)
    first = caught.value.result
    assert first.attrs["status"] == "Interrupted"
    assert part.exists() and not out.exists()
    if "statistics" not in settings:
        assert first.sizes["member"] == 128
        np.testing.assert_array_equal(first["upper.w1"], whole["upper.w1"][:128])
    counts = []
    with pytest.raises(RuntimeError):
        ensemble(SCENE, 300, VARY, progress=stop_with(RuntimeError, 192), **arguments)
    data = ensemble(SCENE, 300, VARY, progress=counts.append, **arguments)
    assert counts[0] in (192, 256)  # what was written is not run again
    assert counts[-1] == 300
    assert same(data, whole)
    assert not part.exists()
    with xarray.open_dataset(out) as file:
        assert same(file, whole)
    again = ensemble(SCENE, 300, VARY, progress=stop_with(RuntimeError, 0), **arguments)
    assert same(again, whole)


@pytest.mark.parametrize("settings", [{}, {"statistics": True}])
def test_other_ensembles_are_refused(settings, tmp_path):
    """By what differs, for a file in part and for a complete one."""
    out = tmp_path / "a.nc"
    arguments = {"keep": KEEP, "out": out, "resume": True, **settings}
    with pytest.raises(KeyboardInterrupt):
        ensemble(SCENE, 130, VARY, progress=stop_with(KeyboardInterrupt, 64), **arguments)
    others = {
        "settings.seed was 0, is 1": {"seed": 1},
        "settings.members was 130, is 131": {"members": 131},
        "settings.keep": {"keep": KEEP[:1]},
        "settings.vary.upper.theta": {"vary": {**VARY, "upper.theta": stats.uniform(0.0, 0.3)}},
        "scene.duration": {"scene": replace(SCENE, duration=39.0)},
        "scene.output.samples was 2, is 5": {"at": "samples"},
    }

    def refuse_all():
        for words, other in others.items():
            call = {"scene": SCENE, "members": 130, "vary": VARY} | arguments | other
            with pytest.raises(InputError, match=words):
                ensemble(**call)

    refuse_all()
    ensemble(SCENE, 130, VARY, **arguments)
    refuse_all()


def test_a_damaged_file_of_an_ensemble(tmp_path):
    """A byte that was changed, or a value by another program, is told by one sentence."""
    for out, settings in ((tmp_path / "a.nc", {}), (tmp_path / "b.nc", {"statistics": True})):
        call = {"scene": SCENE, "members": 70, "vary": VARY, "keep": KEEP, "out": out} | settings
        ensemble(**call)
        content = bytearray(out.read_bytes())
        ensemble(**call, resume=True)
        content[len(content) // 2] ^= 1
        out.write_bytes(content)
        message = "is damaged, was written again by another program"
        with pytest.raises(InputError, match=message):
            ensemble(**call, resume=True)
        content[len(content) // 2] ^= 1
        out.write_bytes(content)
        with h5py.File(out, "r+") as file:
            file.attrs["mine"] = 1
        with pytest.raises(InputError, match=message):
            ensemble(**call, resume=True)


def test_what_is_no_file_of_an_ensemble(tmp_path):
    """Is refused; without resume it is replaced.  A file that is being written is left alone."""
    out, part = tmp_path / "a.nc", tmp_path / "a.nc.part"
    arguments = {"keep": KEEP, "out": out}
    part.write_text("other")
    for settings in ({}, {"statistics": True}):
        with pytest.raises(InputError, match="is no such file"):
            ensemble(SCENE, 70, VARY, resume=True, **arguments, **settings)
    ensemble(SCENE, 70, VARY, **arguments)

    def again(done):
        with pytest.raises(InputError, match="is being written by another process"):
            ensemble(SCENE, 70, VARY, resume=True, **arguments)

    ensemble(SCENE, 70, VARY, progress=again, **arguments)
    for settings in ({"statistics": True}, {"keep": None}):
        ensemble(SCENE, 70, VARY, progress=again, **{**arguments, **settings})
    with pytest.raises(InputError, match=r"^resume: needs out"):
        ensemble(SCENE, 70, VARY, keep=KEEP, resume=True)
    for name, value in {"at": "samples", "statistics": True}.items():
        with pytest.raises(InputError, match=f"^{name}: needs keep"):
            ensemble(SCENE, 70, VARY, **{name: value})


def test_a_member_alone():
    """Bit for bit, at the end and over time, by lanes, by collocation and as a single run."""
    rates = np.zeros(90)
    rates[79] = 4.0  # needs finer settings, and is not in the sample
    vary = {"upper.theta": np.linspace(0.0, 0.2, 90), "upper.omega": rates}
    for settings in ({}, {"at": "samples"}):
        data = ensemble(SCENE, 90, vary, keep=KEEP, **settings)
        assert settings or data["level"][79] < data["level"][80]
        for number in (3, 79, 80):
            xarray.testing.assert_identical(
                ensemble_member(data, number), data.isel(member=[number])
            )
    warm = tribo.Surface("upper", shape=(3, 1), langevin=tribo.Langevin(0.6, 0.3))
    scene = tribo.Scene((warm,), (), 4.0, output=Output(samples=5))
    vary = {"upper.velocity": stats.norm(), "upper.theta": stats.norm(0.0, 0.1)}
    data = ensemble(scene, 3, vary, step=0.05, keep=["upper.w_T"], at="samples")
    xarray.testing.assert_identical(ensemble_member(data, 2), data.isel(member=[2]))
    run = tribo.simulate(
        replace(
            scene,
            surfaces=(
                replace(
                    warm,
                    velocity=tuple(data["upper.velocity"].values[2]),
                    initial=tribo.Initial(theta=data["upper.theta"].values[2]),
                ),
            ),
            seed=int(data["seed"][2]),
        ),
        step=0.05,
    )
    np.testing.assert_array_equal(data["upper.w_T"][2], run["upper"].w_T)
    with pytest.raises(InputError, match="must be that of a member"):
        ensemble_member(data, 3)
    with pytest.raises(InputError, match="must have members"):
        ensemble_member(ensemble(SCENE, 70, VARY, keep=KEEP, statistics=True), 3)
