"""What differs between operating systems; stand-ins play the functions of Windows."""

import os
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import tribo
from tribo import InputError, system
from tribo.files import lock, replace_file

SOURCE = Path(tribo.__file__).parent
# The checkout; the package may be installed elsewhere.
PROJECT = Path(__file__).parents[1]
LOCK_ELSEWHERE = """
import sys
from tribo.system import lock
try:
    lock(open(sys.argv[1], "r+b"))
except BlockingIOError:
    print("locked")
"""
# Names that Python lacks on Windows, and those of its own.
OF_ONE_SYSTEM = re.compile(
    r"\b(fcntl|msvcrt|termios|resource|fork|getpgid|setsid|sched_\w+|pathconf|set_blocking|O_BINARY"
    r"|SIGKILL|SIGALRM|mkfifo|/proc|os\.name|sys\.platform)\b"
)


def locked(path):
    """A file that this process alone may write."""
    file = path.open("r+b")
    lock(file, path)
    return file


def test_systems_differ_in_one_module():
    """No other module names what only some operating systems have."""
    for path in SOURCE.rglob("*.py"):
        if path.name != "system.py":
            found = OF_ONE_SYSTEM.search(path.read_text(encoding="utf-8"))
            assert not found, f"{path.relative_to(SOURCE)} names {found[0]}"


def test_a_lock_keeps_other_processes_out(tmp_path):
    """As long as the file is open; the place in the file stays."""
    path = tmp_path / "a file"
    path.write_bytes(b"content")
    command = [sys.executable, "-c", LOCK_ELSEWHERE, path]
    with locked(path) as file:
        assert file.read() == b"content"
        assert subprocess.run(command, capture_output=True, text=True).stdout == "locked\n"
    assert subprocess.run(command, capture_output=True, text=True).stdout == ""


@pytest.fixture
def windows(monkeypatch):
    """Windows' branch, with a stand-in for its locks."""
    held = []

    def locking(descriptor, mode, count):
        place = os.lseek(descriptor, 0, os.SEEK_CUR)
        if (mode, count, place) in held:
            raise PermissionError(13, "Permission denied")
        held.append((mode, count, place))

    module = ModuleType("msvcrt")
    vars(module).update(locking=locking, LK_NBLCK=2)
    monkeypatch.setitem(sys.modules, "msvcrt", module)
    monkeypatch.setattr(system, "WINDOWS", True)
    return SimpleNamespace(held=held)


def test_locks_of_windows(windows, tmp_path):
    """One byte behind every content is locked, as others cannot read what is."""
    path = tmp_path / "file"
    path.write_bytes(b"content")
    with locked(path) as file:
        assert file.read() == b"content"
        assert windows.held == [(2, 1, system.LOCKED_BYTE)]
        with pytest.raises(InputError, match="is being written by another process"):
            locked(path)


def test_windows_waits_for_a_file_that_another_program_has_open(windows, tmp_path, monkeypatch):
    """It cannot be replaced until it is closed; after a second that is an error."""
    monkeypatch.setattr(system, "OPEN_FILES_CAN_BE_REPLACED", False)
    monkeypatch.setattr(system, "PATIENCE", 0.1)
    path = tmp_path / "file"
    refused = []
    renamed = os.replace

    def replace(new, old):
        refused.append(new)
        if len(refused) in (1, 2) or forever:
            raise PermissionError(13, "The process cannot access the file")
        renamed(new, old)

    monkeypatch.setattr(os, "replace", replace)
    forever = False
    replace_file(path, b"one")
    assert path.read_bytes() == b"one" and len(refused) == 3
    forever = True
    with pytest.raises(InputError, match="cannot be written"):
        replace_file(path, b"two")
    assert path.read_bytes() == b"one" and list(tmp_path.iterdir()) == [path]


def test_names_and_pipes_of_windows(windows, tmp_path):
    """Python 3.11 cannot make a pipe there that does not block; names have 255 letters."""
    reader, writer = system.pipe_of_signals()
    assert os.get_blocking(writer)
    os.close(reader), os.close(writer)
    assert system.longest_name(tmp_path) == 255


def test_no_two_files_differ_in_case():
    """A file system that takes them as one would lose one."""
    root = PROJECT
    for folder in ("src", "tests", "docs", "examples", "benchmarks"):
        names = Counter(str(p).lower() for p in (root / folder).rglob("*") if ".git" not in p.parts)
        assert not [name for name, count in names.items() if count > 1]


def first(pattern, name):
    """What the pattern finds first in a file of the checkout."""
    found = re.search(pattern, (PROJECT / name).read_text(encoding="utf-8"), re.MULTILINE)
    assert found, name
    return found[1]


def test_the_version_is_in_one_place():
    """Files of other programs name the last release: this version, or one before it."""
    release = first(r"^## \[(\d[\d.]*)\] - \d{4}-\d\d-\d\d$", "CHANGELOG.md")
    for name in ("CITATION.cff", "conda/recipe.yaml"):
        assert first(r"^ *version: \"?([\d.]+)\"?$", name) == release
    developed = re.fullmatch(r"(\d+\.\d+\.\d+)\.dev0", tribo.__version__)
    unreleased = first(r"^## \[(.*?)\]", "CHANGELOG.md") == "Unreleased"
    assert unreleased == (developed is not None)
    if developed is None:
        assert tribo.__version__ == release
    else:
        assert numbers(developed[1]) > numbers(release)


def numbers(version):
    """The parts of a version, to compare."""
    return [int(part) for part in version.split(".")]


def test_a_checkout_that_is_not_installed_runs(tmp_path):
    """With paths that have spaces and accents, without metadata of a package."""
    folder = tmp_path / "a fólder"
    folder.mkdir()
    (folder / "tribo").symlink_to(SOURCE)
    code = "from tribo import Scene, __version__; print(__version__)"
    command = [
        sys.executable,
        "-I",
        "-c",
        f"import sys; sys.path.insert(0, {str(folder)!r}); {code}",
    ]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    assert done.stdout == f"{tribo.__version__}\n", done.stderr
