"""A drive of the user's own for one scene of the atlas."""

from typing import NamedTuple


class Push(NamedTuple):
    """A steady force along x; the contact force along y is balanced."""

    push: float

    def force_on_bar(self, t, x, y, vx, vy, fx, fy):  # type: ignore[no-untyped-def]
        """f2."""
        return self.push, -fy
