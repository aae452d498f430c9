"""Results as ASE's atoms and as pandas' tables; scenes as files of LAMMPS."""

from tribo.export.lammps import LammpsFiles, to_lammps

__all__ = ["LammpsFiles", "to_lammps"]
