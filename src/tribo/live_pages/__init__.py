"""The kernel in a page: scenes of one asperite on one, simulated by the browser itself."""
