"""Machine code is kept from one process to the next for as long as all sources that are in it stay the same.

Numba keeps it beside the modules. An upgrade by pip leaves it there, and Numba takes it for current while the module's
own file is the same. But a loop contains those of other modules that it calls, their constants and the layout of named
tuples it is given. If only these changed the old code would run on without a word; and if a named tuple is gone, the
index of what is kept cannot be read, so that every call fails.

So what is kept is named for the contents of all modules that the loop's module imports from, for annotations too, and
on through those that hold compiled loops themselves.
"""

from __future__ import annotations

import hashlib
import re
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numba.core.caching import CompileResultCacheImpl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["SourcesLocator"]

PACKAGE = Path(__file__).parents[1]
IMPORTS = re.compile(r"^\s*from ratt_opt([.\w]*) import (\([^)]*\)|.*)$", re.M)
COMPILED = re.compile(r"^from ratt_opt\.running\.compiling import", re.M)
"""What every module of compiled loops contains."""


@cache
def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _imported(path: Path) -> Iterator[Path]:
    """The files of this package that a file imports from."""
    for module, names in IMPORTS.findall(_text(path)):
        folder = PACKAGE.joinpath(*module.split(".")[1:])
        submodules = (folder / f"{name}.py" for name in re.findall(r"\w+", names))
        yield from filter(Path.is_file, (folder.with_suffix(".py"), folder / "__init__.py", *submodules))


@cache
def fingerprint(path: Path) -> str:
    """Fingerprint of all sources that machine code of the module in this file may contain."""
    reached, unread = {path}, [path]
    while unread:
        new = set(_imported(unread.pop())) - reached
        reached |= new
        unread += [file for file in new if COMPILED.search(_text(file))]
    whole = hashlib.sha256()
    for file in sorted(reached):
        whole.update(f"{file.relative_to(PACKAGE)}\0{_text(file)}\0".encode())
    return whole.hexdigest()[:16]


class SourcesLocator:
    """Tells Numba where to keep a function of this package: where it would, under a name by :func:`fingerprint`."""

    others: tuple[Any, ...] = tuple(CompileResultCacheImpl._locator_classes)
    """Numba's own."""

    def __init__(self, inner: Any, path: Path) -> None:
        self._inner = inner
        self._path = path
        self._py_file = str(path)  # which Numba's warnings name

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> SourcesLocator | None:
        """``None`` for functions of others."""
        path = Path(file)
        if not (path.is_relative_to(PACKAGE) and path.is_file()):
            return None
        found = (other.from_function(function, file) for other in cls.others)
        return next((cls(inner, path) for inner in found if inner is not None), None)

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._inner.get_cache_path())

    def get_source_stamp(self) -> Any:
        """Time of the function's own file."""
        return self._inner.get_source_stamp()

    def get_disambiguator(self) -> str:
        """Part of the file's name."""
        return f"{self._inner.get_disambiguator()}-{fingerprint(self._path)}"

    def ensure_cache_path(self) -> None:
        """Called before something is kept: removes what earlier sources of the module left."""
        self._inner.ensure_cache_path()
        name = re.compile(re.escape(self._path.stem) + r"\.[^-]+-\d+(-[0-9a-f]{16})?\.py\d+")
        for file in Path(self.get_cache_path()).iterdir():
            known = name.match(file.name)
            if known is not None and known[1] != f"-{fingerprint(self._path)}":
                with suppress(OSError):  # another process may have it open, or have removed it
                    file.unlink()
