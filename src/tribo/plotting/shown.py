"""Figures that a notebook shows, whether matplotlib's backend for notebooks is on or not."""

import io

from matplotlib.axes import Axes
from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A figure that shows itself at the end of a cell."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """The picture, and its width in a page."""
        content = io.BytesIO()
        self.savefig(content, format="png", dpi=220.0)
        width = round(float(self.get_figwidth()) * 110.0)  # displayed at half the resolution
        return content.getvalue(), {"width": width}


class ShownAxes(Axes):
    """Axes that show their figure at the end of a cell."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]] | None:
        """The picture of a figure of tribo's; others are shown by those who made them."""
        figure = self.get_figure(root=True)
        return figure._repr_png_() if isinstance(figure, ShownFigure) else None
