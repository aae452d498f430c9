"""Threads that share the steps of a run: the same bits for any number, and they always end."""

import os
import signal
import threading
from dataclasses import replace

import numpy as np
import pytest

import tribo
from support.command import main
from support.sliding import long_slide
from support.sliding import scene as crowded
from tribo import system
from tribo.ensembles.runner import Execution
from tribo.integrators.methods import METHODS
from tribo.layout import contacts
from tribo.layout import layout as layouts
from tribo.layout.layout import lay_out
from tribo.loops import general
from tribo.threads import shared_run

PERIODIC = {"x": 6.0, "z": 3.0}
STEPS = {"method": "verlet", "step": 0.003}


@pytest.fixture
def shared(monkeypatch):
    """Let threads share the steps of any scene, with neighbour lists."""
    monkeypatch.setattr(contacts, "UNLISTED_PAIRS", 0)
    monkeypatch.setattr(contacts, "SHARED_PAIRS", 0)


def run(scene, count, **others):
    """A run with so many threads."""
    return tribo.simulate(scene, threads=count, **STEPS, **others)


def assert_same_bits(one, other):
    """All series of two results."""
    for name in ("upper", "lower"):
        for quantity in one[name]:
            assert np.array_equal(one[name][quantity], other[name][quantity]), quantity


def test_the_same_bits_for_any_number_of_threads(shared, monkeypatch):
    """A long slide; one thread alone, which shares nothing, differs by round-off."""
    scene = replace(long_slide(PERIODIC), duration=6.0)
    one, two, three = (run(scene, count) for count in (1, 2, 3))
    assert one.status == "completed" and np.max(np.abs(one["lower"].w1)) > 0.0
    assert_same_bits(one, two)
    assert_same_bits(one, three)
    monkeypatch.setattr(contacts, "SHARED_PAIRS", np.inf)
    alone = run(scene, 2)
    for quantity in ("theta", "w1", "w2", "W"):
        expected, found = alone["lower"][quantity], one["lower"][quantity]
        assert np.max(np.abs(found - expected)) <= 1e-9 * np.max(np.abs(expected)), quantity


def test_a_list_that_outgrows_its_room(shared, monkeypatch):
    """All pairs are computed for rows without room, by any number of threads."""
    scene = replace(long_slide(PERIODIC), duration=2.0)
    plain, whole, given = run(scene, 1), layouts.Layout.neighbours, []

    def cramped(self, *arguments):
        return whole(self, *arguments)._replace(index=np.zeros(1, np.int32))

    def counted(neighbours):
        given.append(neighbours.index.size)
        return with_room(neighbours)

    with_room = general.with_room
    monkeypatch.setattr(layouts.Layout, "neighbours", cramped)
    monkeypatch.setattr(general, "with_room", counted)
    assert_same_bits(plain, run(scene, 2))
    assert given[0] == 1 < given[-1]


def test_chunks_of_unequal_length(shared, monkeypatch):
    """A crowd at one end of a surface needs more than an equal part of the room."""
    places = np.append(np.linspace(0.0, 2.0, 40), np.linspace(3.0, 60.0, 40))
    upper, lower = (np.column_stack([places, np.full(80, y), 0.0 * places]) for y in (0.6, 0.0))
    scene = replace(crowded(upper, lower, {}), duration=0.3)
    plain, whole, lists = run(scene, 1), layouts.Layout.neighbours, []

    def seen(neighbours):
        lists.append(neighbours)
        return with_room(neighbours)

    with_room = general.with_room
    monkeypatch.setattr(general, "with_room", seen)
    run(scene, 1)
    room = int(lists[-1].start[-1]) + 8
    index = np.zeros(room, np.int32)
    monkeypatch.setattr(layouts.Layout, "neighbours", lambda *a: whole(*a)._replace(index=index))
    teams, assisted = [], general.assisted

    def watched(team, *others):
        teams.append(team)
        return assisted(team, *others)

    monkeypatch.setattr(general, "assisted", watched)
    assert_same_bits(plain, run(scene, 2))
    team = teams[-1]
    assert np.max(team.lengths) > room // team.lengths.size
    assert np.array_equal(np.diff(team.begins), team.lengths)
    assert lists[-1].index.size == room  # which was enough


def test_a_thread_that_cannot_start(shared, monkeypatch):
    """The error is that of the operating system, and the threads before it have ended."""
    before, start, started = threading.active_count(), threading.Thread.start, []

    def limited(thread):
        if started:
            raise RuntimeError("can't start new thread")
        started.append(thread)
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", limited)
    with pytest.raises(RuntimeError, match="can't start new thread"):
        run(replace(long_slide(PERIODIC), duration=1.0), 3)
    assert len(started) == 1 and threading.active_count() == before


@pytest.mark.usefixtures("heeded")
@pytest.mark.parametrize("error", [KeyboardInterrupt, ZeroDivisionError])
def test_threads_end_with_the_run(shared, error):
    """Ctrl-C while threads share a step stops the run at once; an error of a report is raised."""
    scene = replace(long_slide(PERIODIC), duration=1e6)
    before, reported = threading.active_count(), []

    def report(t):
        reported.append(t)
        if error is ZeroDivisionError:
            raise error
        if len(reported) == 1:
            threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()

    if error is KeyboardInterrupt:
        with pytest.raises(KeyboardInterrupt) as caught:
            run(scene, 2, progress=report)
        result = caught.value.result
        assert result.status == "Interrupted" and 0.0 < result.t[-1] < 1e6
    else:
        with pytest.raises(error):
            run(scene, 2, progress=report)
    assert threading.active_count() == before


def test_how_many_threads(shared, monkeypatch):
    """The argument, else TRIBO_THREADS, else the cores; one where they do not pay."""
    model, verlet = lay_out(long_slide({})).model, METHODS["verlet"]
    monkeypatch.delenv(system.THREADS_VARIABLE, raising=False)
    assert shared_run.threads_of(model, verlet, None).number == system.available_cores()
    monkeypatch.setenv(system.THREADS_VARIABLE, "3")
    assert shared_run.threads_of(model, verlet, None) == (3, "by TRIBO_THREADS")
    assert shared_run.threads_of(model, verlet, 2).number == 2
    assert shared_run.threads_of(model, METHODS["rkn8"], 2).number == 1
    assert shared_run.threads_of(model._replace(team=None), verlet, 2).number == 1
    monkeypatch.setenv(system.THREADS_VARIABLE, "many")
    with pytest.raises(tribo.InputError, match="TRIBO_THREADS: must be a positive integer"):
        shared_run.threads_of(model, verlet, None)
    with pytest.raises(tribo.InputError, match="threads: must be"):
        shared_run.threads_of(model, verlet, 0)


def test_how_many_members_run_at_the_same_time(monkeypatch):
    """As many as a run has threads."""
    monkeypatch.setenv(system.THREADS_VARIABLE, "3")
    assert Execution.checked(None, None).threads == 3
    assert Execution.checked(None, 2).threads == 2
    monkeypatch.setenv(system.THREADS_VARIABLE, "0")
    with pytest.raises(tribo.InputError, match="TRIBO_THREADS: must be a positive integer"):
        Execution.checked(None, None)
    monkeypatch.delenv(system.THREADS_VARIABLE)
    assert Execution.checked(None, None).threads == shared_run.wanted_threads(None)[0]


def test_the_option(tmp_path, capsys):
    """`tribo run --threads` takes a positive integer."""
    path = tmp_path / "scene.toml"
    path.write_text("")
    assert main(["run", str(path), "--threads", "0"]) == 2
    assert "--threads" in capsys.readouterr().err


@pytest.mark.slow
def test_contact_within_surfaces_has_the_same_bits(shared):
    """Three interactions, sums over surfaces, and a rigid surface."""
    scene = long_slide(PERIODIC)
    potential = scene.interactions[0].potential
    pairs = [("upper", "lower"), ("upper", "upper"), ("lower", "lower")]
    upper, lower = scene.surfaces
    scene = replace(
        scene,
        surfaces=(replace(upper, drive=tribo.Free(rigid=True)), replace(lower, drive="bars")),
        interactions=[tribo.Interaction(potential, pair) for pair in pairs],
        output=tribo.Output(samples=5, ledger="surfaces"),
        duration=3.0,
    )
    one, two = run(scene, 1), run(scene, 2)
    assert one.status == "completed"
    assert_same_bits(one, two)
