"""Every entry of the atlas ends as declared; the judge and the command can fail."""

import json
from dataclasses import replace

import pytest

from support.command import main
from tribo import atlas, interrupts, prepare
from tribo.atlas.entries import STOP_TIME, all_entries
from tribo.atlas.rows import NOT_HONEST, NOT_MET
from tribo.kernels.status import MEANINGS

ENTRIES = all_entries()
# Scenes that take long, or that need a time loop which no other scene needs.
SLOW = {
    *("free-swing-4e6", "lj-wall-below", "rows-period", "lattice-defect", "within-five"),
    *("jump-weak", "jump-pulled", "rods-4e5", "rods-1e6", "rod-2e5-jump", "switch-first-step"),
}
# Those that take seconds: a million swings, and ten million steps.
THOROUGH = {"free-swing-1e5", "verlet-1e7-steps"}


def marked(name):
    """An entry's name, marked where its test is slow or thorough."""
    marks = [pytest.mark.slow] * (name in SLOW) + [pytest.mark.thorough] * (name in THOROUGH)
    return pytest.param(name, marks=marks)


@pytest.mark.parametrize("name", [marked(name) for name in ENTRIES])
def test_entry(name):
    """The run ends as declared, within the bound and within its error estimate."""
    row = atlas.row(ENTRIES[name])
    assert row.as_declared, str(row)


def test_the_atlas_is_complete():
    """At least 40 scenes; every file has an entry and every entry a file."""
    assert len(ENTRIES) >= 40
    files = {path.stem for path in next(iter(ENTRIES.values())).path.parent.glob("*.toml")}
    assert files == set(ENTRIES)
    assert set(ENTRIES) >= SLOW | THOROUGH


@pytest.mark.parametrize("name", ENTRIES)
def test_entry_is_documented(name):
    """A valid scene with a title; an outcome, a sentence, and twelve digits in each number."""
    entry = ENTRIES[name]
    scene = entry.scene()
    assert scene.title and entry.source
    assert entry.failure.endswith(".") and len(entry.failure.split()) >= 8
    assert entry.declared in {*MEANINGS, NOT_MET}
    assert (STOP_TIME in entry.reference) == (entry.declared not in ("completed", NOT_MET))
    assert 0.0 < entry.bound <= 0.1
    for digits in (number for numbers in entry.reference.values() for number in numbers):
        mantissa = digits.partition("e")[0].lstrip("-").replace(".", "")
        assert float(digits) is not None and len(mantissa.lstrip("0") or mantissa) >= 12


@pytest.fixture(scope="module")
def easy():
    """An entry and its result."""
    entry = ENTRIES["coulomb-no-gap"]
    return entry, prepare(entry.scene()).compute_first()


def test_the_judge_accepts(easy):
    """The reference and the result agree."""
    row = atlas.judge(*easy, 0.0)
    assert row.as_declared and 0.0 < row.error <= row.estimate <= 1e-8


@pytest.mark.parametrize("key", ["upper.theta", "lower.w1", "upper.delta_e_int"])
def test_the_judge_finds_a_wrong_number(easy, key):
    """A reference that is off by 1e-8 is outside the error estimate."""
    entry, result = easy
    (digits,) = entry.reference[key]
    wrong = entry.reference | {key: (str(float(digits) * (1.0 + 1e-8)),)}
    row = atlas.judge(replace(entry, reference=wrong), result, 0.0)
    assert not row.as_declared and row.outcome == NOT_HONEST


def test_the_judge_finds_a_large_error(easy):
    """An error within its estimate and above the bound."""
    entry, result = easy
    row = atlas.judge(replace(entry, bound=1e-13), result, 0.0)
    assert not row.as_declared and row.outcome == "completed"


def test_the_judge_finds_another_outcome(easy):
    """A run that completes where a status is declared, and one that stops where none is."""
    entry, result = easy
    stop = replace(entry, declared="StepUnderflow", reference={STOP_TIME: ("20.3000000000",)})
    row = atlas.judge(stop, result, 0.0)
    assert not row.as_declared and row.error is None and row.outcome == "completed"
    together = ENTRIES["coulomb-coincide"]
    stopped = prepare(together.scene()).compute_first()
    row = atlas.judge(replace(entry, name="x"), stopped, 0.0)
    assert not row.as_declared and row.error is None and row.outcome == "BobsCoincide"
    late = replace(together, reference={STOP_TIME: ("1.00000000000",)})
    assert not atlas.judge(late, stopped, 0.0).as_declared


def test_the_judge_finds_a_request_that_was_missed(easy):
    """A run that reports its accuracy as not met."""
    entry, result = easy
    assert atlas.judge(entry, replace(result, met=False), 0.0).outcome == NOT_MET


def test_command(capsys):
    """A line for each scene as it ends, and how many are as declared."""
    assert main(["atlas", "coulomb-no-gap", "coulomb-coincide"]) == 0
    head, *lines, last = capsys.readouterr().out.splitlines()
    assert head == atlas.HEAD
    assert [line.split()[0] for line in lines] == ["coulomb-no-gap", "coulomb-coincide"]
    assert all(line.endswith("as declared") for line in lines)
    assert last == "2 of 2 scenes as declared"


def test_command_as_json(capsys):
    """The keys are those of the contract."""
    assert main(["atlas", "--json", "coulomb-coincide"]) == 0
    out, err = capsys.readouterr()
    ((row,),) = json.loads(out).values()
    assert err == ""
    seconds = row.pop("seconds")
    assert isinstance(seconds, float) and seconds > 0.0
    assert row == {
        "name": "coulomb-coincide",
        "declared": "BobsCoincide",
        "outcome": "BobsCoincide",
        "as_declared": True,
        "error": 0.0,
        "estimate": None,
    }


def test_command_that_finds_another_outcome(capsys, monkeypatch):
    """Exit status 1, and the line says what was declared."""
    entry = replace(ENTRIES["coulomb-coincide"], declared="completed")
    monkeypatch.setattr(atlas, "chosen", lambda names: [entry])
    assert main(["atlas"]) == 1
    assert "BobsCoincide, NOT AS DECLARED (completed)" in capsys.readouterr().out


def test_command_with_an_unknown_name(capsys):
    """One sentence that names all entries, and exit status 2."""
    assert main(["atlas", "nothing"]) == 2
    assert "must be one of coulomb-no-gap, " in capsys.readouterr().err


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_interrupt_keeps_the_rows_that_are_complete(capsys, monkeypatch, options):
    """Ctrl-C in the second scene: the first row is printed, and the exit status is 1."""
    row = atlas.row

    def interrupted(entry):
        if entry.name == "coulomb-coincide":
            return row(entry)
        raise KeyboardInterrupt

    monkeypatch.setattr(atlas, "row", interrupted)
    assert main(["atlas", *options, "coulomb-coincide", "coulomb-no-gap"]) == 1
    out, err = capsys.readouterr()
    assert "coulomb-coincide" in out and "coulomb-no-gap" not in out
    assert err == "tribo: interrupted after 1 of 2 scenes\n"


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_an_interrupt_that_ends_the_program_prints_the_rows(capsys, monkeypatch, options):
    """As where a compiler delays the exception: the rows so far are printed all the same."""
    row = atlas.row

    def ended(entry):
        if entry.name == "coulomb-coincide":
            return row(entry)
        interrupts.report(json=False)
        raise SystemExit

    monkeypatch.setattr(atlas, "row", ended)
    with pytest.raises(SystemExit):
        main(["atlas", *options, "coulomb-coincide", "coulomb-no-gap"])
    out, err = capsys.readouterr()
    if options:
        assert [line["name"] for line in json.loads(out)["rows"]] == ["coulomb-coincide"]
    else:
        assert "1 of 2 scenes as declared" in out
    assert err == "tribo: interrupted after 1 of 2 scenes\n"
