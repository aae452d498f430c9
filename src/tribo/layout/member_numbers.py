"""Members of an ensemble that differ in velocities and in numbers of asperites and potential."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class MemberNumbers(NamedTuple):
    """The numbers of some members, where they differ from the scene of all."""

    asperites: np.ndarray  # (members, n) of ASPERITE, with the slots of the scene's layout
    charges: np.ndarray  # (members, n)
    velocity: np.ndarray  # (members, surfaces, 2) in the laboratory
    of_surfaces: np.ndarray  # (members, surfaces, numbers), see OF_MEMBERS
    # (members, fields) of the only interaction; without columns where it has others.
    potential: np.ndarray

    def of_members(self, selected: np.ndarray | slice) -> MemberNumbers:
        """Those of some members."""
        return MemberNumbers(*(each[selected] for each in self))

    def displaced(self, x: np.ndarray, y: np.ndarray) -> MemberNumbers:
        """The same with the asperites' places displaced (n,)."""
        asperites = self.asperites.copy()
        asperites["x"] += x
        asperites["y"] += y
        return self._replace(asperites=asperites)
