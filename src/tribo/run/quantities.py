"""The reported quantities: the kind, the units and the meaning of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Table = dict[str, np.ndarray]  # quantity -> its series

# The units of each kind, in the scene's own units of length, time and energy.
UNITS = {
    "angle": "rad",
    "rate": "time^-1",
    "length": "length",
    "velocity": "length time^-1",
    "energy": "energy",
}


@dataclass(frozen=True)
class Quantity:
    """What a reported quantity is.

    Attributes
    ----------
    kind : str
        A key of `UNITS`; accuracies are relative to one scale per kind.
    long_name : str
        Its meaning in a few words.
    """

    kind: str
    long_name: str

    @property
    def units(self) -> str:
        """The units of its kind."""
        return UNITS[self.kind]


# Of each asperite, in the order in which they are reported.
ASPERITE_QUANTITIES = {
    "theta": Quantity("angle", "pendulum angle"),
    "phi": Quantity("angle", "bar angle"),
    "omega": Quantity("rate", "angular velocity of the pendulum"),
    "nu": Quantity("rate", "angular velocity of the bar"),
    "x_cm": Quantity("length", "x of the centre of mass"),
    "y_cm": Quantity("length", "y of the centre of mass"),
    "vx_cm": Quantity("velocity", "x velocity of the centre of mass"),
    "vy_cm": Quantity("velocity", "y velocity of the centre of mass"),
    "x_bob": Quantity("length", "x of the bob"),
    "y_bob": Quantity("length", "y of the bob"),
    "x_bar": Quantity("length", "x of the bar's centre"),
    "y_bar": Quantity("length", "y of the bar's centre"),
    "w1": Quantity("energy", "work of the contact force"),
    "w2": Quantity("energy", "work of the drive"),
    "wL": Quantity("energy", "work of the force on the bar's left end"),
    "wR": Quantity("energy", "work of the force on the bar's right end"),
    "w_int": Quantity("energy", "work of internal forces of the surface"),
    "w": Quantity("energy", "work of all forces"),
    "w1_ps": Quantity("energy", "pseudowork of the contact force"),
    "w2_ps": Quantity("energy", "pseudowork of the drive"),
    "w_int_ps": Quantity("energy", "pseudowork of internal forces of the surface"),
    "w_ps": Quantity("energy", "pseudowork of all forces"),
    "delta_k_trans": Quantity("energy", "change of translational kinetic energy"),
    "delta_e_int": Quantity("energy", "change of internal energy"),
}
# Of each asperite of a surface with a field or a reservoir.
OPTIONAL_QUANTITIES = {
    "w_field": Quantity("energy", "work of external fields"),
    "w_field_ps": Quantity("energy", "pseudowork of external fields"),
    "w_T": Quantity("energy", "work of the reservoir"),
    "w_T_ps": Quantity("energy", "pseudowork of the reservoir"),
    "heat": Quantity("energy", "heat given to the reservoir"),
}
# Of each surface as a whole.
BLOCK_QUANTITIES = {
    "W": Quantity("energy", "work of external forces on the surface"),
    "W_ps": Quantity("energy", "pseudowork of external forces on the surface"),
    "delta_K": Quantity("energy", "change of the surface's bulk kinetic energy"),
    "delta_E_int": Quantity("energy", "change of the surface's internal energy"),
}
# Of the whole system.
SYSTEM_QUANTITIES = {
    "contact_energy": Quantity("energy", "potential energy of contacts between surfaces"),
    "total_energy_change": Quantity("energy", "change of the total energy"),
    "applied_work": Quantity("energy", "work of drives, ends, reservoirs and moving fields"),
}
QUANTITIES = ASPERITE_QUANTITIES | OPTIONAL_QUANTITIES | BLOCK_QUANTITIES | SYSTEM_QUANTITIES
