"""Commented scene files to start from, and the command `tribo new`."""

from tribo.starters.scenes_by_kind import KINDS, starter

__all__ = ["KINDS", "starter"]
