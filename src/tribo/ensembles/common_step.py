"""One step for all members of an ensemble with noise, where none is given.

A step for each member would depend on what the member meets, and leaving out the members that meet
more would select.  So some members are run before the others, to their ends, with one step, which
is shortened until it resolves the motion of all of these.  A member that later meets more is run
again with a shorter step.
"""

import numpy as np

from tribo.accuracy.choose_method import bounded_step
from tribo.accuracy.noisy_step import resolving_step
from tribo.ensembles.batches import Policy, SingleRuns, StepRuns
from tribo.ensembles.members import Members, Variation
from tribo.layout.layout import lay_out
from tribo.layout.own_numbers import member_numbers
from tribo.loops.select import Integrator
from tribo.prepared import MOST_REPEATS, MOST_REPEATS_FOR_ENERGY, Simulation

# Members that are run before the others: those of one call in lanes.
FIRST_MEMBERS = 8
# One in so many members is run before the others, at most: they take a quarter of the time.
FEWEST = 4
# The same of members that are run one by one, of which the first steps alone are run.
FIRST_STARTS = 4
# Members with numbers of their own by which the step is bounded at once, and the most of members
# that are run one by one: their scenes take some milliseconds each.
BOUNDED = 4096
BOUNDED_ALONE = 256


def with_common_step(policy: Policy, variation: Variation, count: int) -> Policy:
    """The same policy, whose step resolves the motion of the first members of `count`."""
    step = policy.simulation.plan.setting.of_equal_steps()
    before = count // FEWEST
    if isinstance(policy, StepRuns):
        if variation.own_numbers:
            policy = _with_step(policy, min(step, _bound(policy, variation, count)))
        if not before:
            return policy
        first = variation.sample(count, min(FIRST_MEMBERS, before))
        tries = MOST_REPEATS
        for_energy = MOST_REPEATS_FOR_ENERGY
        while True:
            assert isinstance(policy, StepRuns)
            runs = policy.run(first)
            shorter = policy.shorter_step(runs)
            if shorter is not None and tries > 0:
                tries -= 1
            elif shorter is None and for_energy > 0 and policy.misses_energy(runs):
                for_energy -= 1
                shorter = 0.5 * policy.simulation.plan.setting.of_equal_steps()
            else:
                return policy
            policy = _with_step(policy, shorter)
    assert isinstance(policy, SingleRuns)
    if before:
        step = min(step, _of_starts(policy, variation.sample(count, min(FIRST_STARTS, before))))
    if variation.own_numbers:
        step = min(step, _of_scenes(policy, variation.sample(count, BOUNDED_ALONE)))
    return _with_step(policy, step)


def _with_step(policy: Policy, step: float) -> Policy:
    simulation = policy.simulation
    plan = simulation.plan.with_step(step)
    if plan.setting.step == simulation.plan.setting.step:
        return policy
    return type(policy)(Simulation(plan, simulation.integrator), policy.kept, policy.own_numbers)


def _bound(policy: Policy, variation: Variation, count: int) -> float:
    """The longest step by the frequencies that the members' numbers state."""
    layout = policy.simulation.layout
    found = np.inf
    for first in range(0, count, BOUNDED):
        members = variation.members(np.arange(first, min(count, first + BOUNDED)))
        numbers = member_numbers(layout, members.numbers.size, members.values)
        found = min(found, bounded_step(layout, numbers))
    return float(found)


def _of_scenes(policy: Policy, members: Members) -> float:
    """The same of members that are run one by one, by their scenes."""
    base = policy.simulation.scene
    found = np.inf
    for index in range(members.numbers.size):
        found = min(found, bounded_step(lay_out(members.scene(index, base))))
    return float(found)


def _of_starts(policy: Policy, members: Members) -> float:
    """The shortest of the steps that resolve what members meet first."""
    simulation = policy.simulation
    found = np.inf
    for index in range(members.numbers.size):
        scene = members.scene(index, simulation.scene, with_start=True)
        layout = lay_out(scene)
        integrator = Integrator(layout, simulation.method)
        found = min(found, resolving_step(integrator, bounded_step(layout)))
    return float(found)
