"""The methods of a result that draw and convert it.

What they do is in folders above this one, which are loaded by name when a method is called.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas


class Presentation:
    """Methods of :class:`tribo.Result`."""

    @property
    def plot(self) -> Any:
        """Plots, each with ``ax=None``, that return the Axes.

        ``angles()``, ``work()``, ``energy_budget()``, ``snapshots()`` and ``phase()``: see
        :class:`tribo.plotting.Plots`.
        """
        return import_module("tribo.plotting").Plots(self)

    def animate(self, path: str | Path, **settings: Any) -> Path:
        """Write a moving picture of the run with its works: GIF, or MP4 if ffmpeg is installed.

        Parameters
        ----------
        path : str or Path
            The file, which is replaced if it exists; its name ends on .gif or .mp4.
        **settings
            ``frames``, ``rate``, ``surface``, ``dpi`` and ``bath`` of
            :func:`tribo.plotting.animate`.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            If the name ends otherwise, ffmpeg is missing, or the file cannot be written.
        """
        written: Path = import_module("tribo.plotting").animate(self, path, **settings)
        return written

    def to_ase(self, symbols: dict[str, str] | None = None) -> list[Any]:
        """The run as a list of ``ase.Atoms``, one for each sample: bobs, then bars.

        ``ase.io.write("run.traj", result.to_ase())`` and ``"run.extxyz"`` make files that ASE and
        other programs open.

        Parameters
        ----------
        symbols : dict of str to str, optional
            Elements of the bobs by surface, as ``{"upper": "Si"}``; without it their species.

        Returns
        -------
        list of ase.Atoms
            With masses, velocities, charges, contact energy and contact forces: see
            :func:`tribo.export.ase_atoms.to_ase`.  Numbers are in the scene's units.

        Raises
        ------
        InputError
            If a symbol is no element, or a surface does not exist.
        """
        images: list[Any] = import_module("tribo.export.ase_atoms").to_ase(self, symbols)
        return images

    def to_pandas(self) -> pandas.DataFrame:
        """All series as a table of pandas: a row for each time.

        Returns
        -------
        pandas.DataFrame
            Columns (surface, asperite, quantity): ``frame["upper", 0, "theta"]``.  Quantities of a
            whole surface have the asperite "all", those of the system the surface "system".
        """
        table: pandas.DataFrame = import_module("tribo.export.pandas_tables").ledger_table(self)
        return table

    def end_to_pandas(self) -> pandas.DataFrame:
        """The end state as a table of pandas: a row for each asperite, a column a quantity.

        Returns
        -------
        pandas.DataFrame
            Indexed by (surface, asperite).
        """
        table: pandas.DataFrame = import_module("tribo.export.pandas_tables").end_table(self)
        return table
