"""A report card for a potential: everything that a run relies on, checked and graded."""

from __future__ import annotations

from typing import Any

from tribo.potentials.from_ase import Live
from tribo.potentials.registry import as_potential
from tribo.potentials.tables import as_table
from tribo.report_card.agreement import check_agreement
from tribo.report_card.ase_peers import check_ase
from tribo.report_card.card import Check, Report
from tribo.report_card.derivatives import check_force, check_minimum, curves
from tribo.report_card.invariances import check_laws, check_work
from tribo.report_card.limits import check_finite, check_limits
from tribo.report_card.motion import check_motion
from tribo.report_card.smoothness import check_cutoff, check_smoothness
from tribo.report_card.specimen import Specimen
from tribo.validation import InputError

__all__ = ["Check", "Report", "check"]


def check(potential: Any, ase: Any = None, symbols: Any = "H2") -> Report:
    """A report card: everything that a run relies on in a potential, checked and graded.

    `ase` is a calculator of the Atomic Simulation Environment to compare with, in eV and Angstrom,
    on two atoms named by `symbols`; Coulomb, LennardJones and Morse have theirs.  The card is
    printed by ``print``, and has ``passed``, ``checks``, ``to_json()`` and ``save_figure(path)``.
    Raises InputError for what is no potential, or does not compile.
    """
    if isinstance(potential, Live):
        raise InputError("potential", "must be one of pairs; give a calculator as ase=")
    specimen = Specimen(as_potential(potential))
    found = curves(specimen)
    checks = [
        check_finite(specimen),
        check_force(found),
        *check_minimum(specimen),
        *check_smoothness(specimen),
        *check_cutoff(specimen),
        check_limits(specimen),
        *check_laws(specimen),
        *check_work(specimen),
        *check_agreement(specimen),
        *check_ase(specimen, ase, symbols),
        *check_motion(specimen),
    ]
    return Report(_name(specimen.potential), tuple(checks), found)


def _name(potential: Any) -> str:
    """The potential's name and parameters, as on a command line."""
    return _written(as_table(potential))


def _written(table: dict[str, Any]) -> str:
    values = dict(table)
    name = str(values.pop("potential"))
    if ".py:" in name:
        name = name.rpartition("/")[2]
    return " ".join([name, *(f"{key}={_shown(value)}" for key, value in values.items())])


def _shown(value: Any) -> str:
    """A parameter: a number, a word, another potential, several of them, or many numbers."""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, dict):
        return f"({_written(value)})"
    if isinstance(value, list):
        dicts = [item for item in value if isinstance(item, dict)]
        return " + ".join(map(_shown, dicts)) if dicts else f"[{len(value)} numbers]"
    return str(value)
