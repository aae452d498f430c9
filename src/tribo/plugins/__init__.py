"""Classes that users write (potentials, drives, fields): checks, stamps, compile errors."""
