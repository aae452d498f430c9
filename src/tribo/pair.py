"""Two asperites and nothing else: their own layout, for the loop that takes them in registers.

The loop's record has few columns; every coordinate and every account of the scene's own layout
is a multiple of one of them, which one matrix says.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tribo.kernels.pair import (
    COLUMNS,
    ENERGY,
    J_Y,
    LANES,
    PAIR,
    PLACE,
    Q1,
    Q2,
    ROWS,
    T1,
    T2,
    V1,
    V2,
    X1,
    X2,
    Y1,
    Y2,
    J,
    K,
    S,
)
from tribo.kernels.records import CLOCK, FORCED, FREE
from tribo.kernels.samples import STORED
from tribo.kernels.stepping import Tolerance
from tribo.layout import Layout
from tribo.ledger import Samples

ARC1, ARC2 = COLUMNS, COLUMNS + 1  # what the springs' ends do about the centre, see `_arcs`
FIRST_ACCOUNT = J + 1


def is_pair(layout: Layout) -> bool:
    """Whether a scene is one asperite on one, forced or free, with bars clamped at rest."""
    model = layout.model
    extra = (*model[model._fields.index("box") :], model.within, model.calculators, model.species)
    a, surfaces = model.asperites, model.surfaces
    return (
        a.size == surfaces.size == 2
        and all(item is None for item in extra)
        and layout.rows == 0
        and len(model.contacts[0].pairs) == 1
        and bool(np.all(np.isin(surfaces.drive, (FORCED, FREE)) & (surfaces.loaded == 0)))
        and bool(np.all((a.dof_phi < 0) & (a.phi == 0.0) & (a.nu == 0.0) & (a.dof_y < 0)))
    )


@dataclass(frozen=True, eq=False)
class Pair:
    """A layout of two asperites as the loop for them sees it."""

    layout: Layout
    record: np.ndarray  # (1,) of PAIR
    potential: Any
    places: np.ndarray  # (2 coordinates, columns): y of the layout from a row and its arcs
    books: np.ndarray  # (accounts, columns): s of the layout

    @classmethod
    def of(cls, layout: Layout) -> Pair:
        """From a layout for which `is_pair` holds."""
        model = layout.model
        a, b = model.asperites, model.bobs
        held = np.where(model.surfaces.drive == FORCED, 1.0, 0.0)
        ease = np.array([1.0, -1.0]) * (1.0 - held) / a.mass
        record = np.zeros(1, PAIR)
        record["gap_x"], record["gap_y"] = a.x[0] - a.x[1], a.y[0] - a.y[1]
        record["speed_x"], record["speed_y"] = a.vx[0] - a.vx[1], a.vy[0] - a.vy[1]
        record["square_z"] = (b.z[0] - b.z[1]) ** 2
        record["ease"] = ease[0] - ease[1]
        for i, sign in enumerate((1.0, -1.0)):
            lever = sign * a.facing[i] / a.inertia[i]
            record[f"charge{i + 1}"] = b.charge[i]
            record[f"arm{i + 1}"] = a.facing[i] * a.l1[i]
            record[f"turn_x{i + 1}"] = lever * (a.l1[i] + held[i] * a.l2[i])
            record[f"turn_y{i + 1}"] = lever * (a.l1[i] + a.l2[i])
            record[f"square{i + 1}"] = a.kappa[i] / a.inertia[i]
        places, books = _matrices(layout, ease)
        return cls(layout, record, model.contacts[0].potential, places, books)

    def tolerance(self, wanted: Tolerance) -> np.ndarray:
        """(2, 8) tolerances of the loop's own variables, such that all of the layout's are met."""
        everything = np.concatenate([wanted.y, wanted.s])
        factors = np.abs(np.concatenate([self.places, self.books]))[:, :ENERGY]
        with np.errstate(divide="ignore"):
            own = np.min(everything[:, None] / factors, axis=0)
        table = np.zeros((2, LANES))
        table[0, :4] = own[V1], own[V2], own[J], wanted.level
        table[1] = 1.0 / own[FIRST_ACCOUNT : FIRST_ACCOUNT + LANES]
        return table

    def begun(self, start: np.ndarray, first_step: float) -> tuple[np.ndarray, np.ndarray]:
        """A clock and a state at t = 0, from y of the layout."""
        clocks = np.zeros(1, CLOCK)
        clocks["h"] = first_step
        work = np.zeros((ROWS, LANES))
        n = self.layout.coordinates
        work[PLACE, Q1 : Q2 + 1] = start[:2]
        work[PLACE, V1 : V2 + 1] = start[n : n + 2]
        return clocks, work

    def samples(self, times: np.ndarray, record: np.ndarray) -> Samples:
        """What the general loop would have recorded."""
        rows = np.concatenate([record[: times.size], self._arcs(record[: times.size])], axis=1)
        none = np.zeros(times.size)
        return Samples(
            t=times,
            y=rows @ self.places.T,
            s=rows @ self.books.T,
            contact=rows[:, ENERGY],
            field=none,
            stored=np.zeros((times.size, 2, STORED)),
        )

    def _arcs(self, record: np.ndarray) -> np.ndarray:
        """Integrals of q omega sin q: the spring's force on an end of the bar, as the bar moves."""
        q = record[:, [Q1, Q2]]
        arcs = np.sin(q) - q * np.cos(q)
        return arcs - arcs[:1]


def _matrices(layout: Layout, ease: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`places` and `books` of a Pair; see kernels.powers for the accounts' meaning."""
    n = layout.coordinates
    places = np.zeros((2 * n, COLUMNS + 2))
    books = np.zeros((layout.accounts, COLUMNS + 2))
    columns = ((Q1, V1, X1, Y1, T1, ARC1), (Q2, V2, X2, Y2, T2, ARC2))
    for i, (a, sign) in enumerate(zip(layout.model.asperites, (1.0, -1.0), strict=True)):
        q, v, about_x, about_y, twist, arc = columns[i]
        places[i, q] = places[n + i, v] = 1.0
        first = FIRST_ACCOUNT
        contact = a.acc_contact
        books[contact, J] = books[contact + 1, first + J_Y] = sign
        books[contact + 2, first + about_x] = sign * a.facing
        books[contact + 3, first + about_y] = sign * a.facing
        if a.dof_x >= 0:
            places[a.dof_x, K] = places[n + a.dof_x, J] = ease[i]
            block = layout.model.surfaces[i].acc_block
            books[a.acc_slide, first + S] = books[block, first + S] = sign * ease[i]
        if a.acc_ends >= 0:
            end = a.kappa / a.bar_length
            books[a.acc_ends, arc] = -a.l2 * a.facing * end
            books[a.acc_ends + 1, arc] = a.l2 * a.facing * end
            books[a.acc_ends + 3, first + twist] = end
    return places, books
