"""What is asked of each member: the quantities that are kept, and how its scene is run."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from tribo.accuracy.comparison import Accuracy
from tribo.ensembles.kept_values import Kept
from tribo.ensembles.members import Variation
from tribo.integrators.own_method import coefficients_of
from tribo.kernels.status import Status
from tribo.layout.layout import Layout, lay_out
from tribo.ledger.quantities import AVERAGED, FURTHER
from tribo.ledger.reported import needs_accounts, with_inputs
from tribo.model.identity import Identity, identity_of, settings_of, version
from tribo.model.scene import Scene
from tribo.model.settings import Output
from tribo.prepared import Simulation
from tribo.simulation import prepare, prepare_members
from tribo.validation import InputError

# When quantities are kept.
END = "end"
SAMPLES = "samples"


class Request(NamedTuple):
    """What is asked of each member; it can be pickled."""

    keep: tuple[str, ...] | None  # names of quantities; None for series of sums over asperites
    at: str
    with_errors: bool  # each value has an error estimate
    accuracy: Accuracy | None
    method: str | None
    step: float | None
    allow_unresolved: bool

    def recorded(self, scene: Scene) -> Scene:
        """The scene with its numerics, and with the times and series that the quantities need."""
        given = scene.numerics
        accuracy = self.accuracy
        step = self.step
        if accuracy is None and step is None:
            accuracy = given.accuracy
            step = given.step
        numerics = replace(
            given,
            accuracy=dict(accuracy) if isinstance(accuracy, Mapping) else accuracy,
            method=self.method or given.method,
            step=step,
            allow_unresolved=self.allow_unresolved or given.allow_unresolved,
        )
        return scene.with_settings(self._output(scene.output), numerics)

    def _output(self, given: Output) -> Output:
        """The times and series that the quantities need."""
        if self.keep is None:
            return replace(given, keep=None)
        kinds = with_inputs({name.rpartition(".")[2] for name in self.keep})
        series = tuple(word for word, names in FURTHER.items() if kinds & names.keys())
        if self.at == END and not kinds.intersection(AVERAGED) and "forces" not in series:
            without = given.ledger == "none" and not any(map(needs_accounts, kinds))
            return Output(samples=2, series=series, ledger="none" if without else "asperites")
        return replace(given, keep=None, series=series)

    def prepare(self, scene: Scene, recorded: Scene | None = None) -> Simulation:
        """The scene with all members' settings; it may be `recorded` already.

        Members of a pair are compared with finer runs, and its settings show their scales alone;
        :meth:`search` finds those of its own run.  Raises InputError if settings miss the accuracy.
        """
        recorded = self.recorded(scene) if recorded is None else recorded
        make: Callable[..., Simulation] = prepare_members
        if self.keep is None:  # means compare single runs, which need a search
            make = partial(prepare, progress=False, threads=1)
        simulation = make(recorded, self.accuracy, self.method, self.step)
        return self._checked(self._in_steps_of_samples(scene, simulation))

    def search(self, simulation: Simulation) -> Simulation:
        """The same simulation with the settings of a search.  Raises InputError as above."""
        scene = simulation.scene
        plan = simulation.plan
        return self._checked(prepare(scene, plan.accuracy, plan.method, progress=False, threads=1))

    def _checked(self, simulation: Simulation) -> Simulation:
        """The simulation, whose accuracy is kept or not searched for.  Raises InputError."""
        if simulation.plan.tuned is None or self.with_errors:
            return simulation
        result = simulation.compute_first()
        if result.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        if not result.met:
            completed = result.status == Status.COMPLETED
            why = result.notes[-1] if completed else f"the run ends by {result.status}"
            raise InputError(
                "step",
                f"is missing, and accuracy does not find one: {why}; give a method and a step, or "
                "an accuracy that can be kept in the scene's numerics",
            )
        return simulation

    def kept(self, recorded: Scene, layout: Layout | None = None) -> Kept:
        """What is kept, of a scene that records it; its layout is made if it is needed.

        Raises InputError.
        """
        if self.keep is not None and self.at == END:
            return Kept.at_end(recorded, self.keep, self.with_errors)
        layout = lay_out(recorded) if layout is None else layout
        if self.keep is None:
            return Kept.sums(layout)
        return Kept.at_all_times(layout, self.keep, self.with_errors)

    def identity(
        self, recorded: Scene, variation: Variation, others: Mapping[str, object]
    ) -> Identity:
        """What tells many runs of a scene that records what is kept from others."""
        settings: Identity = {
            "seed": variation.seed,
            **others,
            "keep": self.keep and list(self.keep),
            "at": self.at,
            "vary": variation.identity(),
            **settings_of(str(self.method), self.accuracy, self.step, None),
            **coefficients_of(str(self.method)),
        }
        return identity_of(recorded, settings, version())

    def _in_steps_of_samples(self, scene: Scene, simulation: Simulation) -> Simulation:
        """The same, whose steps, with noise, divide the times between samples.

        Paths depend on the steps, and members that keep their ends alone record no samples.
        """
        if self.keep is None or self.at != END or not scene.is_noisy:
            return simulation
        intervals = np.diff(scene.times)
        if np.ptp(intervals) > 1e-9 * intervals[0]:
            return simulation
        plan = replace(simulation.plan, interval=float(intervals[0]))
        step = plan.setting.of_equal_steps()
        return Simulation(plan.with_step(step), simulation.integrator)
