"""From a scene and a wanted accuracy to a result with honest error bars."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tribo.accuracy import scales as acc
from tribo.accuracy.choose_method import plan_for
from tribo.accuracy.estimate import check_observables, excess_of_request
from tribo.accuracy.search import (
    APART,
    HALTED,
    PARTS,
    PILOT,
    Stops,
    Tuned,
    Wanted,
    estimated,
    loosest,
    named_in,
    out_of_reach,
    setting_at,
    tightest,
    tune,
)
from tribo.integrators import methods
from tribo.kernels.compiled import time_loop
from tribo.model.scene import Scene
from tribo.model.spectrum import believed_until
from tribo.plugins import sources
from tribo.potentials.tables import as_table
from tribo.run.integrate import Digest, Integration, Progress, compile_loop, integrate
from tribo.run.layout import Layout, lay_out, set_bath
from tribo.run.ledger import Ledger, ledger
from tribo.run.pair_adapter import Pair, has_pair_loop
from tribo.run.result import Cost, Result
from tribo.validation import InputError, inside, number_or_each, shown

DIGIT = -1.0 / np.log10(APART)  # how often runs that are compared are apart in a digit


@dataclass(frozen=True)
class Settings:
    """How a prepared scene is run: all that another scene of its kind needs to be run alike."""

    method: str
    own: tuple[Any, np.ndarray]  # setting and times of a run that is delivered
    lone: tuple[Any, np.ndarray]  # of a run that is compared with no other
    accuracy: Wanted | None
    tuned: Tuned | None  # without its runs


class Simulation:
    """A scene with method and step fixed and everything compiled; made by :func:`prepare`."""

    def __init__(
        self,
        layout: Layout,
        method: methods.Method,
        progress: Progress | None = None,
        why: str = "",
    ) -> None:
        """Have the time loop compiled; how to run it is still open."""
        scene = self.scene = layout.scene
        self.method = method
        self.why = why
        self.accuracy: Wanted | None = None
        self.layout = layout
        self._progress = progress
        self._first_step = acc.first_step(self.layout)
        self._stops = Stops.at(scene.times)
        self._setting = setting_at(self.layout, method, acc.first_guess(self.layout), PILOT)
        self._pair: Pair | None = None
        if has_pair_loop(self.layout, method):
            self._pair = Pair(self.layout, method, self._first_step)
            self.compile_seconds = self._pair.compile_seconds
        else:
            self._loop = time_loop(method.loop, sources.source_stamp(self.layout.plugins))
            self.compile_seconds = compile_loop(self.layout, method, self._loop, self._setting)
        self._coarse: Any = None
        self._tuned: Tuned | None = None
        self._known: dict[Any, tuple[Any, float, int]] = {}  # of initial values that were changed
        self._warnings = _roughness(scene, method) + _warnings(scene)

    def with_step(self, step: float) -> Simulation:
        """Go in equal steps, as large as that."""
        self._setting = step
        self.__dict__.pop("_lone", None)
        return self

    @property
    def settings(self) -> Settings:
        """How it is run, for :func:`from_settings`; all of it can be pickled."""
        tuned = None if self._tuned is None else replace(self._tuned, runs=())
        own = (self._setting, self._stops.all)
        return Settings(self.method.name, own, self._lone, self.accuracy, tuned)

    def by(self, settings: Settings) -> Simulation:
        """Run as another was that has been prepared, instead of finding out how."""
        self._setting = settings.own[0]
        self._stops = Stops.at(settings.own[1])
        self.__dict__["_lone"] = settings.lone
        self.accuracy, self._tuned = settings.accuracy, settings.tuned
        self._coarse = None if settings.tuned is None else settings.tuned.coarse
        return self

    def within(self, accuracy: Wanted) -> Simulation:
        """Find the settings that keep an accuracy.  Raises InputError."""
        if isinstance(accuracy, Mapping):
            check_observables(self.layout, accuracy)
        self.accuracy = accuracy
        self._stops = Stops.among(self.scene.times)
        if self._digests:
            many = f"{self.scene.count} asperites"
            if Digest.wanted(self.layout, PARTS + 1):
                raise InputError(
                    "accuracy",
                    f"cannot be kept of {many}, too many to compare runs; give a method and a step",
                )
            raise InputError(
                "output.samples",
                f"{self.scene.times.size} samples of {many} are too many to compare runs; give "
                "fewer samples, or a method and a step",
            )
        self._tuned = tune(self.layout, self.method, accuracy, self._stops, self.attempt)
        self._coarse, self._setting = self._tuned.coarse, self._tuned.fine
        return self

    def attempt(
        self, setting: Any, times: np.ndarray | None = None, start: np.ndarray | None = None
    ) -> Integration:
        """One run with a step or tolerances, recorded at times of its own or where others stop."""
        if times is None:
            times = self._stops.all
        return self._march(self.layout.start if start is None else start, setting, times)

    def run(self, start: Mapping[str, Any] | None = None, estimate: bool = True) -> Result:
        """Run from the scene's start, or with some initial values changed.

        `start` maps "surface.theta" (or phi, omega, nu) to a number or one per asperite.  With
        ``estimate=False`` the two runs that estimate the error are left out.
        """
        y = self._changed({} if start is None else start)
        if not estimate or self._coarse is None:
            return self._once(y)
        settings = (self._coarse, self._coarse, self._setting)
        runs: list[Integration] = []
        for setting, times in zip(settings, self._stops, strict=True):
            if not runs or runs[-1].status not in HALTED:
                runs.append(self._march(y, setting, times))
        return self._result(runs)

    def _once(self, y: np.ndarray) -> Result:
        """A run without an estimate; its ledger is put together when somebody looks."""
        if self._digests:
            digest = Digest(self.layout)
            run = self._march(y, self._setting, self._stops.all, digest)
            return self._result([run], digest)
        run = self._march(y, *self._lone)
        if self.layout.calls:
            return self._result([run])
        return Result.later(lambda: self._result([run]))

    @cached_property
    def _lone(self) -> tuple[Any, np.ndarray]:
        """Setting and times of a run that is compared with no other."""
        if self._tuned is not None:
            assert self.accuracy is not None
            found = loosest(
                self.layout,
                self.method,
                self._tuned,
                self.accuracy,
                lambda setting: self._march(self.layout.start, setting, self.scene.times),
            )
            if found is not None:
                return found, self.scene.times
        return self._setting, self._stops.all

    def first_result(self) -> Result:
        """The result of the runs that fixed the step, or of a run if none was needed."""
        runs = self._tuned.runs if self._tuned else ()
        return self._result(list(runs)) if runs else self.run()

    @property
    def finest(self) -> Integration:
        """The run that fixed the settings.  Raises InputError where none did."""
        if self._tuned is None or not self._tuned.runs:
            raise InputError("accuracy", "is missing; without one no run fixed the settings")
        return self._tuned.runs[-1]

    @cached_property
    def _digests(self) -> bool:
        return Digest.wanted(self.layout, self._stops.all.size)

    def _march(
        self, start: np.ndarray, setting: Any, times: np.ndarray, digest: Digest | None = None
    ) -> Integration:
        if self._pair is not None:
            return self._pair.integrate(setting, start, times, self._progress)
        return integrate(
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

    def _changed(self, start: Mapping[str, Any]) -> np.ndarray:
        """y at t = 0 with some initial values replaced."""
        if not isinstance(start, (dict, Mapping)):
            raise InputError("start", f"must map names to values, got {start!r}")
        y = self.layout.start.copy()
        for key, value in start.items():
            found = self._known.get(key)
            if found is None:
                found = self._known[key] = self._slots(key)
            slots, less, count = found
            values = number_or_each(key, value)
            if isinstance(values, np.ndarray):
                if values.size != count:
                    raise InputError(key, f"has {values.size} values for {count} asperites")
                values = values.reshape(y[slots].shape)
            y[slots] = values - less
        if start and self._has_bath:
            self._set_baths(y)
        return y

    def _slots(self, key: Any) -> tuple[Any, float, int]:
        """Where in y a "surface.quantity" is, what it is less there, and of how many asperites.

        Of one asperite that is an index, which numpy follows sooner.
        """
        surface, quantity = self.scene.initial_value(key)
        part = self.layout.parts[surface.name]
        slots = np.arange(part.start, part.stop)
        if quantity in ("phi", "nu"):
            slots = self.layout.model.asperites.dof_phi[part].astype(int)
        if quantity in ("omega", "nu"):
            slots = slots + self.layout.coordinates
        at: Any = slots if surface.count > 1 else int(slots[0])
        return at, surface.rest if quantity == "theta" else 0.0, surface.count

    @cached_property
    def _has_bath(self) -> bool:
        return self.layout.model.bath is not None or self.layout.model.torsional is not None

    def _set_baths(self, y: np.ndarray) -> None:
        """Start every bath anew about its bars, which have been put elsewhere."""
        n = self.layout.coordinates
        for index, surface in enumerate(self.scene.surfaces):
            part = self.layout.parts[surface.name]
            rng = np.random.default_rng([self.scene.seed, index, 1])
            bars = self.layout.model.asperites[part]
            set_bath(bars, surface, part, y[:n], y[n:], rng)

    def _result(self, runs: list[Integration], digest: Digest | None = None) -> Result:
        """The last run as a result, its error estimated from the two before it."""
        fine = runs[-1]
        kept = np.union1d(np.intersect1d(fine.samples.t, self.scene.times), fine.samples.t[-1:])
        books = ledger(self.layout, fine.samples.at(kept))
        bounds: dict[str, float | None] = {name: None for name in acc.KINDS if books.series(name)}
        t = kept
        if digest is not None:
            t, blocks, system = digest.series()
            books = Ledger(books.surfaces, blocks, system)
        notes = list(self._warnings)
        if digest is not None:
            notes.append("of the asperites' series only the first and the last sample are kept")
        for call in self.layout.calls:
            if call.error is not None:
                notes.append(f"the calculator raised {type(call.error).__name__}: {call.error}")
        met = None
        if len(runs) > 1 and self.accuracy is not None:
            met = False
            if fine.status == "completed":  # of the end of any other run nothing is known
                found, excess = self._judged(runs[-3:])
                bounds.update(found)
                met = excess <= 1.0
                if not met:
                    notes.append(self._missed(excess))
        return Result(
            scene=self.scene,
            t=t,
            ledger=books,
            status=fine.status,
            method=self.method.name,
            why=self.why,
            cost=self._price(runs),
            error_estimate=bounds,
            accuracy=self.accuracy,
            met=met,
            notes=tuple(notes),
        )

    def _judged(self, runs: list[Integration]) -> tuple[dict[str, float], float]:
        """Bounds on the last run's errors, and the largest in units of what was asked for."""
        assert self.accuracy is not None and self._tuned is not None
        names, grown = named_in(self.accuracy), self._tuned.amplification
        found, scales = estimated(self.layout, runs[-1], runs[:-1], grown, names)
        return found, excess_of_request(found, scales, self.accuracy)

    def _missed(self, excess: float) -> str:
        """That the request was not met, by how much, and why."""
        assert self.accuracy is not None and self._tuned is not None
        grown = self._tuned.amplification
        if grown is None and not self._tuned.met:
            why = "the search for settings was interrupted"
        elif self._tuned.met or grown is None:
            why = "the settings were found from the scene's own start, which kept it"
        else:
            why = out_of_reach(tightest(self.accuracy), grown)
        return f"errors are estimated at {excess:.1e} of the request; {why}"

    def _price(self, runs: list[Integration]) -> Cost:
        """What the runs took, and what a digit more or less would take."""
        seconds = sum(run.seconds for run in runs)
        ratio = None
        if self._tuned is not None and len(self._tuned.runs) > 2:
            coarse, fine = (run.evaluations for run in self._tuned.runs[-2:])
            # Samples shorten the steps of one run more; the order bounds what a digit costs.
            dearest = 10.0 ** (2.0 / self.method.order)
            ratio = min((fine / coarse) ** DIGIT, dearest) if coarse > 0 else None
        return Cost(
            steps=runs[-1].steps,
            force_evaluations=sum(run.evaluations for run in runs),
            wall_seconds=seconds,
            compile_seconds=self.compile_seconds,
            digit_more=None if ratio is None else seconds * ratio,
            digit_fewer=None if ratio is None else seconds / ratio,
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
    accuracy: Wanted | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Progress | None = None,
) -> Simulation:
    """Compile and plan a scene once; method and step are fixed here.

    `accuracy` is the largest error wanted in any reported quantity, relative to its scale, or one
    for each observable that matters, as ``{"upper.W": 1e-3}``; None takes the scene file's, else
    1e-8.  The method is the one that a model of costs finds cheapest, unless one is named.  A
    `method` and `step` of one's own are obeyed, and have no error estimate.  `progress` is told
    the time reached.  Raises InputError.
    """
    if not isinstance(scene, Scene):
        raise InputError("scene", f"must be a tribo.Scene, got {scene!r}")
    layout = lay_out(scene)
    own = any(item is not None for item in (accuracy, method, step))
    if own:
        if accuracy is None and step is None:
            accuracy = scene.numerics.accuracy
        plan = plan_for(layout, accuracy, method, step)
    else:
        wanted = scene.numerics
        with inside("numerics"):
            plan = plan_for(layout, wanted.accuracy, wanted.method, wanted.step)
    simulation = Simulation(layout, plan.method, progress, plan.why)
    if plan.step is not None:
        return simulation.with_step(plan.step)
    assert plan.accuracy is not None
    return simulation.within(plan.accuracy)


def from_settings(scene: Scene, settings: Settings) -> Simulation:
    """A scene that is run as another of its kind was planned to be: no run is made to find out."""
    return Simulation(lay_out(scene), methods.METHODS[settings.method]).by(settings)


def simulate(
    scene: Scene,
    accuracy: Wanted | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Progress | None = None,
) -> Result:
    """Run a scene once; arguments as for :func:`prepare`."""
    return prepare(scene, accuracy, method, step, progress).first_result()
