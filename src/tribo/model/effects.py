"""Effects that a scene can have."""

from __future__ import annotations

from enum import StrEnum


class Effect(StrEnum):
    """Something that a scene can call for; `description` says what it is."""

    description: str

    CONTACT = "contact", "forces between the bobs of different surfaces"
    SWING = "swing", "pendulums on torsion springs"
    SLIDING = "sliding", "centres of mass that can leave their uniform motion"
    RIGID = "rigid asperites", "asperites whose pendulums are fixed to clamped bars"
    DRIVEN_BARS = "driven bars", "bars that a constraint moves uniformly, or holds"
    TURNING_BARS = "turning bars", "bars that rotate freely"
    CLAMPED_ENDS = (
        "clamped ends",
        "forces on the ends of clamped bars that have a torsion spring to hold",
    )
    PULL = "pull", "springs to a moving stage"
    PUSH = "push", "a force on each bar that is constant, or grows"
    LOAD = "load", "a force that presses the surfaces together"
    OWN_DRIVE = "own drive", "forces f2 of the user's own"
    OWN_ENDS = "own ends", "forces of the user's own on the ends of bars"
    SPRINGS = "springs", "lattice springs between neighbouring bars"
    BATH = "bath", "oscillators on every bar"
    TORSIONAL_BATH = "torsional bath", "torsional oscillators on every bar"
    LANGEVIN = "langevin", "damping and noise at every bar"
    SWING_LANGEVIN = "swing langevin", "damping and noise on every pendulum"
    FIELD = "field", "external fields on bobs"
    CALCULATOR = "calculator", "contact computed by an ASE calculator, at its own cost"
    CONTACT_WITHIN = "contact within", "forces among the bobs of one surface"
    CUTOFF = (
        "cutoff",
        "interactions that end at a distance, by neighbour lists where there are many bobs",
    )
    PERIODIC = "periodic", "nearest images along x or z"

    def __new__(cls, name: str, description: str) -> Effect:
        """A string with a description."""
        effect = str.__new__(cls, name)
        effect._value_ = name
        effect.description = description
        return effect
