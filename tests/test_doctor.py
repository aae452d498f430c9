"""`tribo doctor`: what it prints, and what it compiles ahead."""

import re

import pytest

from support.command import main
from tribo.commands.compile_ahead import runs


def test_the_known_run_agrees(capsys):
    """On any machine; the exit status says so too."""
    assert main(["doctor"]) == 0
    assert "agrees with 0.519665" in capsys.readouterr().out


def test_runs_of_pairs():
    """Those of one asperite on one are whole runs of valid scenes."""
    pairs = {purpose: run for purpose, run in runs().items() if "pair" in purpose}
    assert len(pairs) == 5
    for purpose, run in pairs.items():
        found = run()
        if purpose != "members of a pair":
            assert found.status == "completed", purpose


@pytest.mark.slow
def test_all_common_kinds_are_compiled(capsys):
    """With the seconds of each and of all together."""
    assert main(["doctor", "--compile"]) == 0
    printed = capsys.readouterr().out
    assert len(re.findall(r"^  .* \d+\.\d s$", printed, re.M)) == len(runs())
    assert re.search(r"^compiled +in \d+ s$", printed, re.M)
