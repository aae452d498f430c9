"""Moving pictures of a result: the asperites above, the works with their values below."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tribo.files import checked_target, replace_file
from tribo.plotting.marks import EDGE, POINTS_PER_INCH, Box, frame, with_minus
from tribo.plotting.picture import Picture
from tribo.plotting.pose import Pose, pose
from tribo.plotting.snapshots import typical_swing
from tribo.plotting.style import INK, style
from tribo.plotting.works import WORKS, look, symbol, with_pseudoworks, works_of
from tribo.results.run_result import RunResult
from tribo.validation import InputError, as_path, integer

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from PIL.Image import Image

# Names of files end on one of these, each with matplotlib's writer for it.
WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}
# Width of the picture [inch].
WIDTH = 6.0
# Height of the curves below it [inch].
CURVES = 1.9
# Height of the title [inch].
TITLE = 0.3
# Works that are drawn, each with its pseudowork: those of the forces and their sum.
DRAWN = ("w1", "w2", "w_int", "W")


def animate(
    result: RunResult,
    path: str | Path,
    frames: int = 120,
    rate: int = 20,
    surface: str | None = None,
    width: int = 1000,
    bath: bool = False,
) -> Path:
    """Write a moving picture of the run: see :meth:`tribo.Result.animate`."""
    from matplotlib.animation import writers
    from tqdm.auto import tqdm

    path = as_path(path)
    kind = path.suffix.lower()
    if kind not in WRITERS:
        raise InputError("path", f"must end on {' or '.join(WRITERS)}, got {str(path)!r}")
    if not writers.is_available(WRITERS[kind]):
        raise InputError("path", f"{kind} needs {WRITERS[kind]}, which is not installed; use .gif")
    integer("frames", frames, 2, 100_000)
    integer("rate", rate, 1, 1000)
    integer("width", width, 100, 10_000)
    name = result.scene.surfaces[0].name if surface is None else surface
    result.scene.index_of(name)
    checked_target("path", path)
    samples = np.unique(np.linspace(0, len(result.t) - 1, frames).round().astype(int))
    with style(), tempfile.TemporaryDirectory() as folder:
        film = Film(result, name, width, bath)
        counted = tqdm(samples.tolist(), disable=None, leave=False, unit="picture")
        written = Path(folder) / f"film{kind}"
        if kind == ".gif":
            _write_gif(film, int(samples[len(samples) // 2]), counted, written, rate)
        else:
            writer = writers[WRITERS[kind]](fps=rate)
            with writer.saving(film.figure, os.fspath(written), film.figure.dpi):
                for sample in counted:
                    film.show(sample)
                    writer.grab_frame()
        replace_file(path, written.read_bytes())
    return path


def _write_gif(film: Film, middle: int, samples: Iterable[int], path: Path, rate: int) -> None:
    """Write the pictures in the colours of that at `middle`: to choose colours takes long."""
    from PIL import Image

    plain: Any = {"dither": Image.Dither.NONE}
    colours = film.picture(middle).quantize(128, **plain)
    palette = np.array(colours.getpalette(), int).reshape(-1, 3)
    palette[np.argmax(palette.sum(axis=1))] = 255  # of the paper
    colours.putpalette(palette.ravel().tolist())
    pictures = [film.picture(k).quantize(palette=colours, **plain) for k in samples]
    pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=1000 // rate, loop=0)


class Film:
    """A figure of the asperites and of the works on a surface up to a sample, `width` pixels wide.

    `lines` has the line of each work, by its name.
    """

    def __init__(self, result: RunResult, surface: str, width: int, bath: bool = False) -> None:
        """Draw what stays: title, picture, and curves of works of a surface.

        The picture's scale fits the poses of 50 samples; `width` of the frames is in pixels.
        """
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self._result = result
        self._bath = bath
        some = np.unique(np.linspace(0, len(result.t) - 1, 50).astype(int))  # for its size
        boxes = np.array([self._pose(k).box for k in some])
        lows = boxes.min(axis=0)
        highs = boxes.max(axis=0)
        left, right = float(lows[0]), float(highs[1])
        bottom, top = float(lows[2]), float(highs[3])
        ideal = WIDTH * (top - bottom) / (right - left) + 0.3
        height = float(np.clip(ideal, 1.0, 3.4))  # inches
        total = height + CURVES + TITLE
        # A whole number of pixels, which is even, as films need.
        even = 2 * round(total * width / WIDTH / 2)
        self.figure: Figure = Figure(figsize=(WIDTH, even * WIDTH / width), dpi=width / WIDTH)
        self._canvas: Any = FigureCanvasAgg(self.figure)
        self._still: Any = None
        title = result.scene.title
        self.figure.text(0.5, 1.0 - 0.3 * TITLE / total, title, ha="center", va="center")
        above = self.figure.add_axes((0.0, CURVES / total, 1.0, height / total))
        above.set_axis_off()
        box = Box(left, right, bottom, top)
        frame(above, box, bottom=2 * EDGE, top=2 * EDGE, left=3 * EDGE, right=3 * EDGE)
        scale = min(WIDTH / (right - left), height / (top - bottom)) * POINTS_PER_INCH
        self._picture = Picture(above, self._pose(0), 1.0 / scale, typical_swing(result))
        self._clock = above.text(0.01, 0.98, "", transform=above.transAxes, va="top")
        below = self.figure.add_axes((0.09, 0.44 / total, 0.62, (CURVES - 0.54) / total))
        works = works_of(result, surface, None)
        names = [name for name in with_pseudoworks(DRAWN) if name in works]
        names = [name for name in names if "int" not in name or np.any(works[name])]
        self._works = {name: works[name] for name in names}
        self.lines: dict[str, Line2D] = {}
        self._values = {}
        for row, (name, values) in enumerate(self._works.items()):
            line = look(name)
            below.plot(result.t, values, **line | {"alpha": 0.2})
            (self.lines[name],) = below.plot([], [], **line)
            y = (CURVES - 0.24 - 0.2 * row) / total
            colour = line["color"]
            word = "pseudowork" if name.endswith("_ps") else WORKS[name].meaning
            self.figure.text(0.74, y, f"{symbol(name)} {word}", color=colour)
            self._values[name] = self.figure.text(0.99, y, "", color=colour, ha="right")
        (self._now,) = below.plot([], [], color=INK, linewidth=0.6)
        below.set(xlim=(result.t[0], result.t[-1]), ylabel=f"work on {surface}" if names else "")
        below.set_xlabel("$t$", labelpad=1.0)
        self._limits = below.get_ylim()
        self._moving = [*self._picture.artists, *self.lines.values(), self._now, self._clock]
        self._moving += self._values.values()

    def picture(self, sample: int) -> Image:
        """The picture at a sample; what does not move is drawn once."""
        from PIL import Image

        if self._still is None:
            for artist in self._moving:
                artist.set_animated(True)
            self._canvas.draw()
            self._still = self._canvas.copy_from_bbox(self.figure.bbox)
        self._canvas.restore_region(self._still)
        self.show(sample)
        for artist in self._moving:
            self.figure.draw_artist(artist)
        size = self._canvas.get_width_height()
        pixels = self._canvas.buffer_rgba()
        return Image.frombuffer("RGBA", size, pixels, "raw", "RGBA", 0, 1).convert("RGB")

    def _pose(self, sample: int) -> Pose:
        return pose(self._result, float(self._result.t[sample]), self._bath, wrap=True)

    def show(self, sample: int) -> None:
        t = self._result.t
        self._picture.show(self._pose(sample))
        self._clock.set_text(f"t = {t[sample]:.4g}")  # plain: formulas take long
        self._now.set_data([t[sample]] * 2, self._limits)
        for name, values in self._works.items():
            self.lines[name].set_data(t[: sample + 1], values[: sample + 1])
            self._values[name].set_text(with_minus(f"{values[sample]: z.4f}"))
