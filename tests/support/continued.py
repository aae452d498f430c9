"""Scenes whose runs are paused, killed and continued, and what must be the same."""

import numpy as np

from tribo import (
    Asperite,
    Bath,
    Corrugation,
    Coulomb,
    Field,
    Free,
    Langevin,
    Morse,
    Output,
    Pulled,
    Scene,
    Surface,
)


def chain(times=(1.0, 2.0, 4.0), temperature=0.3, speed=0.2):
    """A pulled row with noise and a bath over a row with a moving field, by neighbour lists."""
    asperite = Asperite(kappa=3.0)
    upper = Surface(
        "upper",
        bob=(-1.0, 0.6),
        shape=(4, 1),
        spacing=(1.1, 0.0),
        asperite=asperite,
        drive=Pulled(stiffness=2.0, speed=speed),
        bath=Bath([0.1], [2.0]),
        langevin=Langevin(gamma=0.1, temperature=temperature),
    )
    lower = Surface("lower", facing="up", shape=(5, 1), spacing=(1.0, 0.0), drive=Free())
    field = Field(Corrugation(0.1, 2.0), ["lower"], velocity=(0.3, 0.0))
    potential = Morse(1.0, 2.5, 0.7).with_cutoff(1.4)
    output = Output(times=times)
    return Scene((upper, lower), potential, times[-1], fields=(field,), seed=3, output=output)


def pair(duration=8.0):
    """One asperite passes one."""
    upper = Surface("upper", bob=(-2.0, 0.0), velocity=(0.5, 0.0))
    lower = Surface("lower", facing="up", drive=Free())
    return Scene((upper, lower), Coulomb(0.2), duration, output=Output(samples=5))


def same_end(one, other):
    """Whether two results have the same bits from the first time of the second on."""
    ledger = one.ledger.rows(np.isin(one.t, other.t))
    pairs = [(ledger.t, other.t)]
    pairs += [(ledger.system[key], other.system[key]) for key in other.system]
    for kind in ("surfaces", "blocks"):
        for name, theirs in getattr(other.ledger, kind).items():
            mine = getattr(ledger, kind)[name]
            assert set(mine) == set(theirs)
            pairs += [(mine[key], theirs[key]) for key in theirs]
    return all(np.array_equal(a, b) for a, b in pairs)
