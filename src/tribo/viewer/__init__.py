"""A page that plays a run in a browser: one file that loads nothing from elsewhere."""

from tribo.viewer.html import write_page

__all__ = ["write_page"]
