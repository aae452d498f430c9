"""How the documents are built: ``sphinx-build -W docs docs/_build``."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True

import generate  # noqa: E402
import inventories  # noqa: E402

import tribo  # noqa: E402

project = "tribo"
author = "The tribo developers"
copyright = "2026, the tribo developers"
release = version = tribo.__version__

extensions = ["mathml", "phone_tables", "shared_text", "live_frames", "myst_parser"]
extensions += ["sphinx_design", "sphinx_copybutton"]
extensions += [f"sphinx.ext.{name}" for name in ("autodoc", "intersphinx", "napoleon")]
html_math_renderer = "mathml"  # works without a network
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "_generated", "_inventories", "measured"]

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_preprocess_types = True
napoleon_type_aliases = inventories.ALIASES
napoleon_use_ivar = True  # attributes as a list of fields, without entries of their own

intersphinx_mapping = inventories.write(HERE / "_inventories")

html_theme = "furo"
html_title = "tribo"
html_copy_source = False
html_static_path = ["static"]
html_css_files = ["pages.css"]
copybutton_selector = "div[class*='highlight-']:not(.highlight-text):not(.highlight-none) pre"


def setup(app):
    """Generate the files that pages include."""
    app.connect("builder-inited", lambda app: generate.everything(HERE / "_generated"))
