"""What a row depends on, versions and code; also how a remote worker proves that it has the package."""

from __future__ import annotations

import hashlib
import platform
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import ratt_opt

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["VERSIONS", "hash_of_modules"]


def _hash_of_code() -> str:
    """A hash of every source file of the package and of the engine of studies: the same wherever they are installed."""
    digest = hashlib.sha256()
    for root in (Path(ratt_opt.__file__).parent, Path(__file__).parent):
        for file in sorted(root.rglob("*.py"), key=lambda file: file.relative_to(root).as_posix()):
            content = file.read_bytes()
            digest.update(f"{file.relative_to(root).as_posix()} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:12]


def hash_of_modules(names: Iterable[str]) -> str:
    """A hash of the source of each module, in the order of the names."""
    files = (getattr(import_module(name), "__file__", None) for name in names)
    return " ".join(hashlib.sha256(Path(file).read_bytes()).hexdigest()[:12] if file else "none" for file in files)


VERSIONS = (
    f"ratt_opt {ratt_opt.__version__}, numpy {np.__version__}, python {platform.python_version()}, "
    f"code {_hash_of_code()}"
)
