"""Results: the data of a run, with the ways to draw, convert and read it.

This is the only place that joins results with plotting, export and the viewer, which stand between
them; each is loaded when a method is called.
"""

from __future__ import annotations

import json
import tomllib
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tribo.files import netcdf_target, page_target, replace_file, strict_json
from tribo.kernels.status import Status
from tribo.model.identity import opened
from tribo.results import (
    contacts,
    depinning,
    force_averages,
    force_distance,
    friction_loop,
    maps,
    report,
    result_file,
    slips,
)
from tribo.results.citations import citations
from tribo.results.run_result import Cost, RunResult, itself
from tribo.validation import as_path

if TYPE_CHECKING:
    import pandas

    from tribo.plotting.plots import Plots


# The ending of names of tables.
CSV = ".csv"


class Result(RunResult):
    __doc__ = RunResult.__doc__

    friction_force = force_averages.friction_force
    friction_coefficient = force_averages.friction_coefficient
    pull_force = force_averages.pull_force
    time_without_contact = force_averages.time_without_contact
    depinning = depinning.depinning
    contacts = contacts.contacts
    friction_map = maps.friction_map
    loop = friction_loop.loop
    slips = slips.slips
    force_distance = force_distance.force_distance
    velocity_profile = maps.velocity_profile
    to_xarray = result_file.dataset
    __str__ = report.text
    _repr_html_ = report.html

    @property
    def end(self) -> dict[str, Any]:
        """The end state and the cost, as ``tribo run --json`` prints them."""
        return report.end(self)

    def cite(self, style: str = "text") -> str:
        """The papers to cite: the model's, and those of the method, potentials and effects.

        Parameters
        ----------
        style : "text" or "bibtex"
            "text" for a line each, "bibtex" for BibTeX entries.
        """
        return citations(self.scene, self.method, style)

    def to_json(self) -> str:
        """The property `end` as one object of strict JSON; numbers that are not finite are null."""
        return strict_json(self.end)

    def __repr__(self) -> str:
        return str(self)

    def save(self, path: str | Path) -> None:
        """Write everything to a NetCDF file that :func:`tribo.load_result` reads, or CSV.

        Parameters
        ----------
        path : str or Path
            The file, which is replaced if it exists.  A name that ends in .csv makes a table of
            all series alone, without the scene and the error estimates: a row for each time, and a
            column for each quantity, as ``upper.W``, and for each asperite if a surface has
            several, as ``upper.theta[3]``.

        Raises
        ------
        InputError
            If the file cannot be written, or its name ends in neither .nc nor .csv.
        """
        path = as_path(path)
        if path.suffix.lower() == CSV:
            from tribo.export.tables import save_csv

            save_csv(self, path)
        else:
            result_file.save(self, netcdf_target("path", path, " or .csv"))

    @property
    def plot(self) -> Plots:
        """The plots, as ``result.plot.work()``: see :class:`tribo.plotting.Plots`."""
        from tribo.plotting.plots import Plots

        return Plots(self)

    def animate(self, path: str | Path, **settings: Any) -> Path:
        """Write a moving picture of the run with its works: GIF, or MP4 if ffmpeg is installed.

        Parameters
        ----------
        path : str or Path
            The file, which is replaced if it exists; its name ends in .gif or .mp4.
        **settings
            ``frames`` (120, evenly spaced in time) and ``rate`` (20 a second) of the pictures,
            ``surface`` whose works are shown (the first), ``width`` (1000 pixels), and ``bath``
            (whether bath oscillators are drawn).
        """
        from tribo.plotting.animation import animate

        return animate(self, path, **settings)

    def to_ase(self, symbols: dict[str, str] | None = None) -> list[Any]:
        """The run as a list of ``ase.Atoms``, one for each sample: bobs, then bars.

        ``ase.io.write("run.traj", result.to_ase())`` and ``"run.extxyz"`` make files that ASE and
        other programs open.  The scene's unit of length is read as Angstrom, its unit of energy as
        eV, its unit of mass as u; ASE's unit of time, A sqrt(u/eV), is then the scene's.

        Parameters
        ----------
        symbols : dict of str to str, optional
            Elements of the bobs by surface, as ``{"upper": "Si"}``; without it their species, and
            "X" where these are no elements, as for bars.

        Returns
        -------
        list of ase.Atoms
            With masses, velocities, charges, contact energy and contact forces f1 (none act on
            bars).  Tags number the surfaces; the array "is_bar" tells bars from bobs; "theta" and
            "phi" are the angles of the asperite [rad]; a .traj file drops these three.  `info` has
            the time and the series of the system.

        Raises
        ------
        InputError
            A symbol is no element, a surface does not exist, a calculator of the scene fails, or
            the places of single asperites were not kept.
        """
        from tribo.export.ase_atoms import to_ase

        return to_ase(self, symbols)

    def to_pandas(self) -> pandas.DataFrame:
        """All series as a table of pandas: a row for each time.

        Returns
        -------
        pandas.DataFrame
            Columns (surface, asperite, quantity): ``frame["upper", 0, "theta"]``.  Quantities of a
            whole surface have the asperite "all", those of the system the surface "system".
        """
        from tribo.export.tables import ledger_table

        return ledger_table(self)

    def end_to_pandas(self) -> pandas.DataFrame:
        """The end state as a table of pandas: a row for each (surface, asperite)."""
        from tribo.export.tables import end_table

        return end_table(self)

    def to_html(self, path: str | Path, bath: bool = False) -> Path:
        """Write a page that plays the run in a browser: one file that loads nothing else.

        Parameters
        ----------
        path : str or Path
            The file, which is replaced if it exists.
        bath : bool
            Whether bath oscillators are drawn, as dots behind their bars with magnified
            displacements; the scene's output must ask for the series "oscillators".

        Raises
        ------
        InputError
            If the file cannot be written or does not end on .html, or the positions of asperites,
            or of requested oscillators, are not recorded.
        """
        from tribo.viewer.contents import contents
        from tribo.viewer.html import document

        path = as_path(path)
        page_target("path", path)
        replace_file(path, document({"run": contents(self, bath), "sliders": []}).encode())
        return path

    def widget(self) -> Any:
        """The page as an ``anywidget.AnyWidget`` of a notebook (extra ``notebook``).

        A notebook that is exported shows the :func:`tribo.live` page of the scene instead, or this
        page where the scene cannot go into one.
        """
        import tribo  # whose public names are found when they are used
        from tribo.viewer.contents import contents
        from tribo.viewer.widget import Player

        source = {"run": contents(self), "sliders": []}
        return Player(source, live=lambda: tribo.live(self.scene))


def load_result(path: str | Path) -> Result:
    """Read a result from the file that :meth:`tribo.Result.save` wrote.

    Raises
    ------
    InputError
        If there is no such file, or it contains no result, as a scene file.
    """
    path = as_path(path)
    data = result_file.load(path)
    settings, stamps = (json.loads(data.attrs[name]) for name in ("settings", "plugins"))
    scene = opened(tomllib.loads(data.attrs["scene"]), stamps, path.parent)
    bounds = json.loads(data.attrs["error_estimate"])
    return Result(
        scene=scene,
        status=Status(data.attrs["status"]),
        method=data.attrs["method"],
        why=data.attrs["why"],
        accuracy=json.loads(data.attrs["accuracy"]),
        met=json.loads(data.attrs["met"]),
        notes=tuple(json.loads(data.attrs["notes"])),
        bounds={name: bound for name, bound in bounds.items() if bound is not None},
        assemble=partial(itself, result_file.ledger_of(data, scene)),
        add_up=partial(itself, Cost(**json.loads(data.attrs["cost"]))),
        take_state=partial(itself, result_file.state_in(data, scene)),
        settings=settings,
        version=data.attrs["version"],
    )
