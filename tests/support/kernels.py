"""Kernels that tests call."""

from numba import njit

from tribo.compiler.jit import NUMPY_ERRORS, UNCOUNTED

# Compiles a kernel that Python calls.
shared_kernel = njit(**NUMPY_ERRORS, **UNCOUNTED)
