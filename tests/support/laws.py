"""The laws of the ledger: what kind every reported quantity is of, and how they hang together."""

import numpy as np

EXTERNAL = ("w1", "w2", "wL", "wR", "w_field", "w_T")  # all but the work within the surface
FORCES = ("w1", "w2", "w_int", "w_field", "w_T")  # works whose pseudowork is reported as well

KINDS = {
    **dict.fromkeys(("theta", "phi"), "angle"),
    **dict.fromkeys(("omega", "nu"), "rate"),
    **dict.fromkeys(("x_cm", "y_cm", "x_bob", "y_bob", "x_bar", "y_bar"), "length"),
    **dict.fromkeys(("vx_cm", "vy_cm"), "velocity"),
}

# The first quantity is the sum of the others, as far as a scene has them.
IDENTITIES = {
    "w = delta(k_trans + e_int)": ("w", "delta_k_trans", "delta_e_int"),
    "w_ps = delta_k_trans": ("w_ps", "delta_k_trans"),
    "w is the sum of the works": ("w", "w_int", *EXTERNAL),
    "w_ps is the sum of the pseudoworks": ("w_ps", *(f"{name}_ps" for name in FORCES)),
    "W = delta(K + E_int)": ("W", "delta_K", "delta_E_int"),
    "W_ps = delta_K": ("W_ps", "delta_K"),
    "applied work = change of energy": ("applied_work", "total_energy_change"),
}


def kind(name):
    """What a quantity is: all that is no angle, rate, length or velocity is an energy."""
    return KINDS.get(name, "energy")


def tables(result):
    """Every table of a ledger and whose it is: asperites and block of each surface, the system."""
    books = result.ledger
    for surface in result.scene.surfaces:
        yield surface, books.surfaces[surface.name]
        yield surface, books.blocks[surface.name]
    yield None, books.system


def identities(tables):
    """Every identity in some tables of a ledger: law, names of the quantities, the two sides."""
    for table in tables:
        for law, (whole, *parts) in IDENTITIES.items():
            if whole in table:
                present = [name for name in parts if name in table]
                yield law, (whole, *present), table[whole], sum(table[name] for name in present)


def largest_gaps(result):
    """The largest residual of each identity of a result's ledger."""
    found = {}
    for _, table in tables(result):
        for law, _, one, other in identities([table]):
            found[law] = max(found.get(law, 0.0), float(np.max(np.abs(one - other))))
    return found


def raw_samples(ledger):
    """The samples that a run's ledger computes its series from."""
    return ledger.samples
