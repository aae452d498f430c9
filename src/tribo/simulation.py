"""From a scene and a wanted accuracy to a result with honest error bars."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from tribo import accuracy as acc
from tribo import methods, sources
from tribo.checks import POSITIVE, inside, number, number_or_each, shown
from tribo.errors import InputError
from tribo.kernels.compiled import time_loop
from tribo.layout import laid_out, set_bath
from tribo.ledger import Ledger, ledger
from tribo.march import Digest, March, Progress, compile_loop, march
from tribo.potentials.written import as_table
from tribo.result import Cost, Result
from tribo.scene import Scene, check_accuracy
from tribo.spectra import believed_until

DEFAULT_ACCURACY = 1e-8
PILOT = 1e-3  # tolerance level of the first run, which finds out the scales
CHECKS = 8  # equal parts of the duration, after each of which two runs are compared
PARTS = 32  # the finer run lands on these and the samples: its steps are never the other's
FIRST_LEVEL = 0.03  # tolerance of the coarser run, in units of the accuracy
STALLED = 0.5  # of the estimate before: less gained than that, and round-off is the limit
ROUNDS = 6  # of tightening, before a request is called out of reach
NOISY_STEP = 2.0  # of a run with noise, in units of the first step of one without
HALTED = ("Interrupted", "CalculatorFailed")  # what ends a run that another would not mend
PERTURBATION = 1e-11  # of the start, to see what the scene makes of it


class Simulation:
    """A scene with method and step fixed and everything compiled; made by :func:`prepare`."""

    def __init__(
        self,
        scene: Scene,
        accuracy: float | None,
        method: methods.Method,
        step: float | None,
        progress: Progress | None = None,
    ) -> None:
        self.scene = scene
        self.method = method
        self.accuracy = accuracy
        self.layout = laid_out(scene)
        self._progress = progress
        self._first_step = acc.first_step(self.layout)
        self._loop = time_loop(method.loop, sources.stamp(self.layout.plugins))
        self._times = scene.times
        self._check_times = np.linspace(0.0, scene.duration, CHECKS + 1)
        self._setting: Any = step
        if accuracy is not None:
            self._times = np.union1d(self._times, np.linspace(0.0, scene.duration, PARTS + 1))
            self._setting = acc.tolerances(self.layout, acc.first_guess(self.layout), PILOT)
        self.compile_seconds = compile_loop(self.layout, method, self._loop, self._setting)
        self._coarse: Any = None
        self._tuning: list[March] = []
        self._warnings = _roughness(scene, method) + _warnings(scene)
        if accuracy is not None:
            if self._digests:
                raise InputError(
                    "output.samples",
                    f"{self._times.size} samples of {scene.count} asperites are too many to "
                    "compare two runs; give fewer samples, or a method and a step",
                )
            self._tune(accuracy)

    def run(self, start: Mapping[str, Any] | None = None, estimate: bool = True) -> Result:
        """Run from the scene's start, or with some initial values changed.

        `start` maps "surface.theta" (or phi, omega, nu) to a number or one per asperite.  With
        ``estimate=False`` the second run that estimates the error is left out.
        """
        y = self._changed(start or {})
        runs = []
        if estimate and self._coarse is not None:
            runs.append(self._march(y, self._coarse, self._check_times))
        digest = Digest(self.layout) if self._digests else None
        runs.append(self._march(y, self._setting, self._times, digest))
        return self._result(runs, digest)

    def first_result(self) -> Result:
        """The result of the runs that fixed the step, or of a run if none was needed."""
        return self._result(self._tuning) if self._tuning else self.run()

    @property
    def _digests(self) -> bool:
        return Digest.wanted(self.layout, self._times.size)

    def _march(
        self, start: np.ndarray, setting: Any, times: np.ndarray, digest: Digest | None = None
    ) -> March:
        return march(
            self.layout,
            self.method,
            self._loop,
            setting,
            start,
            times,
            self._first_step,
            self._progress,
            digest,
        )

    def _tune(self, accuracy: float) -> None:
        """Find two tolerances a decade apart whose runs agree within the accuracy.

        A pilot finds the scales; then the level is lowered until the estimate meets the request,
        or has reached what double precision can do.
        """
        layout, start = self.layout, self.layout.start
        runs = [self._march(start, self._setting, self._check_times)]
        level = FIRST_LEVEL * accuracy
        before = np.inf
        for _ in range(ROUNDS):
            scales = acc.inner_scales(layout, runs[-1].samples)
            self._coarse = acc.tolerances(layout, scales, level)
            self._setting = acc.tolerances(layout, scales, 0.1 * level)
            for setting, times in (
                (self._coarse, self._check_times),
                (self._setting, self._times),
            ):
                if runs[-1].status not in HALTED:
                    runs.append(self._march(start, setting, times))
            if runs[-1].status in HALTED:
                break
            excess = acc.excess(*self._estimated(runs[-1], runs[-2]), accuracy)
            if excess <= 1.0 or level <= acc.FLOOR or excess > STALLED * before:
                break
            before = excess
            level = max(level * min(0.1, 0.3 / excess), acc.FLOOR)
        self._tuning = runs

    def _estimated(self, fine: March, coarse: March) -> tuple[dict[str, float], acc.Scales]:
        """Bounds on the finer run's errors, and the scales that they are judged by."""
        layout = self.layout
        books = ledger(layout, fine.samples)
        shared = np.intersect1d(fine.samples.t, coarse.samples.t)
        one, other = (ledger(layout, run.samples.at(shared)) for run in (fine, coarse))
        return acc.estimate(books, one, other), acc.reported_scales(layout, books)

    def _changed(self, start: Mapping[str, Any]) -> np.ndarray:
        """y at t = 0 with some initial values replaced."""
        if not isinstance(start, Mapping):
            raise InputError("start", f"must map names to values, got {start!r}")
        y = self.layout.start.copy()
        n = self.layout.coordinates
        for key, value in start.items():
            name, _, quantity = str(key).rpartition(".")
            if name not in self.layout.parts or quantity not in ("theta", "phi", "omega", "nu"):
                raise InputError(
                    str(key), 'must be "surface.theta", or phi, omega or nu of a surface'
                )
            part = self.layout.parts[name]
            values = np.asarray(number_or_each(key, value))
            surface = next(s for s in self.scene.surfaces if s.name == name)
            if values.ndim and values.size != surface.count:
                raise InputError(key, f"has {values.size} values for {surface.count} asperites")
            if quantity in ("phi", "nu") and surface.bars == "clamped":
                raise InputError(key, "cannot be changed on clamped bars of a prepared scene")
            slots = np.arange(part.start, part.stop)
            if quantity in ("phi", "nu"):
                slots = self.layout.model.asperites.dof_phi[part]
            if quantity in ("omega", "nu"):
                slots = slots + n
            y[slots] = values - surface.rest if quantity == "theta" else values
        for index, surface in enumerate(self.scene.surfaces if start else ()):
            part = self.layout.parts[surface.name]
            rng = np.random.default_rng([self.scene.seed, index, 1])
            bars = self.layout.model.asperites[part]
            set_bath(bars, surface, part, y[:n], y[n:], rng)
        return y

    def _result(self, runs: list[March], digest: Digest | None = None) -> Result:
        """The last run as a result, its error estimated from the one before it."""
        fine = runs[-1]
        kept = np.union1d(np.intersect1d(fine.samples.t, self.scene.times), fine.samples.t[-1:])
        books = ledger(self.layout, fine.samples.at(kept))
        bounds: dict[str, float | None] = {name: None for name in acc.KINDS if books.series(name)}
        t = kept
        if digest is not None:
            t, blocks, system = digest.series()
            books = Ledger(books.surfaces, blocks, system)
        met = None
        notes = list(self._warnings)
        if digest is not None:
            notes.append("of the asperites' series only the first and the last sample are kept")
        for call in self.layout.calls:
            if call.error is not None:
                notes.append(f"the calculator raised {type(call.error).__name__}: {call.error}")
        if len(runs) > 1 and self.accuracy is not None:
            met = False
            if fine.status == "completed":  # of the end of any other run nothing is known
                estimated, scales = self._estimated(fine, runs[-2])
                met = acc.excess(estimated, scales, self.accuracy) <= 1.0
                bounds.update(estimated)
                if not met:
                    notes.append(self._out_of_reach(fine, estimated, scales))
        return Result(
            scene=self.scene,
            t=t,
            ledger=books,
            status=fine.status,
            method=self.method.name,
            cost=Cost(
                steps=fine.steps,
                force_evaluations=sum(run.evaluations for run in runs),
                wall_seconds=sum(run.seconds for run in runs),
                compile_seconds=self.compile_seconds,
            ),
            error_estimate=bounds,
            accuracy=self.accuracy,
            met=met,
            notes=tuple(notes),
        )

    def _out_of_reach(self, fine: March, bounds: dict[str, float], scales: acc.Scales) -> str:
        """Why the request was not met: how much the scene makes of a small change of its start."""
        assert self.accuracy is not None
        nudged = self.layout.start.copy()
        nudged[: self.layout.model.asperites.size] += PERTURBATION
        other = self._march(nudged, self._setting, self._times)
        change = acc.excess(self._estimated(fine, other)[0], scales, 1.0) / acc.SAFETY
        reached = acc.excess(bounds, scales, 1.0)
        return (
            f"accuracy {self.accuracy:.1e} is out of reach: errors are estimated at {reached:.1e} "
            f"of their scale; a change of {PERTURBATION:.0e} in the start grows to {change:.1e}, "
            f"and round-off of {acc.EPSILON:.1e} with it to about "
            f"{acc.EPSILON * change / PERTURBATION:.1e}"
        )


def _roughness(scene: Scene, method: methods.Method) -> list[str]:
    """Potentials that are less smooth than a method needs them to be."""
    notes = []
    for interaction in scene.interactions:
        smoothness = interaction.potential.smoothness()
        name = shown(as_table(interaction.potential)["potential"])
        if smoothness < 0:
            notes.append(
                f"the energy of {name} jumps, for which no force accounts: the books do not close "
                "where bobs cross the jump"
            )
        elif smoothness < method.smoothness:
            notes.append(
                f"{name} has {smoothness} continuous derivatives; {method.name} needs "
                f"{method.smoothness} for errors of order {method.order}"
            )
    return notes


def _warnings(scene: Scene) -> list[str]:
    """Baths that stand for a continuum are to be believed only for a time."""
    warnings = []
    for surface in scene.surfaces:
        if surface.bath.spectrum is None:
            continue
        each = surface.asperite.for_each(surface.count)
        frequency = float(np.max(np.sqrt(each["kappa"] / each["inertia"])))
        until = believed_until(surface.bath.spectrum, float(np.min(each["mass"])), frequency)
        if until < scene.duration:
            warnings.append(
                f'the bath of "{surface.name}" stands for a continuum until t = {until:.4g}; the '
                f"run lasts {scene.duration:g}, so give it more oscillators"
            )
    return warnings


def prepare(
    scene: Scene,
    accuracy: float | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Progress | None = None,
) -> Simulation:
    """Compile and plan a scene once; method and step are fixed here.

    `accuracy` is the largest error wanted in any reported quantity, relative to its scale; None
    takes the scene file's, else 1e-8.  A `method` and `step` of one's own are obeyed, and have no
    error estimate.  `progress` is told the time reached.  Raises InputError.
    """
    if not isinstance(scene, Scene):
        raise InputError("scene", f"must be a tribo.Scene, got {scene!r}")
    own = any(item is not None for item in (accuracy, method, step))
    if own:
        how = _how(scene, accuracy, method, step)
    else:
        wanted = scene.numerics
        with inside("numerics"):
            how = _how(scene, wanted.accuracy, wanted.method, wanted.step)
    return Simulation(scene, *how, progress)


def _how(
    scene: Scene, accuracy: float | None, method: str | None, step: float | None
) -> tuple[float | None, methods.Method, float | None]:
    """Accuracy or step, and the method, from what was asked for; complains if they do not fit."""
    if method is None:
        method = "dop853" if step is None else "midpoint"
        if _noisy(scene):
            method = "verlet"
            if step is None and accuracy is None:
                step = NOISY_STEP * acc.first_step(laid_out(scene))
    chosen = methods.named(method)
    _refuse(scene, chosen)
    if chosen.adaptive:
        if step is not None:
            raise InputError(
                "step", f"cannot go with {chosen.name}, which chooses its own; give accuracy"
            )
        return check_accuracy(DEFAULT_ACCURACY if accuracy is None else accuracy), chosen, None
    if accuracy is not None and step is not None:
        raise InputError("accuracy", f"cannot go with a step of one's own for {chosen.name}")
    if step is None:
        raise InputError("step", f"is missing; {chosen.name} goes in equal steps")
    return None, chosen, number("step", step, POSITIVE)


def _noisy(scene: Scene) -> bool:
    """Whether a reservoir's noise acts somewhere."""
    return any(s.langevin and s.langevin.temperature > 0.0 for s in scene.surfaces)


def _refuse(scene: Scene, method: methods.Method) -> None:
    """What a method cannot do is said, not done wrong."""
    if _noisy(scene) and method.name != "verlet":
        raise InputError(
            "method", f'must be "verlet" for noise from a reservoir, got "{method.name}"'
        )
    for effect, why in method.refuses.items():
        if effect in scene.effects:
            raise InputError("method", f'"{method.name}" {why}')


def simulate(
    scene: Scene,
    accuracy: float | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Progress | None = None,
) -> Result:
    """Run a scene once; arguments as for :func:`prepare`."""
    return prepare(scene, accuracy, method, step, progress).first_result()
