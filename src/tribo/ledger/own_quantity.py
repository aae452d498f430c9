"""Quantities of the user's own: a formula of recorded series, time by time."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from tribo.ledger import quantities
from tribo.ledger import quantity as entries
from tribo.ledger.quantities import (
    ASPERITE,
    EVERY_QUANTITY,
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
Source = SurfaceSeries | SystemSeries


class Values(Mapping[str, np.ndarray]):
    """What a formula takes: the series that its quantity uses, and parameters of asperites.

    Series of asperites are (times, asperites), others (times,).
    """

    def __init__(self, series: Mapping[str, np.ndarray], source: Source, rows: slice) -> None:
        self._series = series
        self._source = source
        self._rows = rows

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._series:
            raise InputError(name, f"is not in uses, which has {', '.join(self._series)}; add it")
        return self._series[name][self._rows]

    def __iter__(self) -> Iterator[str]:
        return iter(self._series)

    def __len__(self) -> int:
        return len(self._series)

    def parameter(self, name: str) -> np.ndarray:
        """A parameter of the surface's asperites, (1, asperites) or (times, asperites).

        It is one of mass, inertia, kappa, l1, l2, i2 and bar_length, in the units of the scene.
        """
        choice("parameter", name, PARAMETERS)
        if not self._source.spans:
            raise InputError("parameter", "cannot be taken of the system, but of a surface")
        parts = [np.atleast_2d(getattr(span.asperites, name)) for span in self._source.spans]
        whole = np.concatenate(parts, axis=1)
        return whole if len(whole) == 1 else whole[self._rows]


class Quantity:
    """A recorded quantity of one's own, by a formula of other series.

    Once it is made, its name can stand wherever the name of a quantity can in this process:
    ``output.keep``, ``ensemble(keep=)`` and ``sweep(keep=)``.  A single run reports it where
    ``output.series`` contains "own", and the words for the series that it uses.  It has no
    accuracy and no error estimate.

    Parameters
    ----------
    name : str
        A word of letters, digits and underscores, which is no name of another quantity.
    formula : callable
        A function of a mapping that contains the series in `uses`, and whose ``parameter(name)``
        gives mass, inertia, kappa, l1, l2, i2 or bar_length of the asperites.  It returns (times,
        asperites) of asperites, and (times,) of a surface or the system.  The value at a time
        follows from the series at that time.
    unit : str
        The kind of its unit: "angle", "rate", "length", "velocity", "energy", "power", "force" or
        "share".
    of : str
        "asperite", "surface" or "system".
    uses : sequence of str
        Names of the series that the formula takes; of the system, also as "upper.W".
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
        uses: Sequence[str],
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
        self.uses = _checked_names(uses, of)
        self._formula = formula
        entry = entries.Quantity(
            choice("unit", unit, entries.UNITS), long_name, self._compute, self._is_present
        )
        for kind, table in zip(OF, WITHOUT_ACCURACY, strict=True):
            table.pop(name, None)
            if kind == of:
                table[name] = entry
        OWN_SERIES[name] = EVERY_QUANTITY[name] = entry
        INPUTS[name] = frozenset(each.rpartition(".")[2] for each in self.uses)
        reported.cache_clear()

    def __repr__(self) -> str:
        return f"<Quantity {self.name!r} of {self.of} from {', '.join(self.uses)}>"

    def _is_present(self, scene: Scene, surface: Surface) -> bool:
        """Whether a scene reports all series that it uses."""
        surfaces = {each.name: each for each in scene.surfaces}
        for full in self.uses:
            name, _, kind = full.rpartition(".")
            found = surfaces.get(name) if name else surface
            if found is None or kind not in _tables(scene, found, self.of if not name else ""):
                return False
        return True

    def _compute(self, source: Source) -> np.ndarray:
        """Its series.  Raises InputError where the formula gives no such series."""
        series = {full: _series_of(source, full) for full in self.uses}
        found = self._values(Values(series, source, slice(None)))
        rows = len(next(iter(series.values())))
        shape: tuple[int, ...] = (rows,)
        if self.of == ASPERITE:
            assert isinstance(source, SurfaceSeries)
            shape = (rows, sum(span.velocity.shape[1] for span in source.spans))
        if found.shape != shape:
            problem = f"must be of the shape {shape}, got {found.shape} from the formula"
            raise InputError(self.name, problem)
        last = self._values(Values(series, source, slice(-1, None)))
        if not np.allclose(last, found[-1:], rtol=ROUNDING, atol=0.0, equal_nan=True):
            problem = "must follow from the series at the same time, but depends on other times"
            raise InputError(self.name, problem)
        return found

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
        surface, _, kind = str(full).rpartition(".")
        if kind not in EVERY_QUANTITY or kind in OWN_SERIES:
            raise must_be(f"uses[{i}]", "the name of a quantity of tribo", full)
        if bool(surface) != (of == SYSTEM and kind not in quantities.OF_SYSTEM):
            wanted = 'one of the system, or as "upper.W"' if of == SYSTEM else 'as "w1"'
            raise must_be(f"uses[{i}]", wanted, full)
    return tuple(map(str, uses))


def _tables(scene: Scene, surface: Surface, of: str) -> Mapping[str, entries.Quantity]:
    """The quantities of tribo that a scene reports of a surface, or of the system."""
    found = reported(scene.output.ledger, built_in_names(scene, surface))
    return found.system if of == SYSTEM else {**found.asperites, **found.blocks}


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
