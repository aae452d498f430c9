"""The player in a notebook, by anywidget."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from tribo.validation import InputError
from tribo.viewer.html import document, frame, module, part

try:
    import anywidget
    import traitlets
except ImportError:
    problem = 'needs anywidget: pip install ".[notebook]" in the checkout'
    raise InputError("widget", problem) from None

# Height of a page that stands for the widget [pixels].
FRAME_HEIGHT = 760


class Player(anywidget.AnyWidget):  # type: ignore[misc]
    """The player of runs as a widget, whose `source` contains the first run and the sliders.

    `run` returns what the player shows for values of the sliders, and raises InputError.  `live`
    returns the live page that stands for the widget where no kernel answers, as in an exported
    notebook; where it raises InputError, the page with the first run does.
    """

    _esm = module()
    _css = part("style.css")
    source = traitlets.Dict().tag(sync=True)

    def __init__(
        self,
        source: dict[str, Any],
        run: Callable[[object], dict[str, Any]] | None = None,
        live: Callable[[], Any] | None = None,
    ) -> None:
        """Show the first run, and answer the page when its sliders ask for another one."""
        super().__init__(source=source)
        self._run = run
        self._live = live
        self.on_msg(self._answer)

    def _answer(self, _: object, values: object, buffers: object) -> None:
        """Send the run at some values, or what is wrong with them."""
        try:
            self.send({"run": self._run(values) if self._run else None})
        except InputError as error:
            self.send({"error": str(error)})

    def _repr_mimebundle_(self, **given: Any) -> Any:
        """The widget, and a page in HTML, which exports show that store no state of widgets."""
        found = super()._repr_mimebundle_(**given)
        if found is not None:
            data, _ = found
            data["text/html"] = self._without_kernel()
        return found

    def _without_kernel(self) -> str:
        """The live page in a frame, or the page of the first run."""
        if self._live is not None:
            with suppress(InputError, OSError):  # OSError: no process compiles the page's module
                html: str = self._live()._repr_html_()
                return html
        run = self.source["run"]
        return frame(document({"run": run, "sliders": []}), run["title"], FRAME_HEIGHT)
