"""Elastic bodies: forces between the bars of a grid on a half-space or a layer, and their energy.

Fourier transforms compute them outside of the kernels; see `layout.elastic_body`.
"""

from tribo.compiler.jit import apart
from tribo.compiler.python_callback import call_at

# Places of the addresses in `Model.elastic`.
FORCES, ENERGIES = range(2)


@apart
def elastic_forces(model):
    """Add the forces of elastic bodies on the bars, whose displacements are in place."""
    if model.elastic.size > 0:
        call_at(model.elastic[FORCES])


@apart
def elastic_energies(model, stored, slot):
    """Add the energies of elastic bodies to (surfaces, slots) `stored`."""
    if model.elastic.size > 0:
        call_at(model.elastic[ENERGIES])
        for k in range(model.elastic_energy.size):
            stored[k, slot] += model.elastic_energy[k]
