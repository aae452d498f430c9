"""One run of a scene: its layout as flat arrays, the integration, the ledger and the result.

A layout and a method make an integrator, whose raw samples become a ledger and then a result.
"""
