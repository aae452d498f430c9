"""Report cards: every property of a potential that a run relies on, checked and graded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tribo.model.interaction import Interaction
from tribo.plugins.classes import is_named
from tribo.potentials.tables import as_table
from tribo.report_card.agreement import (
    check_agreement,
    check_ase,
    check_charges,
    check_third_law,
)
from tribo.report_card.card import Check, Report
from tribo.report_card.derivatives import check_force, check_minimum, curves
from tribo.report_card.limits import check_finite, check_limits
from tribo.report_card.points import check_points
from tribo.report_card.scan import PotentialScan
from tribo.report_card.smoothness import check_cutoff, check_smoothness
from tribo.validation import InputError

if TYPE_CHECKING:
    from ase.calculators.calculator import Calculator

__all__ = ["Check", "Report", "check"]


def check(
    potential: object, ase: Calculator | None = None, symbols: str | Sequence[str] = "H2"
) -> Report:
    """Check every property of a potential that a run relies on, and grade the errors.

    Parameters
    ----------
    potential : Potential or NamedTuple
        A potential, of this package or the user's own.
    ase : ase.calculators.calculator.Calculator, optional
        A calculator of the Atomic Simulation Environment to compare with, in eV and Angstrom.
        Without it, Coulomb, LennardJones and Morse are compared with those of ASE.
    symbols : str or sequence of str
        The two atoms that the calculator is given, as "H2" or ["Na", "Cl"].

    Returns
    -------
    Report
        It has ``passed``, ``checks``, ``to_json()`` and ``save_figure(path)``, and can be printed.

    Raises
    ------
    InputError
        If it is not a potential between pairs of bobs, or does not compile, or the calculator
        fails.
    """
    interaction = Interaction(potential)
    if interaction.calculator is not None:
        name = as_table(potential)["calculator"]
        raise InputError(
            "potential",
            "must be a potential of pairs; check two atoms, as in: tribo "
            f"check ase-dimer calculator={name} "
            """symbols='["Cu", "Cu"]' low=2 high=5 tolerance=1e-3 many_body=true""",
        )
    scan = PotentialScan(interaction.potential)
    found = curves(scan)
    checks = [
        check_finite(scan),
        check_force(found, scan.has_derived_force),
        *check_minimum(scan),
        *check_smoothness(scan),
        *check_cutoff(scan),
        *check_points(scan),
        check_limits(scan),
        check_third_law(scan),
        check_charges(scan),
        *check_agreement(scan),
        *check_ase(scan, ase, symbols),
    ]
    table = as_table(scan.potential)
    return Report(_named(table), _named(table, short=True), tuple(checks), found)


def _named(table: dict[str, object], short: bool = False) -> str:
    """A potential's name and parameters, as on a command line; the short name has no file."""
    values = dict(table)
    name = str(values.pop("potential"))
    if is_named(name):
        name = name.rpartition(":" if short else "/")[2]
    return " ".join([name, *(f"{key}={_as_text(value, short)}" for key, value in values.items())])


def _as_text(value: object, short: bool) -> str:
    """A parameter: a number, a word, a potential, several potentials, or many numbers."""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, dict):
        return f"({_named(value, short)})"
    if isinstance(value, list):
        dicts = [_as_text(item, short) for item in value if isinstance(item, dict)]
        return " + ".join(dicts) if dicts else f"[{len(value)} numbers]"
    return str(value)
