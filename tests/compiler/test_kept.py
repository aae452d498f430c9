"""The types of tuples that compiled code reads from memory."""

from typing import Any, NamedTuple

import pytest

from tribo.compiler.kept import kept_type


class Item(NamedTuple):
    """A number that may be absent, and a tuple of others."""

    numbers: Any


@pytest.mark.parametrize("item", [Item(1.0), Item((1.0,)), Item((1.0, 2.0))])
def test_absent_fields_and_tuples_of_any_length_differ(item):
    """Code for one would read the words of the other at wrong places: a tuple of one, too."""
    assert kept_type(Item(None)) != kept_type(item)
    assert kept_type(item) == kept_type(item)
    assert kept_type(Item(())) != kept_type(item)
