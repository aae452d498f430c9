"""What a block cannot go with: a surface whose bars are one rigid body, `kernels.rigid_block`."""

from typing import Any

import numpy as np

from tribo.validation import InputError


def check_block(surface: Any) -> None:
    """Refuse what has no equations on the bars of a block.  Raises InputError."""
    drive = surface.drive
    if drive.tilts and surface.elastic is not None:
        raise InputError("elastic", 'cannot go with drive.tilt = "free"')
    if not surface.is_rigid_block:
        return
    if surface.bars != "clamped":
        raise InputError("bars", 'must be "clamped" where drive.block = true')
    if surface.bath:
        problem = "cannot go with drive.block = true; langevin damps the bars of a block"
        raise InputError("bath", problem)
    if any(not reservoir.is_uniform for reservoir in surface.reservoirs):
        problem = "must have one gamma and one temperature where drive.block = true"
        raise InputError("langevin", problem)
    if surface.springs and surface.springs.turned:
        problem = "must be 0 where drive.block = true: springs do not stretch between its bars"
        raise InputError("springs.turned", problem)
    along_y = (name for name in ("stiffness_y", "damping_y") if getattr(drive, name, 0.0) != 0.0)
    for name in along_y:
        if surface.velocity[1] != 0.0:
            problem = f"must be 0 along y beside drive.{name}, got {surface.velocity[1]:g}"
            raise InputError("velocity", problem)
    if surface.tilts:
        _check_tilt(surface)
    elif surface.asperite.is_rigid:
        return
    if surface.initial.temperature:
        problem = "cannot go with drive.block = true unless asperite.kappa = inf: the mass matrix "
        raise InputError("initial.temperature", problem + "of a block depends on its pendulums")
    if surface.is_noisy:
        problem = "must be 0 where drive.block = true unless asperite.kappa = inf: no method here "
        raise InputError("langevin.temperature", problem + "integrates noise on such pendulums")


def _check_tilt(surface: Any) -> None:
    """Refuse what a block that turns about z cannot go with.  Raises InputError."""
    if surface.springs:
        problem = 'cannot go with drive.tilt = "free": they do not stretch between its bars'
        raise InputError("springs", problem)
    initial = surface.initial_of_each
    if initial["phi"].any():
        problem = 'must be 0 where drive.tilt = "free": the places of the bobs give the shape'
        raise InputError("initial.phi", problem)
    if np.ptp(initial["nu"]) > 0.0:
        problem = 'must be one number where drive.tilt = "free": all bars turn together'
        raise InputError("initial.nu", problem)
    if surface.initial.temperature:
        raise InputError("initial.temperature", 'cannot go with drive.tilt = "free"')
    if surface.is_noisy:
        problem = 'must be 0 where drive.tilt = "free": no method here integrates noise on it'
        raise InputError("langevin.temperature", problem)
