"""What tribo relies on in numba: entry points, files of machine code, methods of plug-ins."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import config, njit

from tribo.compiler.jit import (
    EntryPoint,
    cached_files,
    kernel,
    remove_stale,
    time_loop,
)
from tribo.compiler.kept import keep
from tribo.compiler.numba_private import NATIVE
from tribo.compiler.plugin_methods import recognize
from tribo.compiler.source_stamps import code_stamp
from tribo.pair.loop import pair_collocation


def scaled(factor, x, table, count):
    """A loop with one fixed argument, two arrays and a number."""
    for i in range(count):
        table[i, 0] = factor[0] * x[i]
    return count


def of_a_tuple(item):
    """A loop whose argument contains arrays."""
    return item[0][0] * item[1][0][0]


class One(NamedTuple):
    """A tuple that is kept."""

    values: np.ndarray


class Other(NamedTuple):
    """Another."""

    values: np.ndarray


def of_a_kept_tuple(item):
    """A loop whose argument contains a tuple that is kept, and an array."""
    return item[0].values[0] * item[1][0]


@kernel
def doubled(x):
    """A kernel."""
    return 2.0 * x


def twice_doubled(x):
    """A loop that calls a kernel."""
    return doubled(doubled(x))


@pytest.mark.skipif(not NATIVE, reason="numba links kernels in its own way")
def test_kernels_are_linked():
    """A kernel has no machine code of its own; the loop that calls it contains it."""
    loop = time_loop(twice_doubled, kept=False)
    assert loop(3.0) == 12.0
    (library,) = (compiled.library for compiled in doubled.overloads.values())
    (name,) = (function.name for function in library.get_defined_functions())
    assert type(library).__name__ == "LinkedLibrary"
    assert library.get_pointer_to_function(name) == 0
    (own,) = loop.overloads.values()
    assert f"call double @{name}" not in own.library.get_llvm_str()


@pytest.fixture(scope="module")
def entry_point():
    """Compiled for float64 arrays of one and two dimensions."""
    examples = (np.zeros(1), np.zeros((2, 3)), 0)
    return EntryPoint(time_loop(scaled, kept=False), (np.array([2.0]),), examples)


def test_entry_point(entry_point):
    """It does what the loop does, for arrays of any length."""
    table = np.zeros((5, 3))
    assert entry_point(np.arange(5.0), table, 5) == 5
    assert np.array_equal(table[:, 0], 2.0 * np.arange(5.0))
    assert entry_point(np.zeros((1, 2))[:, 0], np.zeros((1, 3)), 1) == 1  # one element: contiguous


@pytest.mark.parametrize(
    ("x", "message"),
    [
        (np.arange(5), "got int64"),
        (np.arange(5.0, dtype=np.float32), "got float32"),
        (np.arange(5.0).astype(">f8"), "got >f8"),
        (np.arange(10.0)[::2], r"strides \(16,\)"),
        (np.zeros((5, 1)), r"shape \(5, 1\)"),
    ],
)
def test_entry_point_refuses_other_arrays(entry_point, x, message):
    """Another type, byte order, spacing or number of dimensions would be read as what it is not."""
    with pytest.raises(TypeError, match=f"argument 0 must be a C-contiguous.*float64.*{message}"):
        entry_point(x, np.zeros((5, 3)), 5)


def test_entry_point_refuses_other_rows(entry_point):
    """Rows of another length, or in another order."""
    for table in (np.zeros((3, 5)).T, np.zeros((5, 6))[:, ::2]):
        with pytest.raises(TypeError, match="argument 1 must be"):
            entry_point(np.arange(5.0), table, 5)


@pytest.mark.parametrize(
    ("inner", "message"),
    [
        (np.arange(5), "got int64"),
        (np.zeros(10)[::2], r"strides \(16,\)"),
        (1.0, "contain a ndarray, got a float"),
    ],
)
def test_entry_point_looks_into_tuples(inner, message):
    """An array in a tuple would be read as what it is not, too."""
    entry = EntryPoint(time_loop(of_a_tuple, kept=False), (), ((np.zeros(1), (np.zeros(1),)),))
    assert entry((np.full(5, 2.0), (np.full(5, 3.0),))) == 6.0
    with pytest.raises(TypeError, match=f"argument 0 must.*{message}"):
        entry((np.zeros(5), (inner,)))
    with pytest.raises(TypeError, match="must have 2 members, got 1"):
        entry((np.zeros(5),))


def test_entry_point_looks_at_kept_tuples_in_tuples():
    """Whose memory would be read as what it is not."""
    entry = EntryPoint(
        time_loop(of_a_kept_tuple, kept=False), (), ((keep(One(np.ones(1))), np.ones(1)),)
    )
    assert entry((keep(One(np.full(5, 2.0))), np.full(5, 3.0))) == 6.0
    with pytest.raises(TypeError, match="argument 0 must contain a One"):
        entry((keep(Other(np.ones(1))), np.ones(1)))


def test_stale_machine_code_is_removed(tmp_path, monkeypatch):
    """That of other versions of the package; not that of other plug-ins or programs."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    compiled = time_loop.__wrapped__(pair_collocation)
    folder = compiled.stats.cache_path
    kept = [
        f"loop.pair_collocation_{code_stamp()}_-1.py311.nbi",
        f"loop.pair_collocation_{code_stamp()}_0123456789abcdef-1.py311.1.nbc",
        f"loop.another_{code_stamp()}_-1.py311.nbi",
        "loop.pair_collocation-1.py311.nbi",
        "loop.cpython-311.pyc",
    ]
    stale = [
        "loop.pair_collocation_0123456789abcdef_-1.py311.nbi",
        "loop.renamed_0123456789abcdef_-1.py311.nbi",
        "loop.pair_collocation_0123456789abcdef_fedcba9876543210-1.py311.1.nbc",
    ]
    paths = {name: tmp_path / folder / name for name in kept + stale}
    for path in paths.values():
        path.touch()
    assert {path.name for path in cached_files(pair_collocation)} == {*stale, *kept[:3]}
    remove_stale(pair_collocation)
    assert {name for name, path in paths.items() if path.exists()} == set(kept)
    remove_stale(pair_collocation)


def test_a_loop_cleans_up_when_it_is_made(tmp_path, monkeypatch):
    """Two processes may do so at once: a file that is gone already is no error."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    folder = time_loop.__wrapped__(pair_collocation).stats.cache_path
    path = tmp_path / folder / "loop.pair_collocation_0123456789abcdef_-1.py311.nbi"
    path.touch()
    time_loop.__wrapped__(pair_collocation)
    assert not path.exists()
    monkeypatch.setattr("tribo.compiler.jit.cached_files", lambda loop: [path])
    time_loop.__wrapped__(pair_collocation)


class Foreign(NamedTuple):
    """A class of another program with fields that are named like methods of plug-ins."""

    energy: float
    range: float


class Plugin(NamedTuple):
    """A class with one of the methods."""

    scale: float

    def energy(self, r):
        """An energy."""
        return self.scale / r


def test_fields_of_other_classes_are_fields():
    """Methods of plug-ins are found for classes that define them, and for no others."""
    assert njit(lambda item: item.energy - item.range)(Foreign(3.0, 1.0)) == 2.0
    recognize(Plugin(3.0))
    assert njit(lambda item, r: item.energy(r))(Plugin(3.0), 2.0) == 1.5
