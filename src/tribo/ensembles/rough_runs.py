"""Differences of members that have numbers of their own from rougher runs, which tell their errors.

The energies of such members may differ by far, and so may the errors that one tolerance causes.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tribo.accuracy.scales import KINDS
from tribo.layout.member_numbers import MemberNumbers
from tribo.ledger.ledger import assemble
from tribo.loops.batch import MemberRuns


def rough_differences(
    runs: MemberRuns, rough: MemberRuns, numbers: MemberNumbers, accuracy: Mapping[str, float]
) -> np.ndarray:
    """The largest difference of each member from a rougher run (members,), in accuracies.

    Infinite where a run did not complete.  The scales of errors would take longer to compute than
    both runs; lower bounds on them stand in their place, which make differences larger.
    """
    members, scales = len(runs.counts), _least_scales(runs, numbers)
    own, other = (assemble(each.layout, each.samples) for each in (runs, rough))
    found = np.zeros(members)
    for name, relative in accuracy.items():
        scale = relative * scales[KINDS[name.rpartition(".")[2]]]
        for one, two in zip(own.series(name), other.series(name), strict=True):
            with np.errstate(divide="ignore", invalid="ignore"):
                gaps = np.abs(one - two).reshape(-1, members, *one.shape[1:2] or (1,))
                found = np.fmax(found, gaps.max(axis=(0, 2)) / scale)
    return np.where(runs.complete & rough.complete & ~np.isnan(found), found, np.inf)


def _least_scales(runs: MemberRuns, numbers: MemberNumbers) -> dict[str, np.ndarray | float]:
    """Lower bounds on the scales of each member, by kind of quantity."""
    a, members = numbers.asperites, len(runs.counts)
    n, asperites = runs.samples.y.shape[1] // 2, a.shape[1]
    rows = runs.samples.y.reshape(-1, members, 2 * n)
    rates = rows[..., n : n + asperites]
    phi = np.where(a["dof_phi"][0] >= 0, rows[..., a["dof_phi"][0]], 0.0)
    twists = rows[..., :asperites] - phi
    doubled = a["inertia"] * rates**2 + a["kappa"] * twists**2
    energy = 0.5 * np.abs(doubled - doubled[0]).max(axis=(0, 2))
    fastest = np.abs(rates).max(axis=(0, 2))
    moving = numbers.velocity - numbers.velocity.mean(axis=1, keepdims=True)
    speed = np.hypot(moving[..., 0], moving[..., 1]).max(axis=1)
    return {
        "rate": fastest,
        "length": (a["l1"] + a["l2"]).max(axis=1),
        "velocity": np.maximum(speed, fastest * a["l1"].min(axis=1)),
        "energy": energy,
        "total": energy,
        "angle": 1.0,
    }
