"""A scene with every kind of account that depends on places alone, whose time loops tests share."""

from tribo import (
    Asperite,
    Bath,
    Corrugation,
    Coulomb,
    Field,
    Free,
    Initial,
    Interaction,
    Morse,
    Output,
    Pulled,
    Scene,
    Springs,
    Surface,
)


def everything(duration, samples=2, mass=0.2):
    """Two and two asperites; the lower ones have an oscillator of a mass each."""
    upper = Surface(
        "upper",
        bob=(-1.5, 2.5),
        velocity=(0.4, 0.0),
        shape=(2, 1),
        spacing=(1.0, 0.0),
        heights=(0.0, 0.05),
        drive=Pulled(stiffness=1.0, speed=0.6, load=0.05),
        bars="free",
        springs=Springs(0.8),
        asperite=Asperite(m1=(1.0, 1.5), charge=(1.0, 0.7)),
        initial=Initial(theta=0.3, nu=0.2, omega=-0.2),
    )
    lower = Surface(
        "lower",
        facing="up",
        shape=(2, 1),
        spacing=(0.9, 0.0),
        drive=Free(),
        bath=Bath(masses=(mass,), frequencies=(0.8,)),
        initial=Initial(nu=0.3, phi=0.1),
    )
    field = Field(Corrugation(0.1, 1.5), on=("upper", "lower"), velocity=(0.2, 0.0))
    contacts = (
        Interaction(Coulomb(4.0), between=("upper", "lower")),
        Interaction(Morse(0.2, 0.4, 1.0), between=("upper", "upper")),
    )
    output = Output(samples=samples)
    return Scene((upper, lower), contacts, duration, fields=(field,), output=output)
