"""The time loop for one asperite on one, whose nodes are computed side by side in registers."""
