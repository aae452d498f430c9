"""The built-in potentials, by their names in scene files."""

from tribo.potentials.born_mayer import BornMayer
from tribo.potentials.buckingham import Buckingham
from tribo.potentials.coulomb import Coulomb
from tribo.potentials.gaussian import Gaussian
from tribo.potentials.hertz import Hertz
from tribo.potentials.lennard_jones import LennardJones
from tribo.potentials.mie import Mie
from tribo.potentials.morse import Morse
from tribo.potentials.plummer import Plummer
from tribo.potentials.soft_sphere import SoftSphere
from tribo.potentials.weeks_chandler_andersen import WeeksChandlerAndersen
from tribo.potentials.yukawa import Yukawa

BUILT_IN: dict[str, type] = {
    "coulomb": Coulomb,
    "morse": Morse,
    "lennard-jones": LennardJones,
    "yukawa": Yukawa,
    "buckingham": Buckingham,
    "born-mayer": BornMayer,
    "weeks-chandler-andersen": WeeksChandlerAndersen,
    "mie": Mie,
    "plummer": Plummer,
    "hertz": Hertz,
    "soft-sphere": SoftSphere,
    "gaussian": Gaussian,
}
