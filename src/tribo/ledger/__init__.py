"""From samples to works, pseudoworks, energies and forces, series by series."""
