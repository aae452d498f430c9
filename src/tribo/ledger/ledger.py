"""The ledger: every reported quantity, from the raw samples of a run.

The identities that must hold, and by which the accounts are audited:

    asperite   w - w_ps = delta_e_int,  w_ps = delta_k_trans
    surface    W_ps = delta_K,  W - W_ps = delta_E_int
    system     total_energy_change = applied_work
"""

from __future__ import annotations

import json
import textwrap
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from tribo.kernels.samples import BATH_ROWS
from tribo.layout.layout import Layout, once_per_scene
from tribo.ledger.forces import Forces
from tribo.ledger.lazy import lazy_property
from tribo.ledger.quantities import EVERY_QUANTITY, FURTHER
from tribo.ledger.quantity import Quantity, Table
from tribo.ledger.reported import (
    Reported,
    names_by_surface,
    needs_accounts,
    reported,
    with_inputs,
)
from tribo.ledger.samples import Samples
from tribo.ledger.totals import SurfaceSeries, SystemSeries
from tribo.validation import InputError, must_be

# Characters of a line of a text that stands for series.
WIDTH = 100


class NotKeptError(InputError, KeyError, AttributeError):
    """A quantity that ``output.keep`` leaves out."""

    def __str__(self) -> str:
        return f"{self.field}: {self.problem}"


class Series(Mapping[str, np.ndarray]):
    """Series by name, as ``series["theta"]`` or ``series.theta``, each computed when first needed.

    Quantities of asperites are (times, asperites), those of a surface as a whole (times,).  `kept`
    are the names in ``output.keep``, where no others were recorded.
    """

    def __init__(
        self,
        names: Collection[str],
        compute: Callable[[str], np.ndarray],
        kept: tuple[str, ...] = (),
    ) -> None:
        """Make series of these `names`, of which `compute` returns one."""
        self._names = names
        self._compute = compute
        self._kept = kept
        self._known: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._known:
            if name not in self._names:
                raise self._absence(name)
            self._known[name] = self._compute(name)
        return self._known[name]

    def __getattr__(self, name: str) -> np.ndarray:
        """A series as an attribute, as `table.w1`."""
        if name[0] == "_":  # a copy asks for methods before it has names
            raise AttributeError(name)
        try:
            return self[name]
        except NotKeptError:
            raise
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def _absence(self, name: str) -> KeyError:
        """The error that says why there is no such series."""
        if self._kept and name in EVERY_QUANTITY:
            return NotKeptError(
                "output.keep",
                f'has only {", ".join(self._kept)}, so that "{name}" was not recorded; add it, and '
                "run again",
            )
        if needs_accounts(name) and not any(map(needs_accounts, self._names)):
            return KeyError(
                f'"{name}" is not kept; works need another output.ledger, as "asperites"'
            )
        return KeyError(f"no quantity {name!r}; there are {', '.join(self._names)}")

    def __repr__(self) -> str:
        text = f"{len(self._names)} series: {', '.join(self._names)}"
        return textwrap.fill(text, WIDTH, subsequent_indent="    ")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._names]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __reduce__(self) -> tuple[Any, ...]:
        return known, (dict(self), self._kept)


def known(table: Table, kept: tuple[str, ...] = ()) -> Series:
    return Series(table, table.__getitem__, kept)


@dataclass(eq=False, repr=False)
class Ledger:
    """All quantities that a run reports, in the laboratory."""

    t: np.ndarray  # (times,)
    surfaces: Mapping[str, Table]  # surface -> quantity -> (times, asperites)
    blocks: Mapping[str, Table]  # surface -> quantity of the surface as a whole -> (times,)
    system: Table  # quantity -> (times,)
    kept: tuple[str, ...] = ()  # names in output.keep; empty where all is recorded
    # Surface with a bath -> displacements of its oscillators from their bars, (times, asperites,
    # oscillators, 2); empty where the scene's output does not ask for them.
    oscillators: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __repr__(self) -> str:
        counts = ", ".join(f'{len(self.of(name))} of "{name}"' for name in self.surfaces)
        return f"Ledger of {self.t.size} times: {counts}, {len(self.system)} of the system"

    def series(self, name: str) -> list[np.ndarray]:
        """All series of a quantity, "w1", or that of one surface, "upper.w1"."""
        surface, _, name = name.rpartition(".")
        tables = [self.system, *self.surfaces.values(), *self.blocks.values()]
        if surface:
            tables = [self.surfaces.get(surface, {}), self.blocks.get(surface, {})]
        return [table[name] for table in tables if name in table]

    @property
    def names(self) -> list[str]:
        tables = [*self.surfaces.values(), *self.blocks.values(), self.system]
        return [name for name in EVERY_QUANTITY if any(name in table for table in tables)]

    def of(self, surface: str) -> Series:
        """All series of a surface.  Raises KeyError if there is no such surface."""
        each = self.surfaces[surface]
        whole = self.blocks[surface]
        names = dict.fromkeys((*each, *whole))
        return Series(names, lambda name: (whole if name in whole else each)[name], self.kept)

    def rows(self, selected: slice | np.ndarray) -> Ledger:
        """The ledger at some of its times: a slice, indices or a mask."""

        def rows_of(table: Table, surface: str) -> Series:
            return Series(table, lambda name: table[name][selected], self.kept)

        oscillators = {name: values[selected] for name, values in self.oscillators.items()}
        return self._of_tables(rows_of, t=self.t[selected], oscillators=oscillators)

    def only(self, keep: Sequence[str]) -> Ledger:
        """The ledger of the named quantities alone, as "upper.W", in arrays of their own."""
        if self.kept:
            return self
        kept = tuple(keep)

        def some(table: Table, surface: str) -> Series:
            before = f"{surface}." if surface else ""
            names = [name for name in table if before + name in kept]
            return known({name: np.array(table[name]) for name in names}, kept)

        return self._of_tables(some, t=np.array(self.t), kept=kept, oscillators={})

    def _of_tables(self, change: Callable[[Table, str], Table], **others: Any) -> Ledger:
        """The ledger of tables that are made from those of this one, and names of surfaces."""
        surfaces = {name: change(table, name) for name, table in self.surfaces.items()}
        blocks = {name: change(table, name) for name, table in self.blocks.items()}
        given: dict[str, Any] = {"t": self.t, "kept": self.kept, "oscillators": self.oscillators}
        given |= others
        return Ledger(surfaces=surfaces, blocks=blocks, system=change(self.system, ""), **given)

    def flat(self) -> dict[str, np.ndarray]:
        """All series by their full names, as "upper.W"."""
        tables = [*self.surfaces.items(), *self.blocks.items()]
        own = {f"{surface}.{name}": table[name] for surface, table in tables for name in table}
        return own | dict(self.system)

    @classmethod
    def of_flat(
        cls, t: np.ndarray, series: Table, surfaces: Iterable[str], kept: tuple[str, ...] = ()
    ) -> Ledger:
        """The ledger of series by their full names, and of the names of all surfaces."""
        # Of each surface those of asperites and those of the surface as a whole.
        tables: dict[str, list[dict[str, np.ndarray]]] = {name: [{}, {}] for name in surfaces}
        system: dict[str, np.ndarray] = {}
        for full, values in series.items():
            surface, _, name = full.rpartition(".")
            (tables[surface][2 - values.ndim] if surface else system)[name] = values
        each = {name: known(own, kept) for name, (own, _) in tables.items()}
        whole = {name: known(own, kept) for name, (_, own) in tables.items()}
        return Ledger(t, each, whole, known(system, kept), kept)

    def at_end(self) -> Ledger:
        """The ledger at the last time alone."""
        return self.rows(slice(-1, None))

    def __reduce__(self) -> tuple[Any, ...]:
        parts = dict(self.surfaces), dict(self.blocks), self.system, self.kept
        return Ledger, (self.t, *parts, dict(self.oscillators))


class SampledLedger(Ledger):
    """The ledger of raw samples, from the start of a run on.

    Tables are made when they are first needed: a run of a pair takes ten microseconds, as long as
    a few of them.
    """

    def __init__(self, layout: Layout, samples: Samples, found: Contents | None = None) -> None:
        """Take samples; `found` are the contents of the layout, if they are known."""
        self.t = samples.t
        self._layout = layout
        self.samples = samples
        self._contents = contents(layout) if found is None else found
        # Those that the surfaces share, once they are asked for.
        self._forces: list[Forces] = []
        self._known: dict[str, SourceSeries] = {}  # by the names of surfaces

    def of(self, surface: str) -> SourceSeries:
        if surface not in self._known:
            quantities, index = self._contents.surfaces[surface]
            source = SurfaceSeries(self._layout, self.samples, index, forces=self._forces)
            self._known[surface] = SourceSeries(quantities, source)
        return self._known[surface]

    @lazy_property
    def surfaces(self) -> Mapping[str, Table]:  # type: ignore[override]
        return self._parts("asperites")

    @lazy_property
    def blocks(self) -> Mapping[str, Table]:  # type: ignore[override]
        return self._parts("blocks")

    @lazy_property
    def system(self) -> Table:  # type: ignore[override]
        wholes = tuple(self.of(name).source for name in self._contents.surfaces)
        source = SystemSeries(self._layout, self.samples, wholes)
        return SourceSeries(self._contents.reported[-1].system, source)

    @lazy_property
    def oscillators(self) -> Mapping[str, np.ndarray]:  # type: ignore[override]
        return _oscillators(self._layout, self.samples)

    def at_end(self) -> Ledger:
        """The ledger at the last time alone, from the samples that it needs."""
        with_forces = "forces" in self._layout.scene.output.series
        few = self.samples.last_interval() if with_forces else self.samples.ends()
        return assemble(self._layout, few).rows(slice(-1, None))

    def _parts(self, group: str) -> dict[str, Table]:
        """The quantities of each surface in a group of `Reported`."""
        each = zip(self._contents.surfaces, self._contents.reported, strict=True)
        return {
            name: Series(getattr(found, group), self.of(name).__getitem__) for name, found in each
        }


class SourceSeries(Series):
    """The series of some asperites, a surface or the system, by the formulas of quantities."""

    def __init__(self, quantities: Mapping[str, Quantity], source: Any) -> None:
        self._names = self._quantities = quantities
        self._kept = ()
        self._known = {}
        self.source = source

    def _compute(self, name: str) -> np.ndarray:
        return self._quantities[name].of(self.source)


class Contents(NamedTuple):
    """What the ledger of a layout contains, whichever the run."""

    reported: tuple[Reported, ...]  # surface by surface
    surfaces: Mapping[str, tuple[Mapping[str, Quantity], int]]  # their quantities, and indices


@once_per_scene
def contents(layout: Layout) -> Contents:
    scene = layout.scene
    found = tuple([reported(scene.output.ledger, names) for names in names_by_surface(layout)])
    each = enumerate(zip(scene.surfaces, found, strict=True))
    surfaces = {one.name: ({**of.asperites, **of.blocks}, index) for index, (one, of) in each}
    return Contents(found, surfaces)


def assemble(layout: Layout, samples: Samples) -> Ledger:
    """The ledger of raw samples from the start of a run on; series are computed when needed."""
    return SampledLedger(layout, samples)


def _oscillators(layout: Layout, samples: Samples) -> dict[str, np.ndarray]:
    """Surface with a bath -> displacements of its oscillators from their bars."""
    rows = samples.baths[:, BATH_ROWS:]
    if rows.shape[1] == 0:
        return {}
    counts = layout.oscillators
    axes = rows.reshape(len(rows), 2, max(counts.values()), rows.shape[2])
    return {
        name: axes[:, :, : counts[name], layout.places.columns[part]].transpose(0, 3, 2, 1)
        for name, part in layout.parts.items()
        if counts[name]
    }


def check_keep(layout: Layout) -> None:
    """Refuse names in ``output.keep`` of quantities that the scene does not report."""
    keep = layout.scene.output.keep
    if keep is None:
        return
    ledger = assemble(layout, Samples.at_zero(layout))
    for i, full in enumerate(keep):
        surface, _, name = full.rpartition(".")
        table: Collection[str] = ledger.system if not surface else ()
        if surface in layout.parts:
            table = ledger.of(surface)
        if name not in table:
            first = next(iter(layout.parts))
            words = [word for word, group in FURTHER.items() if with_inputs([name]) & group.keys()]
            series = f" (this one may need output.series = {json.dumps(words)})" if words else ""
            raise must_be(
                f"output.keep[{i}]",
                f'a quantity of a surface that the scene reports, as "{first}.W" or "{first}.x_cm",'
                f' or one of the system, as "contact_energy"{series}',
                full,
            )
