"""The pages of reference contain every option, variable, unit and attribute, and no other."""

import argparse
import re
from pathlib import Path

import tribo
from tribo import Result
from tribo.commands.parser import _parser
from tribo.ledger import quantities
from tribo.ledger.reported import SUMMED_QUANTITIES
from tribo.results import result_file

PAGES = Path(__file__).resolve().parents[1] / "docs" / "reference"


def page(name):
    """The text of a page."""
    return (PAGES / f"{name}.md").read_text(encoding="utf-8")


def test_every_command_and_option():
    """Each command has a section; its table has its arguments, in order."""
    (commands,) = (a for a in _parser()._actions if isinstance(a, argparse._SubParsersAction))
    sections = dict(
        re.findall(r"^## `tribo ([\w-]+)`\n(.*?)(?=^## |\Z)", page("command_line"), re.M | re.S)
    )
    assert sections.keys() == commands.choices.keys()
    for name, command in commands.choices.items():
        options = {o for a in command._actions for o in a.option_strings} - {"-h", "--help"}
        _, *rows = re.findall(
            r"^\| `?(.*?)`? \|", sections[name].partition("`SCENE.toml` is a")[0], re.M
        )
        found = {o for row in rows for o in re.findall(r"(?<![\w-])--?[a-z][\w-]*", row)}
        assert found == options, name
        count = sum(a.dest != "help" for a in command._actions)
        assert len(rows) - 1 == count, name


def test_every_variable_and_unit():
    """The rows of the page are the tables of the code."""
    tables_of_page = page("result_file").partition("## Variables of each asperite")[2]
    rows = set(re.findall(r"^\| `(\w+)` \| `(.*?)` \| (.*) \|$", tables_of_page, re.M))
    tables = (
        *(quantities.ASPERITE_QUANTITIES, quantities.OPTIONAL_QUANTITIES),
        *(quantities.BLOCK_QUANTITIES, quantities.PULLED_QUANTITIES, quantities.SYSTEM_QUANTITIES),
        *(quantities.FURTHER_OF_ASPERITES, quantities.FURTHER_OF_SURFACES),
        *(quantities.FURTHER_OF_SYSTEM, SUMMED_QUANTITIES),
    )
    assert rows == {(n, q.units, q.long_name) for table in tables for n, q in table.items()}


def test_every_attribute_and_coordinate(tmp_path):
    """Those of a file."""
    upper = tribo.Surface("upper", bob=(-10, 0), velocity=(0.5, 0))
    scene = tribo.Scene([upper, tribo.Surface("lower", facing="up")], tribo.Coulomb(0.2), 1.0)
    result = tribo.simulate(scene)
    assert isinstance(result, Result)
    result.save(tmp_path / "run.nc")
    data = result_file.load(tmp_path / "run.nc")
    text = page("result_file")
    attributes = re.findall(r"^\| `(\w+)` \|", text.partition("## Attributes")[2], re.M)
    assert set(attributes) == data.attrs.keys()
    for name in data.coords:
        assert f"`{str(name).replace('upper', 'SURFACE').replace('lower', 'SURFACE')}`" in text
