"""The nodes of an upper proof under the names that the second version has for them."""

from __future__ import annotations

from typing import Any

__all__ = ["upper_of"]

NAMES = (({"cuts", "weights"}, "cuts", "fenchel"), ({"attack"}, "attack", "part"), ({"robot"}, "robot", "element"))
"""Fields of a node, the one that has another name now, and that name."""


def upper_of(part: Any) -> Any:
    """A record that is not of the form is returned as it is: the check refuses it."""
    if not isinstance(part, dict) or not isinstance(part.get("tree"), list):
        return part
    return {**part, "tree": [_named(node) for node in part["tree"]]}


def _named(node: Any) -> Any:
    if not isinstance(node, dict):
        return node
    for fields, old, new in NAMES:
        if set(node) - {"parts"} == fields and (old == "robot" or "parts" not in node):
            return {new: node[old], **{name: value for name, value in node.items() if name != old}}
    return {"unknown": None} if set(node) & {"fenchel", "part", "element"} else node
