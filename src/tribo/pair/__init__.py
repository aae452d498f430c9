"""The time loop for one asperite on one, which keeps the whole state in registers."""
