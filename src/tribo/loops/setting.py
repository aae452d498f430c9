"""How a time loop steps: with equal steps, or with those that tolerances allow."""

from __future__ import annotations

from dataclasses import dataclass

from tribo.integrators.step_control import Tolerance


@dataclass(frozen=True, eq=False)
class Setting:
    """`step` of a method with equal steps, `tolerance` of an adaptive one; the other is None."""

    step: float | None = None  # [time]
    tolerance: Tolerance | None = None

    def of_equal_steps(self) -> float:
        """The step, for what runs methods with equal steps alone."""
        assert self.step is not None
        return self.step

    def of_adaptive_steps(self) -> Tolerance:
        """The tolerances, for what runs adaptive methods alone."""
        assert self.tolerance is not None
        return self.tolerance
