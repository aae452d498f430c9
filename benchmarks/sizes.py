"""Sizes of pages of `tribo view`, and the memory of a run for each asperite.

    python benchmarks/sizes.py pages    megabytes of four pages
    python benchmarks/sizes.py memory   bytes for each asperite, and megabytes of the libraries

The memory for each asperite is the difference of the peaks of two numbers of asperites, neighbour
lists included: during a run, and while the works of each asperite are assembled.  Each number runs
in a process of its own.  A run of two asperites gives the memory of Python and the libraries.
"""

import argparse
import contextlib
import io
import json
import resource
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import scale

import tribo
from tribo import paper
from tribo.commands import cli

# Numbers of asperites between which memory is compared.
FEW, MANY = 50_000, 200_000
# Samples of pages of many asperites.
SAMPLES = 31


def page(scene: tribo.Scene, *options: str) -> float:
    """Megabytes of the page that `tribo view` writes of a scene."""
    with tempfile.TemporaryDirectory() as folder:
        file, html = Path(folder, "scene.toml"), Path(folder, "page.html")
        scene.save(file)
        with contextlib.redirect_stdout(io.StringIO()):
            assert cli.main(["view", str(file), *options, "-o", str(html)]) == 0
        return html.stat().st_size / 1e6


def grids(asperites: int, samples: int) -> tribo.Scene:
    """Two grids that slide, with a step of Verlet for each sample."""
    return replace(
        scale.scene(asperites, (samples - 1) * scale.STEP),
        output=tribo.Output(samples=samples),
        numerics=tribo.Numerics(method="verlet", step=scale.STEP),
    )


def pages() -> dict[str, float]:
    """Megabytes of pages."""
    a = paper.scene("A")
    return {
        "case A": page(a),
        "case A with a slider of 41 values": page(a, "--slider", "upper.velocity=0.1:2"),
        "500 asperites": page(grids(500, SAMPLES)),
        "20,000 asperites": page(grids(20_000, SAMPLES)),
    }


def peaks(asperites: int) -> list[int]:
    """Bytes at the peaks of a run and of a ledger, in this process."""
    result = tribo.simulate(grids(asperites, 2))
    run = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert result["upper"].w1.any()
    return [1024 * run, 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss]


def memory() -> dict[str, float]:
    """Bytes for each asperite, and megabytes of Python and the libraries."""
    few, many, pair = (
        json.loads(subprocess.check_output([sys.executable, __file__, "peaks", str(n)]))
        for n in (FEW, MANY, 2)
    )
    asperites = grids(MANY, 2).count - grids(FEW, 2).count
    return {
        "bytes during a run": (many[0] - few[0]) / asperites,
        "bytes during a ledger": (many[1] - few[1]) / asperites,
        "megabytes of the libraries": pair[0] / 1e6,
    }


def main() -> None:
    """Measure what the command names."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("pages", "memory", "peaks"))
    parser.add_argument("asperites", type=int, nargs="?", help="of peaks")
    options = parser.parse_args()
    if options.what == "peaks":
        print(json.dumps(peaks(options.asperites)))
        return
    for name, number in (pages() if options.what == "pages" else memory()).items():
        print(f"{name:34} {number:.4g}")


if __name__ == "__main__":
    main()
