"""Settings shared by all tests."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

# Linear algebra on small matrices is slower with threads.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# numba colours the messages of thousands of errors that it catches: a few per cent of the time.
os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.database import DirectoryBasedExampleDatabase

from support.forked import Server

# Failing examples of any profile are kept here and are tried first from then on.
FAILURES = DirectoryBasedExampleDatabase(Path(__file__).parents[1] / ".hypothesis" / "examples")

# The same examples each time, few of them, since many compile a time loop of their own.  No
# deadline for the same reason.
settings.register_profile(
    "repeatable",
    deadline=None,
    derandomize=True,
    max_examples=12,
    suppress_health_check=[HealthCheck.too_slow],
)
# hypothesis accepts a database beside derandomize only as a change of other settings.
settings.register_profile("ci", settings.get_profile("repeatable"), database=FAILURES)
# Other examples each time, and more: pytest --hypothesis-profile=search
settings.register_profile("search", settings.get_profile("ci"), derandomize=False, max_examples=50)
settings.load_profile("ci")


# Tests that compile loops of their own for ten seconds or more, beside quicker ones of their kind.
SLOW = frozenset(Path(__file__).with_name("slow_tests.txt").read_text("utf-8").splitlines())


def pytest_configure(config: pytest.Config) -> None:
    """Compile in one process each where pytest-xdist has one for every core."""
    if hasattr(config, "workerinput"):
        from tribo.compiler import helpers

        helpers.MOST_PROCESSES = 1


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of `slow_tests.txt`, whose names are as pytest prints them."""
    for item in items:
        if item.nodeid in SLOW:
            item.add_marker("slow")


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    """Runs programs in new processes."""
    with Server() as started:
        yield started


@pytest.fixture
def heeded() -> Iterator[None]:
    """SIGINT raises KeyboardInterrupt; shells switch it off for what they run in the background."""
    usual = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, usual)
