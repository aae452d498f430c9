"""What a run will do and cost, as data and as text."""

from __future__ import annotations

import json
import textwrap
from dataclasses import dataclass
from typing import Any

from tribo.accuracy.comparison import Accuracy
from tribo.integrators.methods import noisy
from tribo.layout.threads import Threads
from tribo.model.effects import Effect
from tribo.model.scene import Scene

# Width of the text [columns].
WIDTH = 100
# Units of times and of bytes, from the largest on.
TIMES = ((3600.0, "hours"), (60.0, "minutes"), (1.0, "s"), (1e-3, "ms"), (1e-6, "us"))
BYTES = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"))
# Ledgers without the works of each asperite.
LEDGERS = {"surfaces": "sums of works over each surface", "none": "no works are computed"}
# What is said of the time loop.
COMPILED = "was compiled before"
NOT_COMPILED = "had not been compiled before; it is now, and is kept on disk"


@dataclass(frozen=True)
class Predicted:
    """Predicted cost of a run.

    Attributes
    ----------
    force_evaluations : int
        Evaluations of all forces, in the run and in those that estimate its error.
    seconds : float
        Time of these runs on this machine, without compiling [s].
    memory_bytes : int
        Bytes of the arrays of the scene, of the loop, of all samples, and of all series, which are
        computed when they are first read.
    basis : str
        How they are known: "counted" from a given step, "searched" by the runs that find the
        settings, or "extrapolated" from the first of these.
    met : bool or None
        Whether the run will meet its accuracy, as far as the search shows; None where it was not
        completed, or with a given step.
    stop : str
        Why the run will stop as NoProgress, and what would do; empty if it should not.
    """

    force_evaluations: int
    seconds: float
    memory_bytes: int
    basis: str
    met: bool | None
    stop: str = ""


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
    compiled : bool
        Whether the time loop had been compiled before.
    predicted : Predicted
        The cost.
    evaluations_used : int
        Evaluations of all forces that the prediction itself took.
    slow : str
        For a run of 45 minutes or more, the motion that limits its steps, and a way to slow that
        motion; else empty.
    """

    scene: Scene
    effects: dict[str, str]
    absent: dict[str, str]
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

    @property
    def degrees_of_freedom(self) -> int:
        """Number of coordinates that are integrated."""
        return sum(self.coordinates.values())

    def to_json(self) -> str:
        """The whole explanation as JSON, as ``tribo explain --json`` prints it.

        Returns
        -------
        str
            One JSON object.
        """
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
        cost = self.predicted
        return (
            f"<Explanation: {len(self.effects)} effects, {self.degrees_of_freedom} degrees of "
            f"freedom, {self.method}, about {_rounded(cost.force_evaluations)} force evaluations, "
            f"{_in_units(cost.seconds, TIMES)}; print it for the reasons>"
        )

    def __str__(self) -> str:
        scene, described = self.scene, {str(effect): effect.description for effect in Effect}
        title = f"{scene.title}: " if scene.title else ""
        surfaces = "1 surface" if len(scene.surfaces) == 1 else f"{len(scene.surfaces)} surfaces"
        count = f"{scene.count} asperite{'s' * (scene.count > 1)} on {surfaces}"
        present = {name: f"{described[name]}: {why}" for name, why in self.effects.items()}
        lines = [f"{title}{count}, until t = {scene.duration:g}."]
        for head, reasons in (("Simulated:", present), ("Absent, at no cost:", self.absent)):
            rows = (_wrapped(f"  {name:<15} {why}", 18) for name, why in reasons.items())
            lines += ["", head, *rows]
        plan = [f"{subject}: {text}." for subject, text in self._plan().items() if text]
        plan += [f"The time loop {COMPILED if self.compiled else NOT_COMPILED}."]
        return "\n".join([*lines, "", *(_wrapped(each, 2) for each in plan)])

    def _plan(self) -> dict[str, str]:
        """What is said of each subject; nothing where a text is empty."""
        scene, contact, cost = self.scene, self.contact, self.predicted
        kinds = ", ".join(f"{n} {kind}" for kind, n in self.coordinates.items() if n)
        place = "neighbour lists, about" if contact.by_list else "all pairs of bobs,"
        names = ", ".join(contact.scalar)
        how = f"one after another (scalar) for {names}" if names else "eight at once (lanes)"
        computed = f"{place} {contact.pairs:,}; forces are computed {how}"
        live = (
            f"{scene.count - contact.inactive:,} of {scene.count:,} asperites at the start. The "
            "others are out of reach, and are computed in closed form until they come within reach"
        )
        steps = "steps of its own" if self.step is None else f"steps of {self.step:.3g}"
        if self.accuracy is not None:
            single = isinstance(self.accuracy, float)
            steps = f"accuracy {f'{self.accuracy:.0e}' if single else 'of observables'}, {steps}"
        return {
            "Degrees of freedom": f"{self.degrees_of_freedom} ({kinds})",
            "Contact": computed if contact.pairs else "none",
            "Live": live if contact.inactive else "",
            "Ledger": LEDGERS.get(scene.output.ledger, ""),
            "Recorded": f"only {', '.join(scene.output.keep)}" if scene.output.keep else "",
            "Method": f"{self.method}, {steps}, {reason_of_method(scene, self.why)}",
            "Threads": f"{self.threads.number}, {self.threads.why}",
            "Cost": f"about {_rounded(cost.force_evaluations)} force evaluations, "
            f"{_in_units(cost.seconds, TIMES)} on this machine, "
            f"{_in_units(cost.memory_bytes, BYTES)} of memory. {self._basis()}",
            "Slow": self.slow,
        }

    def _basis(self) -> str:
        """How the evaluations are known, and whether the run will stop or fall short."""
        cost, used = self.predicted, f"{self.evaluations_used:,} evaluations"
        basis = {
            "counted": "Counted from the step",
            "searched": f"The search for settings, with which a run begins, took {used}",
            "extrapolated": f"Extrapolated from the first {used} of the search for settings",
        }[cost.basis]
        if cost.stop:
            return f"{basis}. The run will stop as NoProgress: {cost.stop}"
        return basis + ". The run will fall short of its accuracy" * (cost.met is False)


def reason_of_method(scene: Scene, why: str) -> str:
    """Why a run has its method, as the end of a sentence."""
    if why:
        return f"chosen because {why}"
    if scene.numerics.method is not None:
        return "which the scene names"
    return "which integrates thermal noise" if noisy(scene) else "the default with a given step"


def _wrapped(text: str, indent: int) -> str:
    return textwrap.fill(text, WIDTH, subsequent_indent=" " * indent)


def _in_units(number: float, units: tuple[tuple[float, str], ...]) -> str:
    """Two digits of a number, in the largest unit that it reaches."""
    size, unit = next((each for each in units if number >= each[0]), units[-1])
    return f"{float(f'{number / size:.2g}'):g} {unit}"


def _rounded(count: int) -> str:
    """A count to three digits."""
    return f"{float(f'{count:.3g}'):,.0f}"
