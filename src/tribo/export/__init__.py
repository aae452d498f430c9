"""Results in the forms of other libraries: ASE's atoms, pandas' tables."""
