"""The synthetic scan of the tests and examples, examples/scan.x3p.

    python tests/support/synthetic_scan.py

writes it: self-affine heights on a tilted plane, as a microscope records them.
"""

from pathlib import Path

import numpy as np

from tribo import Roughness
from tribo.model.roughness import draw

FILE = Path(__file__).resolve().parents[2] / "examples" / "scan.x3p"
# Points along x and y.
POINTS = (48, 12)
# Distance between points [nm].
PIXEL = 0.5
# Root mean square of the heights about a plane [nm].
RMS = 0.35
# Slopes of the plane.
TILT = (0.05, -0.08)


def scan_heights():
    """(48, 12) heights of the scan, the first index along x [nm]."""
    roughness = Roughness(rms=RMS, hurst=0.8, shortest=4 * PIXEL, seed=12)
    rough = draw(roughness, POINTS, (PIXEL, PIXEL), np.random.default_rng())
    x, y = (PIXEL * np.arange(n) for n in POINTS)
    return rough.reshape(POINTS[::-1]).T + TILT[0] * x[:, None] + TILT[1] * y


def main():
    """Write the file."""
    from SurfaceTopography import Topography

    sizes = tuple(n * PIXEL for n in POINTS)
    Topography(scan_heights(), sizes, unit="nm").to_x3p(str(FILE))


if __name__ == "__main__":
    main()
