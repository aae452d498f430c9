"""Time integration methods: their coefficients, their steps and the choice of step sizes.

`methods` is the table of all of them.
"""
