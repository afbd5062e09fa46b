"""Tests ask public names: which inner modules they name is listed, and lies beside them; folders mirror the package."""

import ast
import re
import tomllib
from functools import cache
from importlib import import_module
from pathlib import Path

import ratt_opt as ro

TESTS = Path(__file__).parent
ROOT = TESTS.parent
LISTED = tomllib.loads((TESTS / "internals.toml").read_text(encoding="utf-8"))
ANYWHERE = set(LISTED["anywhere"].split())
BESIDE = {
    ".".join([*filter(None, folder.split("/")), name])
    for folder, names in LISTED["beside"].items()
    for name in names.split()
}
ELSEWHERE = {file: set(names.split()) for file, names in LISTED["elsewhere"].items()}
OTHER_FOLDERS = {
    "analysis": "analysis",
    "formal": "formal",
    "ratt_audit": "ratt_audit",
    "golden": "analysis/golden",
}
"""Folders of tests that mirror none of ratt_opt."""


def module_of(dotted: str) -> str:
    """The longest part of a dotted name that is a module; none of a package, whose own names are its public face."""
    parts = dotted.split(".")
    while parts and not ROOT.joinpath(*parts).with_suffix(".py").exists():
        parts.pop()
    return ".".join(parts)


@cache
def named_in(text: str) -> frozenset[str]:
    """Modules of ratt_opt that a test names: in an import, as an attribute, in a text that patches or runs them."""
    text = re.sub(r"\bro\.", "ratt_opt.", text)
    named = set(re.findall(r"\bratt_opt(?:\.\w+)+", text))
    for package, names in re.findall(r"from (ratt_opt[.\w]*) import (\([^)]*\)|.*)", text):
        named |= {f"{package}.{name}" for name in re.findall(r"\w+", names)}
    modules = (module_of(name) for name in named)
    return frozenset(module.removeprefix("ratt_opt.") for module in modules if module)


def family(path: str) -> str:
    return re.split(r"[./]", path)[0]


def is_allowed(file: str, module: str) -> bool:
    """Whether a test, by its path in tests/, may name a module."""
    if module in ANYWHERE or module in ELSEWHERE.get(file, ()):
        return True
    is_beside = family(file) == family(module) if "/" in file else "." not in module
    return module in BESIDE and is_beside


NAMED = {
    path.relative_to(TESTS).as_posix(): named_in(path.read_text(encoding="utf-8"))
    for path in sorted(TESTS.rglob("*.py"))
}


def test_tests_name_no_inner_module_but_those_listed() -> None:
    """Ask a public name or an engine.py instead; see internals.toml."""
    refused = {file: sorted(one for one in modules if not is_allowed(file, one)) for file, modules in NAMED.items()}
    assert {file: modules for file, modules in refused.items() if modules} == {}


def test_what_is_listed_is_named() -> None:
    """So that the list shrinks with what it is about."""
    named = frozenset().union(*NAMED.values())
    assert sorted((ANYWHERE | BESIDE) - named) == []
    assert {file: sorted(names - NAMED[file]) for file, names in ELSEWHERE.items() if names - NAMED[file]} == {}
    assert not ANYWHERE & BESIDE


def test_public_names_are_imported_from_the_package() -> None:
    """By ``from ratt_opt import ...``; a module whose attribute is replaced is imported as a module."""
    inner = []
    for path in sorted(TESTS.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("ratt_opt."):
                module = import_module(node.module)
                names = (alias.name for alias in node.names if alias.name in ro.__all__)
                inner += [f"{path.name}: {one}" for one in names if getattr(module, one, None) is getattr(ro, one)]
    assert inner == []


def test_folders_mirror_the_package() -> None:
    folders = {path.parent.relative_to(TESTS).as_posix() for path in TESTS.rglob("test_*.py")}
    for folder in sorted(folders - {"."}):
        top, *rest = folder.split("/")
        mirrored = ROOT.joinpath(OTHER_FOLDERS.get(top, f"ratt_opt/{top}"), *rest)
        assert mirrored.is_dir(), f"tests/{folder} mirrors no folder"


def test_the_short_tier_leaves_out_functions_that_exist() -> None:
    """Others would be out of it for ever, if they came back."""
    lines = (TESTS / "short_tier.txt").read_text(encoding="utf-8").splitlines()
    listed = [line.split()[0] for line in lines]
    defined = {
        f"tests/{path.relative_to(TESTS).as_posix()}::{node.name}"
        for path in TESTS.rglob("test_*.py")
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef)
    }
    assert listed == sorted(set(listed))
    assert set(listed) - defined == set()


def test_strategies_are_in_one_file() -> None:
    """Composites and named ones; what a single test draws stands beside it."""
    named = re.compile(r"^(?:@st\.composite|\w+ = st\.)", re.MULTILINE)
    files = {path.name for path in TESTS.rglob("*.py") if named.search(path.read_text(encoding="utf-8"))}
    assert files == {"strategies.py"}


def test_a_new_name_would_be_refused() -> None:
    """In imports and texts alike; of another family, and of one's own where it is not listed."""
    package = ro.__name__  # else this file would name the module
    for text in (
        f"from {package}.attack.exact import worst_case_attack",
        f"import {package}.attack.exact",
        f"patch('{package}.attack.exact.DEFAULT', ())",
        f"PROGRAM = 'from {package}.attack import exact'",
        f"from {package}.attack import (\n    exact,\n)",
        "r" + "o.attack.exact.DEFAULT",
    ):
        assert named_in(text) == {"attack.exact"}
    assert is_allowed("attack/test_exact.py", "attack.exact")
    assert not is_allowed("solvers/test_ratt.py", "attack.exact")
    assert not is_allowed("test_limits.py", "attack.exact")
    assert not is_allowed("attack/test_exact.py", "attack.protection.upgrades")
    assert is_allowed("test_files.py", "_files")
    assert not is_allowed("cli/test_commands.py", "_files")
