"""What a run will do and cost, before it is run: as data, as JSON and as text."""

import json
from dataclasses import dataclass
from textwrap import fill
from typing import Any

import numpy as np
from numba import config

from tribo.accuracy.choose_method import choose
from tribo.accuracy.comparison import Accuracy
from tribo.accuracy.cost_model import pairs_of_bobs
from tribo.compiler.jit import compilations
from tribo.compiler.plugin_methods import type_of
from tribo.explanation.prediction import Predicted, Search, predict, slow_motion
from tribo.integrators.methods import Method
from tribo.kernels.potential_in_lanes import is_vectorized
from tribo.layout.layout import Layout, lay_out
from tribo.ledger.ledger import check_keep
from tribo.loops.general import GeneralLoop
from tribo.loops.resolution import longest_step
from tribo.loops.setting import Setting
from tribo.model.effects import EFFECTS, Effect, reason_for
from tribo.model.scene import Scene
from tribo.plugins.classes import parts
from tribo.potentials.potential import Potential
from tribo.results.notes import NOTED_CUT
from tribo.threads.shared_run import Threads, threads_of
from tribo.validation import inside, instance

# Time of a run from which on the explanation says what makes it slow [s].
LONG = 45 * 60.0
# Width of the text [columns].
WIDTH = 100
# Units of times and of bytes, from the largest on.
TIMES = ((3600.0, "hours"), (60.0, "minutes"), (1.0, "s"), (1e-3, "ms"), (1e-6, "us"))
BYTES = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"))


@dataclass(frozen=True)
class Contact:
    """How contact is computed.

    Attributes
    ----------
    pairs : int
        Pairs of bobs in each evaluation; of a neighbour list about as many.
    by_list : bool
        Whether neighbour lists hold them, or all pairs are visited.
    arithmetic : str
        "lanes" where the forces of eight pairs are computed at once, or "scalar".
    scalar : tuple of str
        The potentials whose formula does not compile for eight distances at once.
    inactive : int
        Asperites that are out of reach at the start, and not stepped until they come within reach.
    """

    pairs: int
    by_list: bool
    arithmetic: str
    scalar: tuple[str, ...]
    inactive: int


@dataclass(frozen=True, eq=False)
class Explanation:
    """Prediction of what a run of a scene does and costs; :func:`explain` makes one.

    Attributes
    ----------
    scene : Scene
        The scene to explain.
    effects : dict
        Each effect that is present -> the keys of the scene that require it.
    absent : dict
        Each other effect -> the reason for its absence.
    coordinates : dict
        Kind of coordinate ("swings", "bars", "x", "y", "baths") -> number of integrated ones.
    contact : Contact
        How contact is computed.
    method : str
        The integration method.
    why : str
        Reason for the choice; empty where the method was given.
    threads : Threads
        Number of threads that share each step, and the reason.
    accuracy : float, dict or None
        The requested accuracy; None with a given step.
    step : float or None
        The step [time]; None where the method chooses its steps, or the step is not known yet.
    longest_step : float or None
        The longest step that is taken: steps are equal parts of the times between samples [time].
    compiled : bool
        Whether the time loop had been compiled before.
    predicted : Predicted
        The cost.
    evaluations_used : int
        Evaluations of all forces that the prediction itself took.
    slow : str
        For a run of 45 minutes or more, the motion that limits its steps, and a cure; else empty.
    """

    scene: Scene
    effects: dict[Effect, str]
    absent: dict[Effect, str]
    coordinates: dict[str, int]
    contact: Contact
    method: str
    why: str
    threads: Threads
    accuracy: Accuracy | None
    step: float | None
    compiled: bool
    predicted: Predicted
    evaluations_used: int
    slow: str = ""
    longest_step: float | None = None

    @property
    def degrees_of_freedom(self) -> int:
        """Number of coordinates that are free: of a rigid body, those of the whole."""
        return sum(self.coordinates.values())

    def to_json(self) -> str:
        """The whole explanation as one JSON object, as ``tribo explain --json`` prints it."""
        table: dict[str, Any] = vars(self) | {
            "effects": list(self.effects),
            "absent": list(self.absent),
            "reasons": self.effects | self.absent,
            "degrees_of_freedom": self.degrees_of_freedom,
            "ledger": self.scene.output.ledger,
            "keep": self.scene.output.keep,
            "threads": self.threads._asdict(),
        }
        del table["scene"]
        return json.dumps(table, indent=1, allow_nan=False, default=vars)

    def __repr__(self) -> str:
        return (
            f"<Explanation: {len(self.effects)} effects, {self.degrees_of_freedom} degrees of "
            f"freedom, {self.method}, {self._cost()}; print it for the reasons>"
        )

    def __str__(self) -> str:
        """The scene, what is simulated and what is absent, and the plan, as paragraphs."""
        scene = self.scene
        n = len(scene.surfaces)
        title = f"{scene.title}: " if scene.title else ""
        asperites = "asperites" if scene.count > 1 else "asperite"
        surfaces = "surfaces" if n > 1 else "surface"
        count = f"{scene.count} {asperites} on {n} {surfaces}"
        lines = [f"{title}{count}, until t = {scene.duration:g}."]
        present = {effect: f"{effect.description}: {why}" for effect, why in self.effects.items()}
        for head, reasons in (("Simulated:", present), ("Absent, at no cost:", self.absent)):
            rows = (f"  {name:<15} {why}" for name, why in reasons.items())
            lines += ["", head, *(fill(row, WIDTH, subsequent_indent=18 * " ") for row in rows)]
        now = "had not been compiled before; it is now, and is kept on disk"
        plan = [f"{subject}: {text}." for subject, text in self._plan().items() if text]
        plan += [f"The time loop {'was compiled before' if self.compiled else now}."]
        return "\n".join(
            [*lines, "", *(fill(each, WIDTH, subsequent_indent="  ") for each in plan)]
        )

    def _plan(self) -> dict[str, str]:
        """What is said of each subject; nothing where a text is empty."""
        output = self.scene.output
        contact = self.contact
        count = self.scene.count
        kinds = ", ".join(f"{n} {kind}" for kind, n in self.coordinates.items() if n)
        place = "neighbour lists, about" if contact.by_list else "all pairs of bobs,"
        names = ", ".join(contact.scalar)
        how = f"one after another (scalar) for {names}" if names else "eight at once"
        computed = f"{place} {contact.pairs:,}; forces are computed {how}"
        live = (
            f"{count - contact.inactive:,} of {count:,} asperites at the start. The others are out "
            "of reach, and are computed in closed form until they come within reach"
        )
        ledgers = {"surfaces": "sums of works over each surface", "none": "no works are computed"}
        steps = "steps of its own" if self.step is None else f"steps of {self.step:.3g}"
        if self._takes_shorter_steps:
            steps += f", shortened to {self.longest_step:.4g} to fit between samples"
        if self.accuracy is not None:
            single = isinstance(self.accuracy, float)
            steps = f"accuracy {f'{self.accuracy:.0e}' if single else 'of observables'}, {steps}"
        noisy = self.scene.is_noisy
        default = "integrates thermal noise" if noisy else "is the default with a step"
        given = "which the scene names" if self.scene.numerics.method else f"which {default}"
        why = f"chosen because {self.why}" if self.why else given
        memory = _in_units(self.predicted.memory_bytes, BYTES)
        return {
            "Degrees of freedom": f"{self.degrees_of_freedom} ({kinds})",
            "Contact": computed if contact.pairs else "none",
            "Live": live if contact.inactive else "",
            "Ledger": ledgers.get(output.ledger, ""),
            "Recorded": f"only {', '.join(output.keep)}" if output.keep else "",
            "Method": f"{self.method}, {steps}, {why}",
            "Threads": f"{self.threads.number}, {self.threads.why}",
            "Cost": f"{self._cost()} on this machine, {memory} of memory. {self._basis()}",
            "Slow": self.slow,
        }

    @property
    def _takes_shorter_steps(self) -> bool:
        """Whether samples are so close together that steps are shorter, as a run notes."""
        if self.step is None or self.longest_step is None:
            return False
        return self.longest_step < NOTED_CUT * self.step

    def _cost(self) -> str:
        """The evaluations to three digits, and their time."""
        count = self.predicted.force_evaluations
        time = _in_units(self.predicted.seconds, TIMES)
        return f"about {round(count, 3 - len(str(count))):,} force evaluations, {time}"

    def _basis(self) -> str:
        """How the evaluations are known, and whether the run will stop or fall short."""
        cost = self.predicted
        used = f"{self.evaluations_used:,} evaluations"
        basis = {
            "counted": "Counted from the step",
            "searched": f"The search for settings, with which a run begins, took {used}",
            "extrapolated": f"Extrapolated from the first {used} of the search for settings",
        }[cost.basis]
        if cost.stop:
            return f"{basis}. The run will stop as {cost.status}: {cost.stop}"
        shortfall = ". The run will fall short of its accuracy" if cost.met is False else ""
        return basis + shortfall


def _in_units(number: float, units: tuple[tuple[float, str], ...]) -> str:
    """Two digits of a number, in the largest unit that it reaches."""
    size, unit = next((each for each in units if number >= each[0]), units[-1])
    return f"{float(f'{number / size:.2g}'):g} {unit}"


def explain(scene: Scene) -> Explanation:
    """Predict what a run of a scene does and costs, with the scene's own numerics.

    This compiles the time loop. With an accuracy, it also makes the search for settings with
    which every run begins, for at most one second by the model of costs.

    Parameters
    ----------
    scene : Scene
        The scene to explain.

    Raises
    ------
    InputError
        As for :func:`tribo.prepare`.
    """
    scene = instance(Scene)("scene", scene)
    layout = lay_out(scene)
    given = scene.numerics
    check_keep(layout)
    with inside("numerics"):
        choice = choose(layout, given.accuracy, given.method, given.step)
    threads = threads_of(layout.model, choice.method, None)
    with compilations() as compiled:
        search = Search(layout, choice.method, threads.number)
    predicted, step = predict(choice, search)
    reasons = {effect: reason_for(scene, effect) for effect in Effect}
    return Explanation(
        scene=scene,
        effects={each: why for each, why in reasons.items() if why},
        absent={each: EFFECTS[each][0] for each, why in reasons.items() if not why},
        coordinates=coordinates(layout),
        contact=contact(layout, choice.method),
        method=choice.method.name,
        why=choice.why,
        threads=threads,
        accuracy=choice.accuracy,
        step=step,
        compiled=not compiled.buffer,
        predicted=predicted,
        evaluations_used=search.evaluations,
        slow=slow_motion(layout, step) if predicted.seconds >= LONG else "",
        longest_step=None if step is None else longest_step(layout, step),
    )


def coordinates(layout: Layout) -> dict[str, int]:
    """How many coordinates of each kind are free; a rigid body has one along each axis."""
    slots = {"bars": "dof_phi", "x": "dof_x", "y": "dof_y"}
    swings = sum(int(np.isfinite(s.each["kappa"]).sum()) for s in layout.scene.surfaces)
    found = dict.fromkeys(slots, 0)
    for surface in layout.scene.surfaces:
        own = layout.asperites[layout.parts[surface.name]]
        for kind, name in slots.items():
            count = int((own[name] >= 0).sum())
            one_body = surface.is_rigid_block or (surface.moves_as_one and kind == "x")
            found[kind] += min(count, 1) if one_body else count
    return {"swings": swings, **found, "baths": layout.coordinates - layout.core}


def contact(layout: Layout, method: Method) -> Contact:
    """How many pairs of bobs a run computes, and whether eight at once."""
    acting = [each.potential for each in layout.model.contacts]
    if not config.DISABLE_JIT:  # type: ignore[attr-defined]
        acting = [each for each in acting if not is_vectorized(type_of(each))]
    names = tuple(dict.fromkeys(name for each in acting for name in _scalar_parts(each)))
    loop = GeneralLoop(layout, method, Setting(step=1.0), layout.start, 0.0)
    if method.splits:  # which select the asperites that they step
        loop.advance(layout.times[-1:], loop.room(1), 0)
    return Contact(*pairs_of_bobs(layout), "scalar" if names else "lanes", names, loop.inactive)


def _scalar_parts(potential: Potential) -> list[str]:
    """The formulas for which a potential does not compile in lanes, without cutoffs and sums."""
    formulas = [part for part in parts(potential) if len(list(parts(part))) == 1]
    scalar = []
    if not config.DISABLE_JIT:  # type: ignore[attr-defined]
        scalar = [part for part in formulas if not is_vectorized(type_of(part))]
    return [type(part).__name__ for part in scalar or formulas]
