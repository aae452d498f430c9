"""Members that are run in batches with a given step, also with noise."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tribo.accuracy.choose_method import check_damped_step, check_resolved
from tribo.ensembles.batches import chunk_of, delivered, starts_of
from tribo.ensembles.kept_values import Kept, KeptValues
from tribo.ensembles.members import Members
from tribo.kernels.records import OF_MEMBERS
from tribo.layout.initial_state import InitialState
from tribo.layout.member_numbers import MemberNumbers
from tribo.loops.choose_batch import choose_batch
from tribo.loops.resolution import longest_damped_step
from tribo.prepared import Simulation


class StepRuns:
    """Runs members of an ensemble in batches, with the given step of the simulation.

    `own_numbers` are keys of what members differ in beside their starts.  There is no plan beside
    that of the simulation.
    """

    plan = None

    def __init__(self, simulation: Simulation, kept: Kept, own_numbers: Sequence[str]) -> None:
        layout = simulation.layout
        self.simulation = simulation
        self.kept = kept
        first_step = simulation.integrator.first_step
        self._own_numbers = own_numbers
        self._batch = choose_batch(layout, simulation.method, first_step, bool(own_numbers))
        self._initial = InitialState(layout)

    @property
    def chunk(self) -> int:
        """Members that are run in one call."""
        layout, step = self.simulation.layout, self.simulation.plan.setting
        assert isinstance(step, float)
        return chunk_of(self.simulation, layout.scene.duration / step + layout.times.size)

    def compute(self, members: Members) -> KeptValues:
        """Run some members.  Those that do not complete have the status UNKNOWN."""
        starts = starts_of(self.simulation, self._initial, members, self._own_numbers)
        if starts.numbers is not None:
            self._check_step(starts.numbers)
        runs = self._batch.run(self.simulation.plan.setting, starts)
        return delivered(self.kept, runs, math.nan, guarded=True)

    def _check_step(self, own: MemberNumbers) -> None:
        """Refuse a step that is too long for some member.  Raises InputError."""
        layout, step = self.simulation.layout, self.simulation.plan.setting
        if self.simulation.method.splits:
            assert isinstance(step, float)
            names = ("gamma", "swing_gamma", "temperature", "swing_temperature")
            rows = (OF_MEMBERS.index(name) for name in names)
            numbers = (own.of_surfaces[..., row] for row in rows)
            check_damped_step(longest_damped_step(layout, *numbers), step)
            check_resolved(layout, self.simulation.method, step, own)
