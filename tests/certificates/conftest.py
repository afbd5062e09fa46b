"""Every certificate that these tests write keeps to its schema."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import jsonschema
import pytest

from ratt_opt.certificates import write
from ratt_opt.report.schemas import output_schema

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from ratt_opt import Verified

LARGEST = 50_000
"""Bytes of a file that is looked at: of larger ones, which hold more of the same, it would take seconds."""


@pytest.fixture(scope="session")
def schema() -> jsonschema.Draft202012Validator:
    """The schema of certificates."""
    return jsonschema.Draft202012Validator(output_schema("certificate"))


@pytest.fixture(autouse=True, scope="module")
def _certificates_keep_to_their_schema(schema: jsonschema.Draft202012Validator) -> Iterator[None]:
    real = write.verify_certificate

    def verified(path: Path, **named: Any) -> Verified:
        if path.stat().st_size < LARGEST:
            schema.validate(json.loads(path.read_text(encoding="utf-8")))
        return real(path, **named)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(write, "verify_certificate", verified)
        yield
