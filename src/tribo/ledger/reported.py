"""Which quantities a scene reports: of asperites, of surfaces as wholes, and of the system."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cache, partial

from tribo.layout.layout import Layout, once_per_scene
from tribo.ledger.quantities import (
    ASPERITE_QUANTITIES,
    BLOCK_QUANTITIES,
    EVERY_QUANTITY,
    FURTHER,
    INPUTS,
    OPTIONAL_QUANTITIES,
    OWN_SERIES,
    PULLED_QUANTITIES,
    SYSTEM_QUANTITIES,
    WITHOUT_ACCURACY,
)
from tribo.ledger.quantity import Quantity, energy
from tribo.ledger.totals import Linear, SurfaceSeries
from tribo.model.scene import Scene
from tribo.model.surface import Surface


def needs_accounts(name: str) -> bool:
    """Whether a quantity is a work, a pseudowork or the heat, which not all ledgers have."""
    return name in EVERY_QUANTITY and isinstance(EVERY_QUANTITY[name].of, Linear)


@once_per_scene
def names_by_surface(layout: Layout) -> tuple[frozenset[str], ...]:
    """The :func:`present_names` of each surface."""
    scene = layout.scene
    return tuple([present_names(scene, surface) for surface in scene.surfaces])


def present_names(scene: Scene, surface: Surface) -> frozenset[str]:
    """The optional quantities that a scene reports, and the series that its output asks for."""
    found = built_in_names(scene, surface)
    if "own" not in scene.output.series:
        return found
    return found.union(n for n, each in OWN_SERIES.items() if each.present(scene, surface))


def with_inputs(names: Collection[str]) -> frozenset[str]:
    """Names of quantities, and of those from which the user's own ones are computed."""
    return frozenset(names).union(*(INPUTS.get(name, ()) for name in names))


def built_in_names(scene: Scene, surface: Surface) -> frozenset[str]:
    """The same without those of the user."""
    asked = (FURTHER.get(name, {}) for name in scene.output.series if name != "own")
    groups = (OPTIONAL_QUANTITIES, PULLED_QUANTITIES, *asked)
    return frozenset(
        name for group in groups for name, each in group.items() if each.present(scene, surface)
    )


# The sums over the asperites of a surface, by the names of what is summed.
SUMMED_QUANTITIES = {
    name: energy(
        f"{quantity.long_name}, all asperites",
        Linear(partial(SurfaceSeries.summed, quantity=quantity.terms)),
        is_summed=quantity.is_summed,
    )
    for name, quantity in (ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES).items()
    if quantity.terms is not None
}


def quantity_of(name: str, whole: bool) -> Quantity:
    """A quantity by its name; works of a `whole` surface are sums over its asperites."""
    summed = SUMMED_QUANTITIES.get(name) if whole else None
    return summed or EVERY_QUANTITY[name]


@dataclass(frozen=True, eq=False)
class Reported:
    """The quantities that a scene reports: of asperites, of surfaces as wholes, of the system."""

    asperites: Mapping[str, Quantity]
    blocks: Mapping[str, Quantity]
    system: Mapping[str, Quantity]


@cache
def reported(ledger: str, present: frozenset[str]) -> Reported:
    """The quantities with works kept as `ledger` says, and others whose names are `present`."""
    own = ASPERITE_QUANTITIES | _those_of(OPTIONAL_QUANTITIES, present)
    tables = [own, BLOCK_QUANTITIES, SYSTEM_QUANTITIES]
    if ledger == "surfaces":
        sums = _those_of(SUMMED_QUANTITIES, own.keys())
        tables = [_without_accounts(own), BLOCK_QUANTITIES | sums, SYSTEM_QUANTITIES]
    elif ledger == "none":
        tables = list(map(_without_accounts, tables))
    asked = (_those_of(table, present) for table in WITHOUT_ACCURACY)
    return Reported(*(table | more for table, more in zip(tables, asked, strict=True)))


def _those_of(table: Mapping[str, Quantity], names: Collection[str]) -> dict[str, Quantity]:
    return {name: each for name, each in table.items() if name in names}


def _without_accounts(table: Mapping[str, Quantity]) -> dict[str, Quantity]:
    return {name: each for name, each in table.items() if not needs_accounts(name)}
