"""Draw the architecture from the code: ``python -m analysis.architecture --out docs/contributors``.

It writes ``architecture.png``. Layers come from the import contract in ``pyproject.toml``, sentences from the
packages' docstrings, arrows from the import statements. Nothing in the picture is typed by hand but the flow along its
top.
"""

import ast
import re
import textwrap
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch

__all__ = ["Room", "rooms"]

ROOT = Path(__file__).parents[1]
FLOW = ("scenario", "problem", "plan", "attack", "bracket,\ncertificate", "report")
"""Stages of a user's input, in order."""
WIDTH = 82
"""Characters of a line beside a room's name."""
HOUSE, ROOM, ARROW, FLOWS = "#1f2937", "#eef2f7", "#64748b", "#0f5f8f"


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """One module or package directly under ``ratt_opt``, or ``ratt_audit``.

    ``says`` : first sentence of its docstring; ``uses`` : names of the rooms it imports, at any place.
    """

    name: str
    says: str
    files: int
    lines: int
    uses: frozenset[str]


def rooms(root: Path = ROOT) -> list[Room]:
    """The rooms in the order of the import contract, the top layer first."""
    contracts = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
    layers = next(c for c in contracts["contracts"] if c["type"] == "layers")["layers"]
    parts = [part.strip(" ()") for layer in layers for part in layer.split("|")]
    return [_room(root.joinpath(*part.split(".")), part.removeprefix("ratt_opt.")) for part in parts]


def _room(folder: Path, name: str) -> Room:
    first = folder / "__init__.py" if folder.is_dir() else folder.with_suffix(".py")
    files = sorted(folder.rglob("*.py")) if folder.is_dir() else [first]
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for path in files}
    says = (ast.get_docstring(trees[first]) or "").split("\n\n")[0].replace("\n", " ").split(". ")[0]
    says = re.sub(r":\w+:|`", "", says).rstrip(".")  # without markup
    uses = {imported for tree in trees.values() for imported in _imported(tree)}
    lines = sum(path.read_text(encoding="utf-8").count("\n") for path in files)
    return Room(name=name, says=says, files=len(files), lines=lines, uses=frozenset(uses - {name}))


def _imported(tree: ast.AST) -> Iterator[str]:
    """Rooms that a file imports when it runs; what only type checkers read is left out."""
    skipped = {
        inner
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node not in skipped:
            package, *inside = str(node.module).split(".")
            if package == "ratt_opt" and inside:
                yield inside[0]
            elif package == "ratt_audit":
                yield package


def _draw(axes: Axes, layers: Sequence[Room]) -> None:
    height = len(layers)
    level = {room.name: height - k for k, room in enumerate(layers)}
    for room in layers:
        y = level[room.name]
        axes.add_patch(_box(0.0, y - 0.36, 7.4, 0.72))
        axes.text(0.12, y, room.name, va="center", weight="bold", size=9, color=HOUSE)
        axes.text(1.75, y, _lines(room.says), va="center", size=8, linespacing=1.1, color=HOUSE)
        axes.text(
            7.32, y, f"{room.files} files" if room.files > 1 else "", va="center", ha="right", size=7, color=ARROW
        )
    _arrows(axes, layers, level)
    for k, stage in enumerate(FLOW):
        x = 0.6 + 1.62 * k
        axes.text(x, height + 1.25, stage, ha="center", va="center", size=9, weight="bold", color=FLOWS)
        if k:
            axes.annotate(
                "", (x - 0.62, height + 1.25), (x - 1.0, height + 1.25), arrowprops={"arrowstyle": "->", "color": FLOWS}
            )
    axes.set_xlim(-0.1, 10.7)
    axes.set_ylim(0.3, height + 1.8)
    axes.axis("off")


def _arrows(axes: Axes, layers: Sequence[Room], level: Mapping[str, int]) -> None:
    """An arc from each room to every family it imports; what all of them use is not drawn."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Curve

    families = {room.name for room in layers if room.files > 1} | {"problem"}
    for room in layers:
        for used in sorted(room.uses & families):
            top, bottom = level[room.name] - 0.1, level[used] + 0.1
            reach = 7.45 + 0.28 * abs(top - bottom) ** 0.8
            curve = Curve([(7.4, top), (reach, top), (reach, bottom), (7.45, bottom)], [1, 4, 4, 4])
            axes.add_patch(PathPatch(curve, fill=False, lw=0.7, alpha=0.55, color=ARROW))
            axes.annotate(
                "", (7.4, bottom), (7.52, bottom), arrowprops={"arrowstyle": "-|>", "lw": 0.5, "color": ARROW}
            )


def _box(x: float, y: float, width: float, height: float) -> FancyBboxPatch:
    from matplotlib.patches import FancyBboxPatch

    return FancyBboxPatch((x, y), width, height, boxstyle="round,pad=0,rounding_size=0.08", fc=ROOM, ec=ARROW, lw=0.6)


def _lines(text: str) -> str:
    """The text in two lines at most."""
    return "\n".join(textwrap.wrap(text, WIDTH, max_lines=2, placeholder=" ...", break_on_hyphens=False))


def draw(out: Path) -> Path:
    """Write the picture and return its path."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    layers = rooms()
    figure, axes = plt.subplots(figsize=(11, 0.42 * (len(layers) + 2)), constrained_layout=True)
    _draw(axes, layers)
    path = out / "architecture.png"
    figure.savefig(path, dpi=100)
    plt.close(figure)
    return path


def main(out: Annotated[Path, typer.Option("--out", help="Folder for the picture.")] = Path("docs")) -> None:
    """Draw the house from its own code."""
    out.mkdir(parents=True, exist_ok=True)
    typer.echo(draw(out))


if __name__ == "__main__":
    typer.run(main)
