"""Ctrl-C: every command answers it at any time, and keeps what it has."""

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import tribo
from support.command import main
from tribo import interrupts
from tribo.compiler.jit import undisturbed
from tribo.interrupts import Interrupted

# Windows has no such signals between processes.
resource = pytest.importorskip("resource", reason="needs POSIX")

LONG = """
duration = 1e6
numerics = { method = "verlet", step = 1e-3 }
interaction = { potential = "coulomb", strength = 0.2 }
surface = [ { name = "upper", bob = [-1.0, 0.0] }, { name = "lower", facing = "up" } ]
"""
# The folder of the package.
SOURCE = str(Path(tribo.__file__).parents[1])
PROGRAM = "import sys; from tribo.commands.cli import main; sys.exit(main())"
# Processor time of an answer [s].
ANSWER = 1.0
# Wall time after which there is none [s], on a machine that may run much else.
NEVER = 120.0


def processor_time(pid):
    """Processor time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def processor_time_of_children():
    """Processor time of all processes that were started here and have ended [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


@pytest.fixture
def interrupted(tmp_path):
    """Start a command, wait, interrupt it; its status, output and errors."""
    (tmp_path / "long.toml").write_text(LONG)

    def run(wait, *command, compiles=True):
        cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")} if compiles else {}
        before = processor_time_of_children()
        with subprocess.Popen(
            [sys.executable, "-W", "error", "-c", PROGRAM, *command],
            cwd=tmp_path,
            env=os.environ | cache,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as process:
            wait()
            before += processor_time(process.pid)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=NEVER)
        assert processor_time_of_children() - before < ANSWER
        assert "Traceback" not in err
        return process.returncode, out, err

    return run


COMMANDS = {
    "run": (1.0, "run", "long.toml", "--json"),  # it imports
    "compiling": (3.0, "run", "long.toml", "--json"),
    "accuracy": (2.0, "accuracy", "long.toml", "--json"),
    "check": (1.5, "check", "coulomb", "strength=1", "--json"),
    "paper": (1.5, "paper", "--json"),
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.thorough] * (name != "run")) for name in COMMANDS],
)
def test_before_there_is_a_result(interrupted, name):
    """Status 1 and the name of the status, also while modules are imported and loops compiled."""
    seconds, *command = COMMANDS[name]
    status, out, err = interrupted(lambda: time.sleep(seconds), *command)
    assert status == 1
    assert json.loads(out) == {"status": "Interrupted"}
    assert err == "tribo: Interrupted: the command was interrupted before it had a result\n"


def test_a_command_that_is_ended_names_what_it_has_kept(tmp_path, capfd, monkeypatch):
    """If nothing answers in time, as while a large ledger is computed; only of a file that is."""
    monkeypatch.setattr(interrupts, "_parts", [])
    interrupts.part_is_kept_in(str(tmp_path / "run.nc.part"))
    interrupts.report(json=False)
    (tmp_path / "run.nc.part").touch()
    interrupts.report(json=False)
    first, second = capfd.readouterr().err.splitlines()
    assert first.endswith("before it had a result")
    assert second.endswith(f"the same command with --resume goes on from {tmp_path}/run.nc.part")


LOST = """
import os, signal, sys
from tribo import interrupts
from tribo.interrupts import watch

class Incomplete:
    def __del__(self):
        raise AttributeError(sys.argv[1])

watch(json=False)
if sys.argv[1] == "interrupted":
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        pass
Incomplete()
os._exit(0)
"""


@pytest.mark.parametrize("name", ["interrupted", "undisturbed"])
def test_errors_of_incomplete_objects(name):
    """An interrupt leaves objects that cannot be deleted; without it such an error is reported."""
    done = subprocess.run([sys.executable, "-c", LOST, name], capture_output=True, text=True)
    assert (f"AttributeError: {name}" in done.stderr) == (name == "undisturbed")


def test_an_interrupt_between_processes():
    """The partial result stays where it is; the interrupt arrives."""
    found = pickle.loads(pickle.dumps(Interrupted(lambda: None)))
    assert type(found) is KeyboardInterrupt


@pytest.mark.usefixtures("heeded")
def test_compilers_are_not_interrupted():
    """LLVM would free a module twice; the interrupt is raised once the block has ended."""
    done = []
    with pytest.raises(KeyboardInterrupt), undisturbed():
        os.kill(os.getpid(), signal.SIGINT)
        done.append("all")
    assert done == ["all"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_run_keeps_what_it_reached(interrupted, tmp_path):
    """In FILE.part; an earlier FILE stays as it was.  The run can be interrupted again."""
    out = tmp_path / "long.nc"
    out.write_bytes(b"an earlier file")
    part = tmp_path / "long.nc.part"

    def later():
        """Wait until the run has kept something more."""
        size = part.stat().st_size if part.exists() else 0
        while not (part.exists() and part.stat().st_size > size):
            time.sleep(0.05)
        time.sleep(0.5)

    reached = []
    for options in ((), ("--resume",)):
        command = ("run", "long.toml", "--json", "--out", "long.nc", *options)
        status, printed, err = interrupted(later, *command, compiles=False)
        end = json.loads(printed)
        assert (status, err, end["status"]) == (1, "", "Interrupted")
        reached.append(end["t"])
        assert out.read_bytes() == b"an earlier file"
    assert 0.0 < reached[0] < reached[1]
    printed = interrupted(later, *command[:2], *command[3:], compiles=False)[1]
    assert "Next:  the same command with --resume   goes on from long.nc.part" in printed


def test_little_is_imported_before_the_program_can_be_interrupted():
    """Python's own start apart; `typing` alone takes as long."""
    code = (
        "import sys; import tribo.commands.cli; from tribo import interrupts; print(*sys.modules)"
    )
    found = subprocess.run(
        [sys.executable, "-S", "-c", f"import sys; sys.path.insert(0, {SOURCE!r}); {code}"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    assert "tribo.interrupts" in found
    assert not {"typing", "re", "argparse", "numpy"} & set(found)


def test_an_interrupted_command_answers_in_the_form_of_its_own_arguments(monkeypatch, capfd):
    """Not of the program's that calls it."""

    def interrupted(arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("tribo.interrupts._report", [])
    monkeypatch.setattr("tribo.commands.cli._run", interrupted)
    monkeypatch.setattr("sys.argv", ["lecture.py", "--json"])
    main(["run", "scene.toml"])
    assert capfd.readouterr().out == ""
    monkeypatch.setattr("sys.argv", ["lecture.py"])
    main(["run", "scene.toml", "--json"])
    assert capfd.readouterr().out == '{"status": "Interrupted"}\n'
