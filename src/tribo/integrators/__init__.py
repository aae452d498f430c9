"""Time integration methods: coefficients, steps, step control and time loops.

`methods` is the table of all of them.
"""
