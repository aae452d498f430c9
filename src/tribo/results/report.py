"""Results for readers: a summary, and a table in a notebook."""

import html as markup
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from tribo.kernels.status import MEANINGS, Status
from tribo.ledger.quantities import BLOCK_QUANTITIES, EVERY_QUANTITY
from tribo.ledger.separation import contact_distance_of
from tribo.model.surface import Surface
from tribo.results import force_averages
from tribo.results.averages import Average, mean_text
from tribo.results.run_result import RunResult

# Quantities of surfaces in the summary, where they are kept.
SHOWN = {name: each.summary for name, each in BLOCK_QUANTITIES.items() if each.summary}


def end(result: RunResult) -> dict[str, Any]:
    """The end state and the cost, as ``tribo run --json`` prints them."""
    ledger = result.ledger.at_end()
    shares = force_averages.shares_without_contact(result)
    scene = result.scene
    distances = {s.name: contact_distance_of(scene, s) for s in scene.surfaces if s.name in shares}
    averages = {}
    for name, by_surface in force_averages.recorded_averages(result).items():
        averages[name] = {surface: average._asdict() for surface, average in by_surface.items()}
    return {
        "status": result.status,
        "t": float(ledger.t[-1]),
        "method": result.method,
        "steps": result.cost.steps,
        "force_evaluations": result.cost.force_evaluations,
        "wall_seconds": result.cost.wall_seconds,
        "compile_seconds": result.cost.compile_seconds,
        "seconds_for_digit_more": result.cost.digit_more,
        "seconds_for_digit_fewer": result.cost.digit_fewer,
        "why": result.why,
        "accuracy": result.accuracy,
        "accuracy_met": result.met,
        "notes": list(result.notes),
        "surfaces": {name: _last(table) for name, table in ledger.surfaces.items()},
        "blocks": {name: _last(table) for name, table in ledger.blocks.items()},
        "system": _last(ledger.system),
        "error_estimate": dict(result.error_estimate),
        **averages,
        **({"time_without_contact": shares, "contact_distance": distances} if shares else {}),
    }


def _last(table: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """The last value of each series, as a number, or as a list of those of all asperites."""
    return {name: values[-1].tolist() for name, values in table.items()}


def _units_of(name: str) -> str:
    """The units of a quantity, or of a surface's, as "upper.W"."""
    quantity = EVERY_QUANTITY.get(name.rpartition(".")[2])
    return "" if quantity is None else quantity.units


def text(result: RunResult) -> str:
    """The summary of a result: what ran, the surfaces at the end, friction, and notes."""
    cost = result.cost
    error = "errors not estimated"
    known = {name: value for name, value in result.error_estimate.items() if value is not None}
    if known:
        # Numbers of one unit can be compared, and energies are what most ask for.
        energies = [known[name] for name in known if _units_of(name) == "energy"]
        of = " of energies" if energies else ""
        error = f"errors{of} up to {max(energies or known.values()):.1e}"
    digits = ""
    if cost.digit_more is not None and cost.digit_fewer is not None:
        digits = f" (one digit more {cost.digit_more:.2g} s, one fewer {cost.digit_fewer:.2g} s)"
    lines = [
        f"{result.scene.title or 'scene'}: {result.status} at t = {result.t[-1]:g}; "
        f"{result.method}, {cost.steps} steps, {cost.force_evaluations} force evaluations, "
        f"{cost.wall_seconds:.3g} s{digits}; {error}"
    ]
    if result.status != Status.COMPLETED:
        lines.append(f"  {MEANINGS[result.status]}")
    if result.ledger.kept:
        lines.append(f"  only {', '.join(result.ledger.kept)} are recorded")
    for name, block in result.ledger.at_end().blocks.items():
        parts = []
        for key, (heading, form) in SHOWN.items():
            if form and key in block:
                parts.append(f"{heading} {block[key][-1]:{form}}")
        if "W" not in block and not result.ledger.kept:
            parts = ["works are not kept", *parts]
        if parts:
            lines.append(f"  {name:>10}: {', '.join(parts)}")
    lines += _sliding(result)
    return "\n".join([*lines, *(f"  note: {note}" for note in result.notes)])


def _sliding(result: RunResult) -> Iterator[str]:
    """What is said of sliding, and the share of time without contact, where it is recorded."""
    if force_averages.has_mean_friction(result.scene):
        yield from _friction(result)
        yield from _energies(result)
    shares = force_averages.shares_without_contact(result)
    each = ", ".join(f"{name} {100.0 * share:.3g} %" for name, share in shares.items())
    if each:
        scene = result.scene
        distances = [contact_distance_of(scene, s) for s in scene.surfaces if s.name in shares]
        yield (
            f"  time without contact: {each}; in contact are bobs that repel each other, here "
            f"closer than {max(distances):.4g}"
        )


def _friction(result: RunResult) -> Iterator[str]:
    """Friction forces and those of drives."""
    averages = force_averages.recorded_averages(result)
    for surface in result.scene.surfaces:
        for name, word in (("friction_force", "friction force"), ("pull_force", "drive's force")):
            found = averages.get(name, {}).get(surface.name)
            is_friction = name == "friction_force"
            if found and found.mean != 0.0 and (is_friction or surface.drive.stage):
                yield f"  {surface.name:>10}: {word} {in_words(found, surface, is_friction)}"
    if not averages and not result.ledger.kept:
        yield '  friction force: not recorded; series = ["forces"] under [output] records it'


def in_words(found: Average, surface: Surface, is_friction: bool) -> str:
    """An average with its interval, in all and per asperite, and in units of the load."""
    parts = [f"{mean_text(found.mean, found.half_width)} from t = {found.after:g} on"]
    if surface.count > 1:
        parts.append(f"{found.mean / surface.count:.4g} per asperite")
    if is_friction and force_averages.load_of(surface) > 0.0:
        parts.append(f"{abs(found.mean) / force_averages.load_of(surface):.4g} of the load")
    note = f" ({found.note})" if found.note else ""
    return ", ".join(parts) + note


def _energies(result: RunResult) -> Iterator[str]:
    """The heat given to reservoirs and baths, and how well the energy budget closes."""
    end = result.ledger.at_end()
    of_reservoirs = []
    for name, block in end.blocks.items():
        table = {**end.surfaces.get(name, {}), **block}
        of_reservoirs += [np.sum(table["w_T"][-1])] if "w_T" in table else []
        heats = {"reservoir": table.get("heat"), "bath": table.get("heat_bath")}
        parts = [f"{np.sum(h[-1]):.6g} to the {to}" for to, h in heats.items() if h is not None]
        if parts:
            yield f"  {name:>10}: heat {', '.join(parts)}"
    if "applied_work" in end.system and "total_energy_change" in end.system:
        work, change = (end.system[k][-1] for k in ("applied_work", "total_energy_change"))
        share = sum(of_reservoirs)
        both = f" ({share:.6g} by reservoirs, {work - share:.6g} by all else)"
        who = both if of_reservoirs else ""
        yield (
            f"  energy: work applied {work:.6g}{who}, change of the total energy {change:.6g}, "
            f"difference {work - change:.1e}"
        )


def html(result: RunResult) -> str:
    """The summary of a result as HTML: what ran, the surfaces at the end, and notes."""
    first, *_ = text(result).splitlines()
    blocks = result.ledger.at_end().blocks
    names = [name for name in SHOWN if all(name in block for block in blocks.values())]
    rows = [_row(["surface", *(SHOWN[name].heading for name in names)], "th")]
    for surface, block in blocks.items():
        rows.append(_row([surface, *(f"{block[name][-1]:.6g}" for name in names)]))
    bounds = [result.error_estimate.get(name) for name in names]
    if any(bound is not None for bound in bounds):
        rows.append(_row(["error below", *("" if b is None else f"{b:.1e}" for b in bounds)]))
    lines = [*map(str.strip, _sliding(result)), *result.notes]
    notes = "".join(f"<li>{markup.escape(line)}</li>" for line in lines)
    after = f"<ul>{notes}</ul>" if notes else ""
    return f"<p>{markup.escape(first)}</p><table>{''.join(rows)}</table>{after}"


def _row(cells: list[str], tag: str = "td") -> str:
    return f"<tr>{''.join(f'<{tag}>{markup.escape(cell)}</{tag}>' for cell in cells)}</tr>"
