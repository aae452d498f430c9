"""Runs of a layout: the loops for single runs and for members, and what guards and feeds them."""
