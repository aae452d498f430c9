"""Quantities of the user's own: a formula of recorded series, time by time."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from tribo.layout.layout import Layout
from tribo.ledger import quantities
from tribo.ledger import quantity as entries
from tribo.ledger.ledger import Series
from tribo.ledger.quantities import (
    ASPERITE,
    EVERY_QUANTITY,
    FURTHER,
    INPUTS,
    OF,
    OWN_SERIES,
    SURFACE,
    SYSTEM,
    WITHOUT_ACCURACY,
)
from tribo.ledger.reported import built_in_names, reported
from tribo.ledger.totals import SurfaceSeries, SystemSeries
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.validation import InputError, choice, is_list, must_be

# The parameters of asperites that a formula can take.
PARAMETERS = ("mass", "inertia", "kappa", "l1", "l2", "i2", "bar_length")
# Relative difference of two values that differ by round-off alone.
ROUNDING = 1e-9
OF_NO_SURFACE = "cannot be taken of the system, but of a surface"
Source = SurfaceSeries | SystemSeries


class NotRecordedError(InputError, KeyError):
    """A series that a formula takes and a run does not record."""

    def __str__(self) -> str:
        return f"{self.field}: {self.problem}"


class Values(Mapping[str, np.ndarray]):
    """What a formula takes: the series that its quantity can use, and parameters of asperites.

    Series of asperites are (times, asperites), others (times,).  Without `uses`, ``get(name, 0.0)``
    gives a value in place of a series that the run does not record.
    """

    def __init__(
        self,
        series: Series,
        absence: Callable[[str], InputError],
        parameter: Callable[[str], np.ndarray],
        rows: slice = slice(None),
    ) -> None:
        """Take the series, the errors of others by their names, and parameters by their names."""
        self._series = series
        self._absence = absence
        self._parameter = parameter
        self._rows = rows

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._series:
            raise self._absence(name)
        return self._series[name][self._rows]

    def __contains__(self, name: object) -> bool:
        return name in self._series

    def __iter__(self) -> Iterator[str]:
        return iter(self._series)

    def __len__(self) -> int:
        return len(self._series)

    def parameter(self, name: str) -> np.ndarray:
        """A parameter of the surface's asperites, (1, asperites) or (times, asperites).

        It is one of mass, inertia, kappa, l1, l2, i2 and bar_length, in the units of the scene.
        """
        found = self._parameter(choice("parameter", name, PARAMETERS))
        return found if len(found) == 1 else found[self._rows]

    def at_end(self) -> "Values":
        """The same at the last time alone."""
        return Values(self._series, self._absence, self._parameter, slice(-1, None))


class Quantity:
    """A recorded quantity of one's own, by a formula of other series.

    Once it is made, its name can stand wherever the name of a quantity can in this process:
    ``output.keep``, ``ensemble(keep=)`` and ``sweep(keep=)``.  A single run reports it where
    ``output.series`` contains "own", and the words for the series that its formula takes.  It has
    no accuracy and no error estimate.

    Parameters
    ----------
    name : str
        A word of letters, digits and underscores, which is no name of another quantity.
    formula : callable
        A function of a mapping of series by name, and whose ``parameter(name)`` gives mass,
        inertia, kappa, l1, l2, i2 or bar_length of the asperites.  It returns (times, asperites)
        of asperites, and (times,) of a surface or the system.  The value at a time follows from
        the series at that time.
    unit : str
        The kind of its unit: "angle", "rate", "length", "velocity", "energy", "power", "force" or
        "share".
    of : str
        "asperite", "surface" or "system".
    uses : sequence of str, optional
        Names of the series that the formula takes; of the system, also as "upper.W".  The
        quantity is reported where all of them are, and ensembles and sweeps record these alone.
        Without it, the formula can take every series that the run records of what the quantity is
        of, and ensembles and sweeps record forces, energies and contacts at all times, which takes
        more time and memory.  A call with ones finds where the quantity is reported: not where the
        formula takes a series that is not recorded.
    long_name : str
        Its meaning in a few words.

    Raises
    ------
    InputError
        If the name is taken, a word is none of those above, or no quantity has a name in `uses`.
    """

    def __init__(
        self,
        name: str,
        formula: Callable[[Values], np.ndarray],
        *,
        unit: str,
        of: str,
        uses: Sequence[str] | None = None,
        long_name: str = "a quantity of the user's own",
    ) -> None:
        """Check the quantity, and enter it in the tables of all quantities.  Raises InputError."""
        if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z]\w*", name):
            raise must_be("name", "a word of letters, digits and underscores", name)
        if name in EVERY_QUANTITY and name not in OWN_SERIES:
            raise InputError("name", f'is that of a quantity of tribo, "{name}"; give another one')
        if not callable(formula):
            raise must_be("formula", "a function of the series that it uses", formula)
        self.name = name
        self.of = choice("of", of, OF)
        self.uses = None if uses is None else _checked_names(uses, of)
        self._formula = formula
        entry = entries.Quantity(
            choice("unit", unit, entries.UNITS), long_name, self._compute, self._is_present
        )
        for kind, table in zip(OF, WITHOUT_ACCURACY, strict=True):
            table.pop(name, None)
            if kind == of:
                table[name] = entry
        OWN_SERIES[name] = EVERY_QUANTITY[name] = entry
        taken = EVERY_QUANTITY.keys() - OWN_SERIES.keys() if self.uses is None else self.uses
        INPUTS[name] = frozenset(each.rpartition(".")[2] for each in taken)
        reported.cache_clear()

    def __repr__(self) -> str:
        uses = "every series" if self.uses is None else ", ".join(self.uses)
        return f"<Quantity {self.name!r} of {self.of} from {uses}>"

    def _is_present(self, scene: Scene, surface: Surface) -> bool:
        """Whether a scene reports all series that it uses, or takes from series of ones."""
        shapes = _shapes(scene, surface, self.of)
        if self.uses is not None:
            return all(name in shapes for name in self.uses)
        series = Series(shapes, lambda name: np.ones(shapes[name]))
        ones = partial(_ones, None if self.of == SYSTEM else surface.count)
        try:
            with np.errstate(all="ignore"):
                self._formula(Values(series, self._absence, ones))
        except NotRecordedError:
            return False
        except Exception:  # numbers of a run may suit the formula where ones do not
            return True
        return True

    def _compute(self, source: Source) -> np.ndarray:
        """Its series.  Raises InputError where the formula gives no such series."""
        names = self.uses
        if names is None:
            layout, index = _place(source)
            names = tuple(_shapes(layout.scene, layout.scene.surfaces[index], self.of))
        series = Series(names, partial(_series_of, source))
        values = Values(series, self._absence, partial(_parameter_of, source))
        found = self._values(values)
        rows = source.samples.t.size
        shape: tuple[int, ...] = (rows,)
        if self.of == ASPERITE:
            assert isinstance(source, SurfaceSeries)
            shape = (rows, sum(span.velocity.shape[1] for span in source.spans))
        if found.shape != shape:
            problem = f"must be of the shape {shape}, got {found.shape} from the formula"
            raise InputError(self.name, problem)
        last = self._values(values.at_end())
        if not np.allclose(last, found[-1:], rtol=ROUNDING, atol=0.0, equal_nan=True):
            problem = "must follow from the series at the same time, but depends on other times"
            raise InputError(self.name, problem)
        return found

    def _absence(self, full: str) -> InputError:
        """The error of a formula that takes a series that is not there for it."""
        if self.uses is not None:
            return InputError(full, f"is not in uses, which has {', '.join(self.uses)}; add it")
        try:
            _check_name(full, full, self.of)
        except InputError as error:
            return error
        name = full.rpartition(".")[2]
        words = " or ".join(f'"{word}"' for word, group in FURTHER.items() if name in group)
        cure = f"add {words} to output.series" if words else "the scene does not report it"
        return NotRecordedError(full, f"is not recorded; {cure}, or take get({full!r}, 0.0)")

    def _values(self, values: Values) -> np.ndarray:
        """What the formula gives.  Raises InputError with its error, if there is one."""
        try:
            return np.asarray(self._formula(values), float)
        except InputError as error:
            raise error.under(self.name) from None
        except Exception as error:  # a user's formula may raise anything
            raise InputError(self.name, f"{type(error).__name__}: {error}") from error


def _checked_names(uses: Sequence[str], of: str) -> tuple[str, ...]:
    """The names of quantities of tribo that a quantity uses.  Raises InputError for others."""
    if not is_list(uses) or len(uses) == 0:
        raise must_be("uses", 'a list of quantities, as ["w1", "omega"]', uses)
    for i, full in enumerate(uses):
        _check_name(f"uses[{i}]", str(full), of)
    return tuple(map(str, uses))


def _check_name(field: str, full: str, of: str) -> None:
    """Refuse a name that is none of a series of tribo's that a quantity can use."""
    surface, _, kind = full.rpartition(".")
    if kind not in EVERY_QUANTITY or kind in OWN_SERIES:
        raise must_be(field, "the name of a quantity of tribo", full)
    if bool(surface) != (of == SYSTEM and kind not in quantities.OF_SYSTEM):
        wanted = 'one of the system, or as "upper.W"' if of == SYSTEM else 'as "w1"'
        raise must_be(field, wanted, full)


def _tables(scene: Scene, surface: Surface, of: str) -> Mapping[str, entries.Quantity]:
    """The quantities of tribo that a scene reports of a surface, or of the system."""
    found = reported(scene.output.ledger, built_in_names(scene, surface))
    return found.system if of == SYSTEM else {**found.asperites, **found.blocks}


def _shapes(scene: Scene, surface: Surface, of: str) -> dict[str, tuple[int, ...]]:
    """The series of tribo that a quantity can use, and their shapes at one time.

    Of a surface its own; of the system those of the system, and of surfaces as "upper.W".
    """
    if of == SYSTEM:
        shapes: dict[str, tuple[int, ...]] = dict.fromkeys(
            _tables(scene, scene.surfaces[-1], SYSTEM), (1,)
        )
        for each in scene.surfaces:
            own = _shapes(scene, each, SURFACE)
            shapes |= {f"{each.name}.{name}": shape for name, shape in own.items()}
        return shapes
    found = reported(scene.output.ledger, built_in_names(scene, surface))
    return dict.fromkeys(found.asperites, (1, surface.count)) | dict.fromkeys(found.blocks, (1,))


def _ones(count: int | None, name: str) -> np.ndarray:
    """A parameter of so many asperites that are all alike; None of the system."""
    if count is None:
        raise InputError("parameter", OF_NO_SURFACE)
    return np.ones((1, count))


def _parameter_of(source: Source, name: str) -> np.ndarray:
    """A parameter of the asperites of a surface, (1, asperites) or (times, asperites)."""
    if not source.spans:
        raise InputError("parameter", OF_NO_SURFACE)
    parts = [np.atleast_2d(getattr(span.asperites, name)) for span in source.spans]
    return np.concatenate(parts, axis=1)


def _place(source: Source) -> tuple[Layout, int]:
    """The layout of a source, and the index of its surface, or of the last for the system."""
    if isinstance(source, SystemSeries):
        return source.layout, -1
    return source.place


def _series_of(source: Source, full: str) -> np.ndarray:
    """A series of the surface or the system that a formula is for."""
    name, _, kind = full.rpartition(".")
    if isinstance(source, SystemSeries) and not name:
        scene = source.layout.scene
        return _tables(scene, scene.surfaces[-1], SYSTEM)[kind].of(source)
    if isinstance(source, SystemSeries):
        source = source.wholes[list(source.layout.parts).index(name)]
    layout, index = source.place
    return _tables(layout.scene, layout.scene.surfaces[index], SURFACE)[kind].of(source)
