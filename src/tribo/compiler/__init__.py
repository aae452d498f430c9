"""The numba layer: how Python functions become machine code.  It knows no physics.

:mod:`tribo.compiler.numba_private` is the only file that imports undocumented names of numba.
"""
