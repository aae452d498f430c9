"""The forces on asperites as series, from the raw samples of a run.

The kernels compute them again in each sampled state, with noise in that of the next kick.  A force
that has white noise has no value at one time; its series is the mean over the interval that ends at
the sample, from its impulse.
"""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np

from tribo.compiler.lanes_memory import room
from tribo.kernels import probe
from tribo.kernels.records import BARS
from tribo.layout.layout import Layout
from tribo.layout.legs import SAME, legs_of
from tribo.layout.span import Span
from tribo.ledger.accounts import Accounts
from tribo.ledger.kick_places import at_next_kicks
from tribo.ledger.motion import Motion
from tribo.ledger.samples import Samples
from tribo.model.scene import Scene
from tribo.model.surface import Surface
from tribo.threads.writable_memory import Probe

# Whether a surface of a scene has something.
Has = Callable[[Scene, Surface], bool]


def always(scene: Scene, surface: Surface) -> bool:
    return True


class Force(NamedTuple):
    """A force on asperites."""

    table: int  # of what the kernels find
    meaning: str  # in a few words
    work: str = ""  # the name of its work; empty where it never has noise
    acts: Has = always  # on the asperites of a surface

    def is_known(self, scene: Scene, surface: Surface) -> bool:
        """Whether it acts and has a series.

        A force with noise is known by the impulses of each asperite, which only their ledger has.
        """
        has_accounts = scene.output.ledger == "asperites"
        return self.acts(scene, surface) and (
            has_accounts or all(FORCES[name] is not self for name in surface.noisy_forces)
        )


FORCES = {
    "f1": Force(probe.F1, "contact force on the bob"),
    "f_within": Force(
        probe.WITHIN, "contact force of bobs of the same surface", acts=Scene.has_contact_within
    ),
    "f_field": Force(probe.FIELD, "force of external fields on the bob", acts=Scene.has_field),
    "f2": Force(probe.F2, "drive on the bar", "w2"),
    "f_spring": Force(
        probe.SPRING,
        "force of lattice springs and the elastic body on the bar",
        acts=lambda scene, surface: bool(surface.springs) or surface.elastic is not None,
    ),
    "f_bath": Force(
        probe.BATH,
        "force of the bath on the bar",
        acts=lambda scene, surface: surface.bath.masses.size > 0,
    ),
    "f_block": Force(
        probe.BLOCK,
        "force of the constraint on the bar of a block",
        acts=lambda scene, surface: surface.is_rigid_block,
    ),
    "fL": Force(probe.LEFT, "force on the bar's left end", "wL"),
    "fR": Force(probe.RIGHT, "force on the bar's right end", "wR"),
    "f_T": Force(
        probe.FRICTION,
        "force of the reservoir on the bar",
        "w_T",
        lambda scene, surface: surface.reservoir("bar") is not None,
    ),
}


class Forces:
    """The forces on all asperites of a scene in the states of raw samples."""

    def __init__(self, layout: Layout, samples: Samples) -> None:
        self.layout = layout
        self._samples = samples
        self._states = samples  # in which forces are computed
        if layout.noisy_step > 0.0:
            self._states = at_next_kicks(layout, samples, layout.noisy_step)

    def of(self, motion: Motion, index: int, name: str, axis: int) -> np.ndarray:
        """The series of a force along x or y, axis 0 or 1, on a span, (times, asperites)."""
        force = FORCES[name]
        span = motion.span
        if name in self.layout.scene.surfaces[index].noisy_forces:
            return self._mean(span, force.work, axis)
        if name == "f2" and self.layout.surfaces[index].drive == BARS:
            return self._reaction(motion, axis)
        return self._found(span, force.table, axis)

    def _found(self, span: Span, table: int, axis: int = 0) -> np.ndarray:
        """A row of a table that the kernels find."""
        return self._every[:, table, axis, self.layout.places.columns[span.place]]

    def _mean(self, span: Span, work: str, axis: int) -> np.ndarray:
        """The mean of a force over the interval that ends at each sample.

        It is NaN at the first sample of this run, before which there may be that of an earlier one.
        """
        samples = self._samples
        accounts = Accounts(span, samples.s)
        impulse = accounts.whole((accounts[work].jx, accounts[work].jy)[axis])
        mean = np.full(impulse.shape, np.nan)
        mean[1:] = np.diff(impulse, axis=0) / np.diff(samples.t)[:, None]
        mean[: samples.index_from(self.layout.beginning) + 1] = np.nan
        return mean

    def _reaction(self, motion: Motion, axis: int) -> np.ndarray:
        """f2 on driven bars: what the motion of the centre of mass leaves over of other forces."""
        motion = Motion(self.layout, motion.span, self._states)
        a = motion.span.asperites
        tx, ty = motion.direction
        turning = self._found(motion.span, probe.SWING)
        inward = motion.omega**2
        acceleration = a.pivot * (
            turning * tx - inward * ty if axis == 0 else turning * ty + inward * tx
        )
        others = (force.table for name, force in FORCES.items() if name != "f2")
        return a.mass * acceleration - sum(self._found(motion.span, row, axis) for row in others)

    @cached_property
    def _every(self) -> np.ndarray:
        """What the kernels find, (times, TABLES, 2, columns)."""
        layout = self.layout
        samples = self._states
        found = room((samples.t.size, probe.TABLES, 2, layout.model.each.shape[1]))
        motion = probe.Motion(*(room((layout.room[0],)) for _ in range(3)))
        sampled = probe.Sampled(
            times=samples.t,
            y=np.ascontiguousarray(samples.y),
            baths=samples.baths,
            places=layout.places.q[: layout.core],
        )
        forces = Probe(layout, probe.force_probe)
        # A step of a schedule at the end of the run has a leg too, since forces are those after it.
        until = layout.scene.duration * (1.0 + 3.0 * SAME)
        every = legs_of(layout.scene, layout.scheduled, layout.begun, until)
        legs = every.of_times(samples.t)
        ends = [*np.flatnonzero(np.diff(legs)) + 1, legs.size]
        begin = 0
        for end in ends:
            forces.set_schedules(every.tables[legs[begin]])
            of_leg = sampled._replace(times=samples.t[:end])
            forces(end, of_leg, motion, found, begin=begin)
            begin = end
        return found
