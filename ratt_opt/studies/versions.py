"""Versions and code that a row depends on, and the proof of a remote worker that it has the package."""

from __future__ import annotations

import hashlib
import inspect
import platform
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import ratt_opt

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["VERSIONS", "file_of", "hash_of_modules", "hash_of_texts"]


def _hash_of_code() -> str:
    """A hash of every source file of the package: the same in every installation."""
    digest = hashlib.sha256()
    root = Path(ratt_opt.__file__).parent
    for file in sorted(root.rglob("*.py"), key=lambda file: file.relative_to(root).as_posix()):
        content = file.read_bytes()
        digest.update(f"{file.relative_to(root).as_posix()} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:12]


def hash_of_modules(names: Iterable[str]) -> str:
    """A hash of the source of each module, in the order of the names."""
    files = map(file_of, names)
    return " ".join(hashlib.sha256(Path(file).read_bytes()).hexdigest()[:12] if file else "none" for file in files)


def hash_of_texts(functions: Iterable[object]) -> str:
    """A hash of the text of each function that no file holds (a notebook's), in their order; empty if there is none."""
    texts = (_text(function) for function in functions if not file_of(str(getattr(function, "__module__", None))))
    return " ".join(hashlib.sha256(text.encode()).hexdigest()[:12] for text in texts)


def file_of(module: str) -> str | None:
    """Return the file of a module; a notebook's, and what was typed, has none."""
    try:
        return getattr(import_module(module), "__file__", None)
    except ModuleNotFoundError:
        return None


def _text(function: object) -> str:
    """The source of a function, or of an instance's class; nothing if Python does not keep it."""
    try:
        return inspect.getsource(function if inspect.isroutine(function) else type(function))
    except (OSError, TypeError):
        return ""


VERSIONS = (
    f"ratt_opt {ratt_opt.__version__}, numpy {np.__version__}, python {platform.python_version()}, "
    f"code {_hash_of_code()}"
)
