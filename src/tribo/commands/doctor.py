"""The command `tribo doctor`: versions, the machine, compiled code on disk, the speed of a run."""

import argparse
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from tribo import __version__
from tribo.compiler.jit import cache_folder
from tribo.integrators.time_loops import adaptive_steps
from tribo.interrupts import COMPLETED, STOPPED
from tribo.system import available_cores

# Libraries whose versions matter for results and speed.
LIBRARIES = ("numpy", "numba", "llvmlite", "scipy", "xarray", "netCDF4", "matplotlib", "ase")
# Work on the upper asperite at the end of the paper's case A [energy].
KNOWN_WORK = 0.519665
# Accuracy of the run that is compared with it.
ACCURACY = 1e-8
# Largest difference from the known work: a unit of its last digit.
TOLERANCE = 1e-6


def run_doctor(options: argparse.Namespace) -> int:
    """Print versions, the machine, and whether the paper's case A gives its known work."""
    from tribo.paper import scene
    from tribo.simulation import simulate

    for name, value in versions().items():
        print(f"{name:<12} {value}")
    if options.compile:
        from tribo.commands.compile_ahead import compile_ahead

        compile_ahead()
    for name, value in _machine().items():
        print(f"{name:<12} {value}")
    result = simulate(scene("A"), accuracy=ACCURACY)
    work = float(result.end["surfaces"]["upper"]["w"][0])
    cost = result.cost
    healthy = abs(work - KNOWN_WORK) < TOLERANCE
    agrees = "agrees with" if healthy else "DIFFERS from"
    print(
        f"{'known run':<12} case A in {1e3 * cost.wall_seconds:.3g} ms, "
        f"{cost.compile_seconds:.2g} s to compile or load; "
        f"its work {work:.6f} {agrees} {KNOWN_WORK}"
    )
    after = "tribo new -o scene.toml   writes a scene to start from; tribo run scene.toml runs it"
    print(f"\nNext:  {after if healthy else 'pip install . --force-reinstall   in the checkout'}")
    return COMPLETED if healthy else STOPPED


def versions() -> dict[str, str]:
    """The versions of this package, of Python and of the libraries, and the system."""
    found = {}
    for name in LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "is missing: pip install . again in the checkout"
    own = {"python": platform.python_version(), "tribo": __version__}
    return own | found | {"system": f"{platform.system()} {platform.machine()}"}


def _machine() -> dict[str, str]:
    """Cores that this process may use, and compiled code on disk or beside the sources."""
    root = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(__file__).parents[1])
    folder = cache_folder(adaptive_steps)
    written = "cannot be written: each start compiles again; set NUMBA_CACHE_DIR to another folder"
    if folder is not None:
        written = f"new code goes to {folder}"
    folders = sorted({file.parent for file in root.rglob("*.nbc")})
    code = [file for folder in folders for file in folder.glob("*.nbc")]
    found = "no compiled functions yet"
    if folders:
        size = sum(file.stat().st_size for file in code) / 1e6
        place = os.path.commonpath(folders)
        found = f"{len(code)} compiled functions, {size:.1f} MB, below {place}"
    return {"cores": str(available_cores()), "cache": found, "writing": written}
