"""Where other projects document the names that the pages mention.

sphinx.ext.intersphinx reads such tables from the projects' sites.  Builds are offline, so the few
names that are needed stand here.
"""

import zlib
from pathlib import Path

# Project: the address of its documents, and pages by the names that they document.
PROJECTS = {
    "python": (
        "https://docs.python.org/3/",
        {
            "library/functions.html": ("bool", "float", "int"),
            "library/stdtypes.html": ("dict", "list", "str", "tuple"),
            "library/collections.abc.html": ("collections.abc.Mapping",),
            "library/pathlib.html": ("pathlib.Path",),
        },
    ),
    "numpy": (
        "https://numpy.org/doc/stable/",
        {"reference/generated/numpy.ndarray.html": ("numpy.ndarray",)},
    ),
    "scipy": (
        "https://docs.scipy.org/doc/scipy/",
        {"reference/generated/scipy.stats.qmc.QMCEngine.html": ("scipy.stats.qmc.QMCEngine",)},
    ),
    "matplotlib": (
        "https://matplotlib.org/stable/",
        {
            "api/_as_gen/matplotlib.axes.Axes.html": ("matplotlib.axes.Axes",),
            "api/_as_gen/matplotlib.figure.Figure.html": ("matplotlib.figure.Figure",),
        },
    ),
    "xarray": (
        "https://docs.xarray.dev/en/stable/",
        {"generated/xarray.Dataset.html": ("xarray.Dataset",)},
    ),
    "pandas": (
        "https://pandas.pydata.org/docs/",
        {"reference/api/pandas.DataFrame.html": ("pandas.DataFrame",)},
    ),
    "ase": ("https://ase-lib.org/", {"ase/atoms.html": ("ase.Atoms",)}),
}
# Short names in docstrings.
ALIASES = {"ndarray": "numpy.ndarray", "Path": "pathlib.Path"}


def write(folder: Path) -> dict[str, tuple[str, str]]:
    """Write an inventory for each project; returns what `intersphinx_mapping` takes."""
    folder.mkdir(exist_ok=True)
    mapping = {}
    for project, (address, pages) in PROJECTS.items():
        names = [(name, page) for page, each in pages.items() for name in each]
        lines = [f"{name} py:class 1 {page}#{name} -" for name, page in names]
        head = f"# Sphinx inventory version 2\n# Project: {project}\n# Version: \n"
        head += "# The remainder of this file is compressed using zlib.\n"
        path = folder / f"{project}.inv"
        path.write_bytes(head.encode() + zlib.compress("\n".join(lines).encode() + b"\n"))
        mapping[project] = (address, str(path))
    return mapping
