"""Help leads to the right command, and a shell completes commands, options and files."""

import shutil
import subprocess

import pytest

from support.command import main


@pytest.mark.parametrize(
    ("arguments", "advice"),
    [
        ("rnu", "did you mean run?"),
        ("new ruogh", "did you mean rough?"),
        ("scene.toml", "scene.toml is no command; did you mean: tribo run scene.toml"),
        ("run.nc", "run.nc is no command; did you mean: tribo run run.nc"),
    ],
)
def test_advice(arguments, advice, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(arguments.split())
    assert advice in capsys.readouterr().err


def test_first_steps(capsys):
    """`tribo --help` shows commands that a beginner needs, all of which exist."""
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    text = capsys.readouterr().out
    steps = text.partition("first steps:\n")[2].splitlines()
    assert len(steps) >= 4
    for step in steps[:-1]:
        assert f"\n    {step.split()[1]} " in text


def test_purpose(capsys):
    """The help of a command begins with its purpose, and names keep their capitals."""
    with pytest.raises(SystemExit, match="0"):
        main(["export-lammps", "--help"])
    assert "\nWrite a scene as input files of LAMMPS.\n" in capsys.readouterr().out


@pytest.mark.parametrize("shell", ["bash", "zsh", "tcsh"])
def test_script(shell, capsys):
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(word in script for word in ("tribo", "ensemble", "rough"))


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("line", "expected"),
    [("tribo ens", "ensemble"), ("tribo run --acc", "--accuracy"), ("tribo new ro", "rough")],
)
def test_bash_completes(line, expected, capsys, tmp_path):
    """Bash, with the script, completes a line."""
    assert main(["completion", "bash"]) == 0
    script = tmp_path / "completion.bash"
    script.write_text(capsys.readouterr().out)
    words = " ".join(line.split())
    program = (
        f"source {script}; COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); "
        "$(complete -p tribo | sed 's/.*-F \\([^ ]*\\).*/\\1/'); echo ${COMPREPLY[@]}"
    )
    found = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=True)
    assert expected in found.stdout.split()
