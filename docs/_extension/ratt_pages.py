"""What the site has beside its pages: the interface by topic, the notebooks, figures of examples, formulas."""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path
from typing import Any

import latex2mathml.converter
from docutils import nodes
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

import ratt_opt
from ratt_opt.report.schemas import OUTPUTS, output_schema
from ratt_opt.scenario.files import scenario_schema

DOCS = Path(__file__).parents[1]
INPUTS = ("scenario", "information")
SLUG = re.compile(r"[^a-z]+")


def setup(app: Any) -> dict[str, bool]:
    """Write the pages that are made of other things, before Sphinx looks for pages."""
    write_interface(DOCS / "api")
    write_schemas(DOCS / "schemas")
    copy_notebooks(DOCS / "notebooks")
    app.add_html_math_renderer("mathml", (formula, None), (formula, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write_interface(folder: Path) -> None:
    """One page a topic of the public names, from their docstrings."""
    for topic, names in ratt_opt.TOPICS.items():
        text = f"# {topic}\n\n" + "\n".join(map(_entry, names))
        _write(folder / f"{SLUG.sub('_', topic.lower()).strip('_')}.md", text)


def write_schemas(folder: Path) -> None:
    """One page a format: its fields as a table, and its JSON Schema."""
    for kind in (*INPUTS, *OUTPUTS):
        schema = scenario_schema(kind) if kind in INPUTS else output_schema(kind)
        fields = [
            f"| `{name}` | {'yes' if name in schema.get('required', []) else 'no'} | {_kind(value)} | {_said(value)} |"
            for name, value in schema["properties"].items()
        ]
        head = [
            f"# ratt-opt {kind}",
            "",
            _said(schema),
            "",
            "| field | must be there | type | |",
            "| --- | --- | --- | --- |",
        ]
        text = json.dumps(schema, indent=1, ensure_ascii=False)
        _write(folder / f"{kind}.md", "\n".join([*head, *fields, "", "## JSON Schema", "", "```json", text, "```", ""]))


def _kind(value: dict[str, Any]) -> str:
    """The JSON type of a field in words."""
    if "const" in value:
        return f"`{json.dumps(value['const'])}`"
    if "anyOf" in value:
        return " or ".join(map(_kind, value["anyOf"]))
    if "$ref" in value:
        return value["$ref"].rpartition("/")[2]
    kind = value.get("type", "any")
    return " or ".join(kind) if isinstance(kind, list) else str(kind)


def _said(value: dict[str, Any]) -> str:
    text = " ".join(str(value.get("description", "")).split())
    return "".join(f"\\{letter}" if letter in "|<>*_`[]" else letter for letter in text)


def _write(page: Path, text: str) -> None:
    """Unchanged pages keep their time, so that Sphinx reads only what is new."""
    page.parent.mkdir(exist_ok=True)
    if not page.exists() or page.read_text(encoding="utf-8") != text:
        page.write_text(text, encoding="utf-8")


def _entry(name: str) -> str:
    found = ratt_opt
    for part in name.split("."):
        found = getattr(found, part)
    if inspect.ismodule(found):
        # Its names too; the mark is what links to the module lead to.
        inner = "\n".join(_entry(f"{name}.{one}") for one in found.__all__)
        return f'<span id="ratt_opt.{name}"></span>\n\n{inspect.getdoc(found)}\n\n{inner}'
    if inspect.isclass(found):
        return f"```{{eval-rst}}\n.. autoclass:: ratt_opt.{name}\n   :members:\n```\n"
    if callable(found):
        return f"```{{eval-rst}}\n.. autofunction:: ratt_opt.{name}\n```\n"
    keys = ", ".join(map(repr, found))
    return f"```{{eval-rst}}\n.. data:: ratt_opt.{name}\n\n   A mapping with the keys {keys}.\n```\n"


def copy_notebooks(folder: Path) -> None:
    """The notebooks with the outputs they are committed with; their links to pages lead there from here too."""
    for notebook in (DOCS.parent / "notebooks").glob("*.ipynb"):
        _write(folder / notebook.name, notebook.read_text(encoding="utf-8").replace("](../docs/", "](../"))


def formula(translator: Any, node: nodes.Element) -> None:
    """A formula as MathML."""
    display = "block" if isinstance(node, nodes.math_block) else "inline"
    translator.body.append(latex2mathml.converter.convert(node.astext(), display=display))
    raise nodes.SkipNode


def figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the matplotlib figures that the names of an example have come to hold."""
    del block
    shown = block_vars.setdefault("shown_figures", [])
    paths = []
    for found in block_vars["example_globals"].values():
        if isinstance(found, Figure) and not any(found is other for other in shown):
            shown.append(found)
            path = next(block_vars["image_path_iterator"])
            found.savefig(path, dpi=100)
            paths.append(path)
    return figure_rst(paths, gallery_conf["src_dir"])


def _get_sg_image_scraper() -> Any:
    return figures
