"""JSON Schemas of what commands print with ``--json`` and write as JSON; the files stand in ``ratt_opt/schemas``.

That of certificates is closed: the verifier reads no other fields. The others may come to hold more.
"""

from __future__ import annotations

import json
from importlib import resources
from typing import Any

__all__ = ["OUTPUTS", "output_schema"]

OUTPUTS = (
    *("report", "certificate", "cut-certificate", "attack", "cuts", "decentralised"),
    *("mission", "verification", "new"),
    *("audit", "audit-summary"),
)
"""The outputs; a schema's ``format`` names each. The inputs' schemas are made from their records instead."""


def output_schema(name: str) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of one of ``OUTPUTS``."""
    text = (resources.files("ratt_opt") / "schemas" / f"{name}.json").read_text(encoding="utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema
