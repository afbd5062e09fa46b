"""Every certificate that these tests write keeps to its schema."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from ratt_opt import Verified
from ratt_opt.report.schemas import output_schema
from tests.certificates.engine import step

LARGEST = 50_000
"""Bytes of a file that is looked at: of larger ones, which hold more of the same, it would take seconds."""


@pytest.fixture(scope="session")
def schema() -> jsonschema.Draft202012Validator:
    """The schema of certificates."""
    return jsonschema.Draft202012Validator(output_schema("certificate"))


@pytest.fixture(autouse=True, scope="module")
def _certificates_keep_to_their_schema(schema: jsonschema.Draft202012Validator) -> Iterator[None]:
    def looking(real: Callable[..., Verified]) -> Callable[..., Verified]:
        def verified(path: Path, **named: Any) -> Verified:
            if path.stat().st_size < LARGEST:
                schema.validate(json.loads(path.read_text(encoding="utf-8")))
            return real(path, **named)

        return verified

    with pytest.MonkeyPatch.context() as patch:
        step(patch, "verification", looking)
        yield
