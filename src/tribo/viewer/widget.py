"""The player in a notebook, by anywidget."""

from collections.abc import Callable
from typing import Any

from tribo.validation import InputError
from tribo.viewer.html import module, part

try:
    import anywidget
    import traitlets
except ImportError:
    problem = 'needs anywidget: pip install ".[notebook]" in the checkout'
    raise InputError("widget", problem) from None


class Player(anywidget.AnyWidget):  # type: ignore[misc]
    """The player of runs as a widget, whose `source` contains the first run and the sliders.

    `run` returns what the player shows for values of the sliders, and raises InputError.
    """

    _esm = module()
    _css = part("style.css")
    source = traitlets.Dict().tag(sync=True)

    def __init__(
        self, source: dict[str, Any], run: Callable[[object], dict[str, Any]] | None = None
    ) -> None:
        super().__init__(source=source)
        self._run = run
        self.on_msg(self._answer)

    def _answer(self, _: object, values: object, buffers: object) -> None:
        """Send the run at some values, or what is wrong with them."""
        try:
            self.send({"run": self._run(values) if self._run else None})
        except InputError as error:
            self.send({"error": str(error)})
