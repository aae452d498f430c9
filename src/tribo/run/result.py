"""The result of a run: time series, the end, error estimates and cost."""

from __future__ import annotations

import importlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from tribo.files import netcdf_path
from tribo.kernels.status import MEANINGS, Status
from tribo.model.scene import Scene
from tribo.run import dataset, report
from tribo.run.averages import Average
from tribo.run.cost import Cost
from tribo.run.force_averages import force_average, friction_series, recorded_averages
from tribo.run.identity import Identity
from tribo.run.ledger import Ledger, Series
from tribo.run.presentation import Presentation
from tribo.run.quantities import Table
from tribo.run.state import State
from tribo.validation import InputError, as_path

if TYPE_CHECKING:
    import xarray

T = TypeVar("T")

# The ending of names of tables.
CSV = ".csv"


@dataclass(frozen=True, eq=False)
class Known(Generic[T]):
    """A value that is known already, in place of a function that computes it."""

    value: T

    def __call__(self) -> T:
        """The value."""
        return self.value


@dataclass(eq=False)
class Result(Presentation):
    """The result of a run.

    ``result["upper"].theta`` is an array (times, asperites) in the scene's units,
    ``result.system["applied_work"]`` one of (times,).

    Attributes
    ----------
    scene : Scene
        The scene that was run.
    t : ndarray, (times,)
        The recorded times [time].
    ledger : Ledger
        All series; assembled from the raw samples when first needed.
    system : dict
        The series of the system: quantity -> (times,).
    end : dict
        The end state and the cost, as ``tribo run --json`` prints them.
    status : Status
        "completed", or the name of what stopped the run.
    method : str
        The integration method.
    why : str
        The reason for the method; empty if it was given.
    cost : Cost
        Steps, force evaluations and times.
    accuracy : float, dict or None
        The requested accuracy, or one for each observable by name; None where a method
        and a step were given.
    met : bool or None
        Whether every error estimate is within the accuracy; None without estimates.
    notes : tuple of str
        Anything else that a reader of the result should know.
    error_estimate : dict
        Quantity -> bound on its error over all surfaces, asperites and times; None if unknown.
    settings : dict
        Method, accuracy, step, and the hash of the state where the run began, if it did.
    version : str
        The version of tribo that ran it, with the hash of its sources.
    """

    scene: Scene
    status: Status  # "completed", or the name of what stopped the run
    method: str
    why: str  # the method was chosen; empty where it was given
    accuracy: float | Mapping[str, float] | None  # asked for: one number, or one per observable
    met: bool | None  # whether every error estimate is within the accuracy; None without estimates
    notes: tuple[str, ...]
    bounds: Mapping[str, float] = field(repr=False)  # on errors, by name; empty without estimates
    assemble: Callable[[], Ledger] = field(repr=False)  # computes the ledger
    add_up: Callable[[], Cost] = field(repr=False)  # computes the cost
    take_state: Callable[[], State] = field(repr=False)  # computes the state at the end
    settings: Identity = field(repr=False)  # see tribo.run.identity
    version: str  # of the package that ran it
    # Not a cached_property, whose lock takes a part of the time of a short run.
    _ledger: Ledger | None = field(default=None, init=False, repr=False)

    @property
    def ledger(self) -> Ledger:
        """All series, each computed from the raw samples when it is first read."""
        if self._ledger is None:
            self._ledger = self.assemble()
        return self._ledger

    @cached_property
    def cost(self) -> Cost:
        """Steps, force evaluations and times."""
        return self.add_up()

    @property
    def t(self) -> np.ndarray:
        """The recorded times, (times,)."""
        return self.ledger.t

    @property
    def system(self) -> Table:
        """The series of the system: quantity -> (times,)."""
        return self.ledger.system

    @cached_property
    def error_estimate(self) -> dict[str, float | None]:
        """Quantity -> bound on its error over all surfaces, asperites and times, or None."""
        asked = self.accuracy if isinstance(self.accuracy, Mapping) else ()
        return dict.fromkeys([*self.ledger.names, *asked]) | dict(self.bounds)

    def __getitem__(self, surface: str) -> Series:
        ledger = self.ledger
        try:
            return ledger.of(surface)
        except KeyError:
            names = ", ".join(ledger.surfaces)
            raise KeyError(f"there is no surface {surface!r}; there are {names}") from None

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled or copied: the ledger, the cost and the state, without the runs."""
        return {
            **self.__dict__,
            "assemble": Known(self.ledger),
            "add_up": Known(self.cost),
            "take_state": Known(self.state()),
        }

    def friction_force(
        self, surface: str, after: float | str | None = None, part: str | None = None
    ) -> Average:
        """The time average of the friction force on a surface, with a 95 % interval.

        The friction force is the x component of what resists sliding: the sum of all contact
        forces f1 and of all forces of external fields.  It is negative on a surface that slides
        towards positive x.  The scene's output must ask for the series "forces".

        Parameters
        ----------
        surface : str
            Name of the surface.
        after : float or "auto", optional
            When the average begins, as in :func:`tribo.time_average`; by default at the scene's
            ``output.run_in`` [time].
        part : "contact" or "field", optional
            One of the two; both without it.

        Returns
        -------
        Average
            As of :func:`tribo.time_average` [force].  Its note says where a run stopped.

        Raises
        ------
        InputError
            The forces were not recorded, no field acts on the surface, or there are fewer than two
            samples.
        """
        name = friction_series(self.scene, surface, part)
        return force_average(self, f"{surface}.{name}", after)

    def pull_force(self, surface: str, after: float | str | None = None) -> Average:
        """The time average of the drive's force on a surface, with a 95 % interval.

        It is the x component of the sum of f2 over the asperites: of the springs of a pulled
        surface, or of the reaction that holds driven bars.  It is positive on a surface that is
        pulled towards positive x.  The scene's output must ask for the series "forces".

        Parameters
        ----------
        surface : str
            Name of the surface.
        after : float or "auto", optional
            When the average begins, as in :func:`tribo.time_average`; by default at the scene's
            ``output.run_in`` [time].

        Returns
        -------
        Average
            As of :func:`tribo.time_average` [force].  Its note says where a run stopped.

        Raises
        ------
        InputError
            The forces were not recorded, or there are fewer than two samples.
        """
        return force_average(self, f"{surface}.pull_force", after)

    def time_without_contact(self, surface: str, after: float | None = None) -> float:
        """The share of time in which no bob of a surface is in contact with another surface.

        Two bobs are in contact within the range of their potential.  Where it decays without an
        end, they are if their energy is at least 1 % of the sum of the energy of torsion by 1 rad
        of the softest asperite and of k_B T.  The scene's output must ask for the series "forces".

        Parameters
        ----------
        surface : str
            Name of the surface.
        after : float, optional
            When the average begins; by default the scene's ``output.run_in`` [time].

        Returns
        -------
        float
            Between 0 and 1.

        Raises
        ------
        InputError
            The contact was not recorded, or has no range, as that of Coulomb, or there are fewer
            than two samples.
        """
        series = self[surface]
        if "time_without_contact" not in series and not self.ledger.kept:
            raise InputError(
                "output.series",
                'does not contain "forces", or the contact has no range: time_without_contact is '
                "not recorded",
            )
        later = self.t >= (self.scene.output.run_in if after is None else after)
        t, without = self.t[later], series["time_without_contact"][later]
        if t.size < 2:
            raise InputError("after", f"leaves {t.size} samples, and a share of time takes two")
        return float(np.sum(0.5 * (without[1:] + without[:-1]) * np.diff(t)) / (t[-1] - t[0]))

    def oscillators(self, surface: str) -> np.ndarray:
        """The displacements of the bath oscillators of a surface from their bars.

        The scene's output must ask for the series "oscillators".  Torsional oscillators are not
        among them.

        Parameters
        ----------
        surface : str
            Name of the surface.

        Returns
        -------
        ndarray, (times, asperites, oscillators, 2)
            Along x and along y [length].

        Raises
        ------
        InputError
            They were not recorded, or the surface has no such oscillators.
        """
        found = self.ledger.oscillators
        if surface not in found:
            if "oscillators" in self.scene.output.series:
                raise InputError(surface, "has no bath oscillators that move along x and y")
            raise InputError(
                "output.series", 'does not contain "oscillators"; add it, and run again'
            )
        return found[surface]

    def state(self) -> State:
        """The full state at the end, from which :func:`tribo.simulate` continues.

        Returns
        -------
        State
        """
        return self.take_state()

    @property
    def end(self) -> dict[str, Any]:
        """The end state and the cost, as ``tribo run --json`` prints them."""
        ledger = self.ledger.at_end()
        return {
            "status": self.status,
            "t": float(ledger.t[-1]),
            "method": self.method,
            "steps": self.cost.steps,
            "force_evaluations": self.cost.force_evaluations,
            "wall_seconds": self.cost.wall_seconds,
            "compile_seconds": self.cost.compile_seconds,
            "seconds_for_digit_more": self.cost.digit_more,
            "seconds_for_digit_fewer": self.cost.digit_fewer,
            "why": self.why,
            "accuracy": self.accuracy,
            "accuracy_met": self.met,
            "notes": list(self.notes),
            "surfaces": {
                name: {key: values[-1].tolist() for key, values in table.items()}
                for name, table in ledger.surfaces.items()
            },
            "blocks": {
                name: {key: float(values[-1]) for key, values in table.items()}
                for name, table in ledger.blocks.items()
            },
            "system": {key: float(values[-1]) for key, values in ledger.system.items()},
            "error_estimate": dict(self.error_estimate),
            **recorded_averages(self),
            **self.shares_without_contact(),
        }

    def shares_without_contact(self) -> dict[str, dict[str, float]]:
        """The share of time without contact of every surface, where it is recorded, by name."""
        if np.count_nonzero(self.t >= self.scene.output.run_in) < 2:
            return {}
        names = [n for n, b in self.ledger.blocks.items() if "time_without_contact" in b]
        shares = {name: self.time_without_contact(name) for name in names}
        return {"time_without_contact": shares} if shares else {}

    @property
    def shortcoming(self) -> str:
        """The reason why the run missed its request, in one sentence; empty if it did not."""
        if self.status != Status.COMPLETED:
            return f"the run stopped at t = {self.t[-1]:g}, {self.status}: {MEANINGS[self.status]}"
        return f"the accuracy is not met: {self.notes[-1]}" if self.met is False else ""

    def to_json(self) -> str:
        """The property `end` as strict JSON, as ``tribo run --json`` prints it.

        Returns
        -------
        str
            One JSON object; numbers that are not finite are null.
        """
        return json.dumps(without_nan(self.end), indent=1, allow_nan=False)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return report.html(self)

    def __str__(self) -> str:
        return report.text(self)

    def to_xarray(self) -> xarray.Dataset:
        """All series as a labelled data set.

        Returns
        -------
        xarray.Dataset
            ``upper.theta`` (time, upper_asperite), ``upper.W`` and ``applied_work`` (time,), each
            with `units` and `long_name`, and, as ``upper.theta_error``, a bound on its error where
            one is known.  Coordinates ``time``, ``upper_asperite``, and the resting bobs as
            ``upper.x_rest``, ``upper.y_rest`` and ``upper.z_rest``.
        """
        return dataset.dataset(self)

    def save(self, path: str | Path) -> None:
        """Write everything to a NetCDF file that :func:`tribo.load_result` reads, or CSV.

        Parameters
        ----------
        path : str or Path
            The file, which is replaced if it exists.  A name that ends on .csv makes a table of
            all series alone, without the scene and the error estimates: a row for each time, and a
            column for each quantity, as ``upper.W``, and for each asperite if a surface has
            several, as ``upper.theta[3]``.

        Raises
        ------
        InputError
            The file cannot be written, or its name ends on neither .nc nor .csv.
        """
        path = as_path(path)
        if path.suffix.lower() == CSV:
            report.save_csv(self, path)
        else:
            dataset.save(self, netcdf_path("path", path, " or .csv"))

    def to_html(self, path: str | Path, bath: bool = False) -> Path:
        """Write a page that plays the run in a browser: one file that loads nothing else.

        Parameters
        ----------
        path : str or Path
            The file, which is replaced if it exists.
        bath : bool
            Whether bath oscillators are drawn, as dots behind their bars with magnified
            displacements; the scene's output must ask for the series "oscillators".

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            The file cannot be written, or the places of asperites, or of the oscillators that are
            requested, are not recorded.
        """
        # The viewer stands above the results that it shows, so that it is not imported here.
        written: Path = importlib.import_module("tribo.viewer").write_page(self, path, bath)
        return written


def without_nan(value: object) -> object:
    """The same nested data with None for every float that JSON cannot represent."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
