"""The picture of the package, drawn from its imports: each folder above what it imports.

python docs/house.py FILE.png
"""

import ast
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import tribo
from tribo import plotting

ROOT = Path(tribo.__file__).parent
# Small files that nearly all others import, or one; lines to them would hide the rest.
LEFT_OUT = {"validation", "system", "interrupts", "progress", "files", "units", "first_read"}
LEFT_OUT |= {"seals", "starters", "__main__"}
# Width and height of the picture [inch].
SIZE = (6.2, 7.6)


def imports() -> dict[str, set[str]]:
    """Folder, or file at the top, of the package -> the others that it imports."""
    found: dict[str, set[str]] = {}
    for path in ROOT.rglob("*.py"):
        room = path.relative_to(ROOT).parts[0].removesuffix(".py")
        if room == "__init__" or room in LEFT_OUT:
            continue
        named = found.setdefault(room, set())
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("tribo."):
                named.add(node.module.split(".")[1])
            elif isinstance(node, ast.ImportFrom) and node.module == "tribo":
                named |= {alias.name for alias in node.names}
    return {room: (named & found.keys()) - {room} for room, named in found.items()}


def heights(graph: dict[str, set[str]]) -> dict[str, int]:
    """The length of the longest chain of imports below each folder."""
    found: dict[str, int] = {}
    for room in TopologicalSorter(graph).static_order():
        found[room] = 1 + max((found[other] for other in graph[room]), default=-1)
    return found


def needed(graph: dict[str, set[str]]) -> list[tuple[str, str]]:
    """The imports that do not follow from others: those that the picture shows as lines."""
    below: dict[str, set[str]] = {}
    for room in TopologicalSorter(graph).static_order():
        below[room] = graph[room].union(*(below[other] for other in graph[room]))
    return [
        (room, other)
        for room, others in graph.items()
        for other in others
        if not any(other in below[third] for third in others - {other})
    ]


def draw(path: Path) -> None:
    """Draw the folders, higher ones above, with lines to those that they import."""
    graph = imports()
    height = heights(graph)
    rows = [sorted(r for r in graph if height[r] == h) for h in range(max(height.values()) + 1)]
    place: dict[str, tuple[float, float]] = {}
    for h, row in enumerate(rows):
        for number, room in enumerate(row):  # odd rows are shifted, so that lines do not hide
            place[room] = ((number + 0.5) / len(row) + 0.06 * (h % 2) - 0.03, float(h))
    ax = plotting.axes(*SIZE)
    with plotting.style():
        for room, other in needed(graph):
            (x, y), (u, v) = place[room], place[other]
            ax.plot([x, u], [y - 0.25, v + 0.25], color="0.6", linewidth=0.7, zorder=1)
        for room, (x, y) in place.items():
            box = {"boxstyle": "round,pad=0.3", "facecolor": "white", "edgecolor": plotting.INK}
            ax.text(x, y, room, ha="center", va="center", fontsize=8, bbox=box, zorder=2)
        ax.set(xlim=(-0.05, 1.05), ylim=(-0.6, len(rows) - 0.4))
        ax.set_axis_off()
    plotting.save(ax, path)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
