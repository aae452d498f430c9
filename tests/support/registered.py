"""Quantities and methods of the user's own, for the time of a test; a process keeps both."""

from collections.abc import Iterator
from contextlib import contextmanager

from tribo.integrators.methods import METHODS
from tribo.ledger import quantities
from tribo.ledger.reported import reported


@contextmanager
def forgotten() -> Iterator[None]:
    """Forget at the end what a block has registered."""
    known = set(quantities.EVERY_QUANTITY)
    methods = set(METHODS)
    try:
        yield
    finally:
        for name in set(METHODS) - methods:
            del METHODS[name]
        for name in set(quantities.EVERY_QUANTITY) - known:
            for table in (quantities.EVERY_QUANTITY, *quantities.WITHOUT_ACCURACY):
                table.pop(name, None)
            del quantities.OWN_SERIES[name]
            del quantities.INPUTS[name]
        reported.cache_clear()
