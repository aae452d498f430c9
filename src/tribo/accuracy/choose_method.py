"""How a scene is going to be run: the method, and the accuracy or the step that it is to keep."""

from __future__ import annotations

from dataclasses import dataclass

from tribo.accuracy import scales as acc
from tribo.accuracy.costs import cheapest
from tribo.accuracy.search import Accuracy, strictest
from tribo.integrators import methods
from tribo.model.settings import check_accuracy
from tribo.run.layout import Layout
from tribo.validation import POSITIVE, InputError, number

DEFAULT_ACCURACY = 1e-8
NOISY_STEP = 2.0  # of a run with noise, in units of the first step of one without


@dataclass(frozen=True)
class Plan:
    """A method, with an accuracy or a step; `why` it was chosen, if it was."""

    method: methods.Method
    accuracy: Accuracy | None
    step: float | None
    why: str = ""


def plan_for(
    layout: Layout, accuracy: Accuracy | None, method: str | None, step: float | None
) -> Plan:
    """The plan for what was asked for; complains if that does not go together."""
    scene = layout.scene
    if accuracy is not None and step is not None:
        raise InputError("accuracy", "cannot go with a step of one's own; give one or the other")
    if method is not None:
        refusal = methods.refusal(methods.named(method), scene)
        if refusal is not None:
            raise InputError("method", refusal)
    if methods.noisy(scene):
        return _noisy(layout, accuracy, step)
    if method is None and step is not None:
        method = "midpoint"
    wanted = check_accuracy(DEFAULT_ACCURACY if accuracy is None else accuracy)
    if method is None:
        chosen, why = cheapest(layout, strictest(wanted))
        return Plan(chosen, wanted, None, why)
    chosen = methods.named(method)
    if step is None and (chosen.adaptive or accuracy is not None):
        return Plan(chosen, wanted, None)
    if chosen.adaptive:
        raise InputError(
            "step", f"cannot go with {chosen.name}, which chooses its own; give accuracy"
        )
    if step is None:
        raise InputError("step", f"is missing; {chosen.name} goes in equal steps; or give accuracy")
    return Plan(chosen, None, number("step", step, POSITIVE))


def _noisy(layout: Layout, accuracy: Accuracy | None, step: float | None) -> Plan:
    """Noise is for one method, and has no digits that two runs could agree on."""
    if accuracy is not None:
        raise InputError(
            "accuracy",
            "cannot be kept where a reservoir makes noise: no two runs agree; give a step, and "
            "average over runs, as tribo.ensemble does",
        )
    if step is None:
        step = NOISY_STEP * acc.first_step(layout)
    return Plan(methods.METHODS["verlet"], None, number("step", step, POSITIVE))
