"""From a scene and an accuracy to a result with error estimates."""

import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from tribo.accuracy.choose_method import Choice, choose
from tribo.accuracy.comparison import Accuracy, check_observables
from tribo.accuracy.plan import Plan, make_plan, plan_of_members
from tribo.analysis.deep_core import core_notes
from tribo.files import PART, netcdf_target
from tribo.integrators import methods
from tribo.integrators.own_method import coefficients_of
from tribo.kernels.status import Status
from tribo.layout.initial_state import Start
from tribo.layout.layout import Layout, lay_out
from tribo.ledger.ledger import check_keep
from tribo.loops.integrate import Progress
from tribo.loops.journal import Journal
from tribo.loops.origin import Origin, continued, digest_of
from tribo.loops.saved_state import State
from tribo.loops.select import Integrator
from tribo.model.identity import changes, identity_of, refuse_other, settings_of, version
from tribo.model.scene import Scene
from tribo.prepared import Simulation, with_warning
from tribo.progress import ProgressBar, Shown, reported, shown
from tribo.result import Result, load_result
from tribo.threads.shared_run import threads_of
from tribo.validation import TriboWarning, as_path, boolean, inside, instance


def prepare(
    scene: Scene,
    accuracy: Accuracy | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Shown = None,
    start: State | None = None,
    allow_unresolved: bool = False,
    threads: int | None = None,
) -> Simulation:
    """Compile and plan a scene once; method and settings are fixed here.

    Parameters
    ----------
    scene : Scene
        The scene to run.
    accuracy : float or mapping, optional
        The largest error of any reported quantity, relative to its scale, or of each observable
        that is named, as ``{"upper.W": 1e-3}``.  By default, unless a step is given, the accuracy
        or the step of the scene's numerics, else 1e-8.
    method : str, optional
        The name of a method.  By default that of the scene's numerics, else the fastest by a model
        of costs.
    step : float, optional
        A step [time] instead of an accuracy; such runs have no error estimate.
    progress : callable or bool, optional
        A function that is called with the time reached, a few times a second, in all runs.  By
        default a progress bar appears on a terminal or in a notebook after a second; True shows it
        elsewhere too, False never.
    start : State, optional
        The state from which all runs begin, such as that of a result; by default the start of the
        scene at t = 0.  In the scene of the state, works and changes of energy continue from
        their values in the state; in a scene with other forces they start at zero.
    allow_unresolved : bool
        Whether a step of a splitting method may be too long to resolve the fastest pendulum or
        spring, as in the scene's numerics.
    threads : int, optional
        Threads that share each step of a splitting method if that saves time; by default
        TRIBO_THREADS, else the number of cores.  The results do not depend on it.

    Raises
    ------
    InputError
        If settings exclude each other or do not suit the scene, the accuracy is out of reach, or
        a plug-in does not compile.
    KeyboardInterrupt
        The search for settings was interrupted.

    Warns
    -----
    TriboWarning
        Bobs start deep in a repulsive core.
    """
    task = _task(scene, accuracy, method, step, start, allow_unresolved, threads)
    report = shown(progress, task.layout.scene.duration, "t")
    if isinstance(report, ProgressBar):
        report = report.of_runs
    return _unless_interrupted(task.simulation(report))


def prepare_members(
    scene: Scene, accuracy: Accuracy | None, method: str | None, step: float | None
) -> Simulation:
    """As :func:`prepare` without progress, in one thread, for members of an ensemble.

    Members of a pair find settings of their own, and no search is made for its own run, but by
    :func:`tribo.accuracy.plan.plan_of_members`.
    """
    task = _task(scene, accuracy, method, step, None, False, threads=1)
    return _unless_interrupted(task.simulation(None, for_members=True))


def _unless_interrupted(simulation: Simulation) -> Simulation:
    """The simulation.  Raises KeyboardInterrupt if the search for its settings was interrupted."""
    tuned = simulation.plan.tuned
    if tuned is not None and tuned.runs[-1].status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    return simulation


class _Task(NamedTuple):
    """A scene to run: its layout, method and settings, and the state where it begins."""

    layout: Layout
    choice: Choice
    origin: Origin | None
    threads: int | None
    # How Simulation.run makes the run; None for the first result.
    changes: tuple[Start, bool] | None = None

    def simulation(
        self,
        progress: Progress | None,
        journal: Journal | None = None,
        for_members: bool = False,
    ) -> Simulation:
        """Compile and plan, with a bar for the runs; warn of bobs that start deep in a core."""
        layout = self.layout
        method = self.choice.method
        count = threads_of(layout.model, method, self.threads).number
        integrator = Integrator(layout, method, progress, self.origin, journal, count)
        for note in core_notes(layout):  # in Python: energies of plug-ins have compiled by now
            warnings.warn(note, TriboWarning, stacklevel=3)
        announce = progress.announce if isinstance(progress, ProgressBar) else None
        plan = None
        if for_members and integrator.pair is not None:
            plan = plan_of_members(self.choice, integrator)
        plan = make_plan(self.choice, integrator, announce) if plan is None else plan
        return Simulation(plan, integrator)

    def run(self, progress: Progress | None, journal: Journal | None = None) -> Result:
        """The result, which may be interrupted."""
        simulation = self.simulation(progress, journal)
        if self.changes is None:
            return simulation.compute_first()
        return simulation.compute(*self.changes)

    def to_end(self, shown: Shown, out: str | Path | None, resume: bool) -> Result:
        """The result, with its progress, in a file if there is one."""
        with reported(shown, self.layout.scene.duration, "t") as report:
            if out is None:
                return self.run(report)
            return _run_to_file(as_path(out), resume, self, report)


def _task(
    scene: Scene,
    accuracy: Accuracy | None,
    method: str | None,
    step: float | None,
    start: State | None,
    allow_unresolved: bool,
    threads: int | None,
) -> _Task:
    """What is asked for.  Raises InputError."""
    scene = instance(Scene)("scene", scene)
    if boolean("allow_unresolved", allow_unresolved):
        scene = replace(scene, numerics=replace(scene.numerics, allow_unresolved=True))
    layout, origin = (lay_out(scene), None) if start is None else continued(scene, start)
    given = scene.numerics
    if accuracy is None and method is None and step is None:
        with inside("numerics"):
            choice = choose(layout, given.accuracy, given.method, given.step)
    else:
        if accuracy is None and step is None:
            accuracy = given.accuracy
            step = given.step
        choice = choose(layout, accuracy, given.method if method is None else method, step)
    if isinstance(choice.accuracy, Mapping):
        check_observables(layout, choice.accuracy)
    check_keep(layout)
    return _Task(layout, choice, origin, threads)


def from_settings(scene: Scene, settings: Plan) -> Simulation:
    """A simulation without a search, by the settings of a scene that differs in numbers alone."""
    layout = lay_out(scene)
    return Simulation(settings, Integrator(layout, methods.METHODS[settings.method]))


def simulate(
    scene: Scene,
    accuracy: Accuracy | None = None,
    method: str | None = None,
    step: float | None = None,
    progress: Shown = None,
    start: State | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    allow_unresolved: bool = False,
    threads: int | None = None,
) -> Result:
    """Run a scene once.

    Parameters
    ----------
    scene, accuracy, method, step, allow_unresolved, threads
        As for :func:`prepare`.
    progress : callable or bool, optional
        As for :func:`prepare`.
    start : State, optional
        The state ``result.state()`` of another run, from which this one continues.  With the same
        method, step and recorded times it has the bits of a run without the pause.
    out : str or Path, optional
        A NetCDF file for the result.  Until that is complete, ``out`` with ``.part`` appended to
        its name contains what is done.
    resume : bool
        Continue from ``out.part``, with the same bits as without a pause.  Without such a file the
        run starts from the beginning, or ``out`` is read if it is complete.

    Raises
    ------
    InputError
        As for :func:`prepare`.
    KeyboardInterrupt
        The run was interrupted, as by Ctrl-C.  The attribute ``result`` of the exception has the
        Result up to there, if a part of it had been computed.

    Warns
    -----
    TriboWarning
        The run stops early, its error estimates exceed the accuracy, or bobs start deep in a core.
    """
    task = _task(scene, accuracy, method, step, start, allow_unresolved, threads)
    return with_warning(task.to_end(progress, out, resume))


def simulate_prepared(
    scene: Scene,
    changes: tuple[Start, bool],
    accuracy: Accuracy | None,
    method: str | None,
    step: float | None,
    out: str | Path | None = None,
    resume: bool = False,
    threads: int | None = None,
) -> Result:
    """As ``prepare(scene, accuracy, method, step).run(*changes)``, with its bits.

    `changes` are the initial values and whether errors are estimated; `out` and `resume` are those
    of :func:`simulate`, whose errors and warnings it raises.
    """
    task = _task(scene, accuracy, method, step, None, False, threads)
    return with_warning(task._replace(changes=changes).to_end(None, out, resume))


def _run_to_file(path: Path, resume: bool, task: _Task, progress: Progress | None) -> Result:
    """Run with a journal beside a file, which the result replaces once it is complete."""
    path = netcdf_target("out", path)
    choice = task.choice
    part = path.with_name(path.name + PART)
    start = digest_of(task.origin)
    settings = settings_of(choice.method.name, choice.accuracy, choice.step, start)
    settings |= coefficients_of(choice.method.name)
    if task.changes is not None:
        settings |= changes(*task.changes)
    identity = identity_of(task.layout.scene, settings, version())
    if resume and path.exists() and not part.exists():
        result = load_result(path)
        if choice.automatic:  # and may have been halved
            settings["step"] = result.settings["step"]
        refuse_other(path, identity_of(result.scene, result.settings, result.version), identity)
        return result
    with Journal(part, identity, resume) as journal:
        result = task.run(progress, journal)
        if result.status != Status.INTERRUPTED:
            result.save(path)
            journal.remove()
    return result
